//! Stage: one layout on both meshes (VORONOI 5).
//!
//! Input: the source's traced layout and the target. Output: two cut meshes that carry the same base complex. The
//! target's arcs are carried in several orders side by side; the shortest result is kept, every arc is traced again
//! inside the quad that taking it away opens, and both cut meshes are rebuilt from their straightened arcs.

use super::carry::{Carried, Carrier};
use super::order::{ORDERS, Order, arrange};
use super::trace::{Traced, trace};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, IdVec, LandmarkId, TriMesh, VertexId};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cluster::Clusters;
use crate::path::cut_mesh::CutMesh;
use crate::path::network::{connect, embed};
use crate::path::rebuild::{Upkeep, rebuild};
use crate::path::region::base_complex;
use crate::path::search::{Anywhere, Searcher, Terminal};
use crate::path::subcomplex::Subcomplex;
use rayon::prelude::*;

/// Least edge nodes while candidates are laid out: they settle which way arcs go, and re-routing smooths them.
const SCOUT_NODES: u32 = 1;
/// Sweeps of re-routing over all arcs; later ones change little.
const REROUTE_SWEEPS: usize = 1;
/// A new way must be shorter by this share to be taken, so that re-routing ends.
const WORTH_MOVING: f64 = 1e-6;

/// Layouts whose lengths differ by less than this share are the same layout.
const SAME_LENGTH: f64 = 1e-6;

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

/// One way to lay the arcs: traced on one mesh, carried to the other in some order.
struct Candidate {
    base: BaseComplex,
    cuts: [CutMesh; 2],
    lengths: [IdVec<ArcId, f64>; 2],
    order: Order,
    postponed: usize,
}

/// Lays out both meshes in several ways and returns the best `keep`, the one with the shortest arcs first.
///
/// Arcs are traced on either mesh and carried to the other in several orders; lengths are relative to the meshes' sizes.
pub fn layouts(
    meshes: [&TriMesh; 2],
    landmarks: [&[VertexId]; 2],
    clusters: &[Clusters; 2],
    edge_nodes: u32,
    keep: usize,
) -> Result<Vec<Layout>> {
    let traced: Vec<Result<Traced>> =
        [0, 1].par_iter().map(|&k| trace(meshes[k], landmarks[k], &clusters[k], SCOUT_NODES)).collect();
    let mut candidates = Vec::new();
    for (from, traced) in traced.into_iter().enumerate() {
        candidates.extend(carry_all(meshes, landmarks, clusters, from, &traced?)?);
    }
    let scale = meshes.map(|m| m.area().sqrt());
    let size = |c: &Candidate| (0..2).map(|k| c.lengths[k].iter().sum::<f64>() / scale[k]).sum::<f64>();
    candidates.sort_by(|a, b| size(a).total_cmp(&size(b)));
    candidates.dedup_by(|a, b| (size(a) - size(b)).abs() < SAME_LENGTH * size(b));
    candidates.truncate(keep);
    let finished: Vec<Result<Layout>> = candidates.into_par_iter().map(|c| finish(meshes, c, edge_nodes)).collect();
    let mut layouts = finished.into_iter().collect::<Result<Vec<Layout>>>()?;
    let total = |l: &Layout| l.lengths[0] / scale[0] + l.lengths[1] / scale[1];
    layouts.sort_by(|a, b| total(a).total_cmp(&total(b)));
    Ok(layouts)
}

/// Carries the arcs traced on mesh `from` to the other one, in every order.
fn carry_all(
    meshes: [&TriMesh; 2],
    landmarks: [&[VertexId]; 2],
    clusters: &[Clusters; 2],
    from: usize,
    traced: &Traced,
) -> Result<Vec<Candidate>> {
    let to = 1 - from;
    let scale = meshes.map(|m| m.area().sqrt());
    let reference = reference_lengths(meshes[to], landmarks[to], traced);
    let relative = |a: ArcId| {
        let own = traced.lengths[a] / scale[from];
        if reference[a].is_finite() { own + reference[a] / scale[to] } else { 2.0 * own }
    };
    let relative = traced.base.arcs.ids().map(relative).collect();
    let carrier = Carrier {
        source: traced,
        mesh: meshes[to],
        landmarks: landmarks[to],
        edge_nodes: SCOUT_NODES,
        reference: &reference,
    };
    let one = |&order: &Order| {
        let Carried { cut, lengths, postponed } = carrier.carry(&arrange(order, traced, &clusters[to], &relative))?;
        let (mut cuts, mut both) = ([traced.cut.clone(), cut], [traced.lengths.clone(), lengths]);
        if from == 1 {
            cuts.swap(0, 1);
            both.swap(0, 1);
        }
        Ok(Candidate { base: traced.base.clone(), cuts, lengths: both, order, postponed })
    };
    let tries: Vec<Result<Candidate>> = ORDERS.par_iter().map(one).collect();
    tries.into_iter().collect()
}

/// Re-routes the arcs, rebuilds the cut meshes and checks that both carry the base complex.
fn finish(meshes: [&TriMesh; 2], candidate: Candidate, edge_nodes: u32) -> Result<Layout> {
    let Candidate { base, cuts: [source, target], order, postponed, .. } = candidate;
    let one = |mesh: &TriMesh, scouted: CutMesh| -> Result<CutMesh> {
        let mut cut = rebuild(mesh, &scouted, &base.arcs, edge_nodes).unwrap_or(scouted);
        reroute(mesh, &mut cut, &base, edge_nodes)?;
        Ok(rebuild(mesh, &cut, &base.arcs, edge_nodes).unwrap_or(cut))
    };
    let (a, b) = rayon::join(|| one(meshes[0], source), || one(meshes[1], target));
    let cuts = [a?, b?];
    for cut in &cuts {
        if base_complex(cut, &base.arcs)? != base {
            return Err(Error::bug("the two layouts have different patches"));
        }
    }
    let lengths = [0, 1].map(|k| arc_lengths(&cuts[k], &base.arcs).iter().sum());
    Ok(Layout { base, cuts, lengths, order, postponed })
}

/// The length of every arc on the bare target; infinite for loops, which could shrink to nothing.
fn reference_lengths(mesh: &TriMesh, landmarks: &[VertexId], source: &Traced) -> IdVec<ArcId, f64> {
    let bare = CutMesh::new(mesh, landmarks, 1);
    let length = |searcher: &mut Searcher, ends: &[LandmarkId; 2]| {
        let [start, goal] = ends.map(|l| Terminal::whole(&bare, bare.landmarks[l]));
        let path = (ends[0] != ends[1]).then(|| searcher.shortest(&bare, &start, &goal, &Anywhere)).flatten();
        path.map_or(f64::INFINITY, |p| p.length)
    };
    let lengths: Vec<f64> = source.base.arcs.raw.par_iter().map_init(Searcher::default, length).collect();
    IdVec::from_raw(lengths)
}

/// Traces every arc again inside the quad that taking it away opens, and keeps the shorter way.
fn reroute(mesh: &TriMesh, cut: &mut CutMesh, base: &BaseComplex, edge_nodes: u32) -> Result<()> {
    let mut searcher = Searcher::default();
    let mut upkeep = Upkeep::default();
    let complete = Subcomplex::complete(base);
    let mut lengths = arc_lengths(cut, &base.arcs);
    for _ in 0..REROUTE_SWEEPS {
        for (arc, ends) in base.arcs.iter_ids() {
            if cut.is_rim(arc, ends[0]) {
                continue;
            }
            let corners = [false, true].map(|reversed| complete.corner_behind(DirectedArc { arc, reversed }));
            let old = cut.unmark(arc, ends[0]);
            match connect(cut, mesh, &mut searcher, corners) {
                Ok(path) if path.length < lengths[arc] * (1.0 - WORTH_MOVING) => {
                    embed(cut, mesh, &path, arc)?;
                    lengths[arc] = path.length;
                    upkeep.after_arc(mesh, cut, &base.arcs, edge_nodes);
                }
                _ => cut.mark_along(&old, arc)?,
            }
        }
    }
    Ok(())
}

fn arc_lengths(cut: &CutMesh, arcs: &IdVec<ArcId, [LandmarkId; 2]>) -> IdVec<ArcId, f64> {
    arcs.iter_ids().map(|(arc, ends)| cut.arc_path(arc, ends[0]).into_iter().map(|h| cut.length(h)).sum()).collect()
}
