//! Stage: one layout on both meshes (VORONOI 5, `algorithms.md` 3 and 4).
//!
//! Input: the source's traced layout and the target. Output: two cut meshes that carry the same base complex. The
//! target's arcs are carried in several orders side by side; the shortest result is kept, every arc is traced again
//! inside the quad that taking it away opens, and both cut meshes are rebuilt from their straightened arcs.

use super::carry::{Carried, Carrier};
use super::order::{ORDERS, Order, arrange};
use super::trace::Traced;
use crate::error::{Error, Result};
use crate::mesh::{ArcId, IdVec, LandmarkId, PatchId, TriMesh, VertexId};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cluster::Clusters;
use crate::path::cut_mesh::CutMesh;
use crate::path::network::{Corner, connect, embed, rotation};
use crate::path::rebuild::{Upkeep, rebuild};
use crate::path::region::Regions;
use crate::path::search::{Anywhere, Searcher, Terminal};
use rayon::prelude::*;

/// Sweeps of re-routing over all arcs; later ones change little.
const REROUTE_SWEEPS: usize = 2;
/// A new way must be shorter by this share to be taken, so that re-routing ends.
const WORTH_MOVING: f64 = 1e-6;

/// The same base complex on both meshes.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The base complex.
    pub base: BaseComplex,
    /// The source and the target, cut along the arcs.
    pub cuts: [CutMesh; 2],
    /// Total arc length on either mesh, in mesh units.
    pub lengths: [f64; 2],
    /// The order of arcs that won.
    pub order: Order,
    /// How often it put an arc off.
    pub postponed: usize,
}

/// Carries the source's layout to the target.
pub fn layout(
    meshes: [&TriMesh; 2],
    target_landmarks: &[VertexId],
    source: Traced,
    target_clusters: &Clusters,
    edge_nodes: u32,
) -> Result<Layout> {
    let reference = reference_lengths(meshes[1], target_landmarks, &source);
    let (order, carried) = best_order(meshes, target_landmarks, &source, target_clusters, &reference, edge_nodes)?;
    let arcs = source.arcs.clone();
    let finish = |mesh: &TriMesh, mut cut: CutMesh, mut lengths: IdVec<ArcId, f64>| -> Result<CutMesh> {
        reroute(mesh, &mut cut, &arcs, &mut lengths, edge_nodes)?;
        Ok(rebuild(mesh, &cut, &arcs, edge_nodes).unwrap_or(cut))
    };
    let postponed = carried.postponed;
    let (a, b) = rayon::join(
        || finish(meshes[0], source.cut, source.lengths),
        || finish(meshes[1], carried.cut, carried.lengths),
    );
    let cuts = [a?, b?];
    let base = base_complex(&cuts[0], &arcs)?;
    if base_complex(&cuts[1], &arcs)?.patches != base.patches {
        return Err(Error::bug("the two layouts have different patches"));
    }
    let lengths = [0, 1].map(|k| total_length(&cuts[k], &arcs));
    Ok(Layout { base, cuts, lengths, order, postponed })
}

/// The length of every arc on the bare target.
fn reference_lengths(mesh: &TriMesh, landmarks: &[VertexId], source: &Traced) -> IdVec<ArcId, f64> {
    let bare = CutMesh::new(mesh, landmarks, 1);
    let length = |searcher: &mut Searcher, ends: &[LandmarkId; 2]| {
        let [start, goal] = ends.map(|l| Terminal::whole(&bare, bare.landmarks[l]));
        searcher.shortest(&bare, &start, &goal, &Anywhere).map_or(f64::INFINITY, |p| p.length)
    };
    let lengths: Vec<f64> = source.arcs.raw.par_iter().map_init(Searcher::default, length).collect();
    IdVec::from_raw(lengths)
}

/// Carries the arcs in every order and keeps the one with the shortest arcs; ties go to the first.
fn best_order(
    meshes: [&TriMesh; 2],
    landmarks: &[VertexId],
    source: &Traced,
    clusters: &Clusters,
    reference: &IdVec<ArcId, f64>,
    edge_nodes: u32,
) -> Result<(Order, Carried)> {
    let scale = [meshes[0], meshes[1]].map(|m| m.area().sqrt());
    let relative = source.arcs.ids().map(|a| source.lengths[a] / scale[0] + reference[a] / scale[1]).collect();
    let carrier = Carrier { source, mesh: meshes[1], landmarks, edge_nodes, reference };
    let tries: Vec<Result<(Order, Carried)>> = ORDERS
        .par_iter()
        .map(|&order| Ok((order, carrier.carry(&arrange(order, source, clusters, &relative))?)))
        .collect();
    let mut best: Option<(Order, Carried)> = None;
    for result in tries {
        let (order, carried) = result?;
        if best.as_ref().is_none_or(|(_, other)| carried.total() < other.total()) {
            best = Some((order, carried));
        }
    }
    best.ok_or_else(|| Error::bug("no order of arcs was tried"))
}

/// Traces every arc again inside the quad that taking it away opens, and keeps the shorter way.
fn reroute(
    mesh: &TriMesh,
    cut: &mut CutMesh,
    arcs: &IdVec<ArcId, [LandmarkId; 2]>,
    lengths: &mut IdVec<ArcId, f64>,
    edge_nodes: u32,
) -> Result<()> {
    let mut searcher = Searcher::default();
    let mut upkeep = Upkeep::default();
    for _ in 0..REROUTE_SWEEPS {
        for arc in arcs.ids() {
            let corners = [false, true].map(|reversed| corner_behind(cut, arcs, DirectedArc { arc, reversed }));
            let before = cut.clone();
            cut.unmark(arc);
            let path = connect(cut, mesh, &mut searcher, corners)?;
            if path.length < lengths[arc] * (1.0 - WORTH_MOVING) {
                embed(cut, mesh, &path, arc)?;
                lengths[arc] = path.length;
                upkeep.after_arc(mesh, cut, arcs, edge_nodes);
            } else {
                *cut = before;
            }
        }
    }
    Ok(())
}

/// The corner that an end of an arc leaves behind when the arc is taken away.
fn corner_behind(cut: &CutMesh, arcs: &IdVec<ArcId, [LandmarkId; 2]>, end: DirectedArc) -> Corner {
    let landmark = arcs[end.arc][usize::from(end.reversed)];
    let around = rotation(cut, landmark, &|_| true);
    let at = around.iter().position(|&d| d == end).unwrap_or(0);
    let before = (1..around.len()).map(|k| around[(at + around.len() - k) % around.len()]);
    Corner { landmark, after: before.into_iter().find(|d| d.arc != end.arc) }
}

/// Reads the base complex off a mesh whose regions are all triangles.
pub fn base_complex(cut: &CutMesh, arcs: &IdVec<ArcId, [LandmarkId; 2]>) -> Result<BaseComplex> {
    let regions = Regions::find(cut, &|_| true);
    let mut patches: Vec<[DirectedArc; 3]> = Vec::new();
    for (walks, genus) in regions.walks.iter().zip(&regions.genus) {
        let sides = match walks.as_slice() {
            [walk] if *genus == 0 => <[DirectedArc; 3]>::try_from(walk.as_slice()).ok(),
            _ => None,
        };
        let mut sides = sides.ok_or_else(|| Error::bug("a region of the layout is not a triangular disc"))?;
        let first = (0..3).min_by_key(|&k| sides[k]).unwrap_or(0);
        sides.rotate_left(first);
        patches.push(sides);
    }
    patches.sort();
    let patches: IdVec<PatchId, _> = IdVec::from_raw(patches);
    Ok(BaseComplex { landmarks: cut.landmarks.len(), arcs: arcs.clone(), patches })
}

fn total_length(cut: &CutMesh, arcs: &IdVec<ArcId, [LandmarkId; 2]>) -> f64 {
    arcs.iter_ids().flat_map(|(arc, ends)| cut.arc_path(arc, ends[0])).map(|h| cut.length(h)).sum()
}
