//! Stage: one layout on both meshes (VORONOI 5).
//!
//! Input: sets of base vertices. Output: two cut meshes that carry the same base complex. Layouts are made in several
//! ways; of the shortest, every arc is traced again inside the quad that taking it away opens, and both cut meshes are
//! rebuilt from their straightened arcs.

use super::candidate::{Candidate, SCOUT_NODES, Way, candidates, published};
use super::cluster::BaseVertices;
use super::greedy::{Greedy, greedy};
use super::guided::{Lead, guided};
use super::hypothesis::{Rough, path_hypotheses, rough_map};
use super::joint::Grown;
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cut_mesh::CutMesh;
use crate::path::network::{connect, embed};
use crate::path::rebuild::{Upkeep, rebuild};
use crate::path::region::base_complex;
use crate::path::search::Searcher;
use crate::path::subcomplex::Subcomplex;
use rayon::prelude::*;

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
    /// How it was laid out.
    pub way: Way,
    /// How often an arc was put off.
    pub postponed: usize,
}

impl Layout {
    /// Total arc length on both meshes in units of their roots of area.
    pub fn size(&self, meshes: [&TriMesh; 2]) -> f64 {
        (0..2).map(|k| self.lengths[k] / meshes[k].area().sqrt()).sum()
    }

    /// The same layout with the meshes' roles swapped.
    fn swapped(mut self) -> Layout {
        self.cuts.swap(0, 1);
        self.lengths.swap(0, 1);
        self
    }
}

/// Lays out both meshes in several ways and returns the best `keep`, the one with the shortest arcs first.
///
/// `edge_nodes` is the least number of nodes on an edge that arcs may cross it at.
pub fn layouts(meshes: [&TriMesh; 2], sets: &[BaseVertices], edge_nodes: u32, keep: usize) -> Result<Vec<Layout>> {
    let mut all = Vec::new();
    for set in sets {
        let mut own = candidates(meshes, set)?;
        own.truncate(keep);
        let kept: Vec<Result<Candidate>> = own.into_par_iter().map(|c| c.keep(meshes, set.lasting)).collect();
        all.extend(kept.into_iter().collect::<Result<Vec<Candidate>>>()?);
    }
    all.sort_by(|a, b| a.size.total_cmp(&b.size));
    all.dedup_by(|a, b| (a.size - b.size).abs() < SAME_LENGTH * b.size);
    all.truncate(keep);
    let finished: Vec<Result<Layout>> = all.into_par_iter().map(|c| finish(meshes, c, edge_nodes)).collect();
    let mut layouts = finished.into_iter().collect::<Result<Vec<Layout>>>()?;
    layouts.sort_by(|a, b| a.size(meshes).total_cmp(&b.size(meshes)));
    Ok(layouts)
}

/// Lays out both meshes in the one way that VORONOI describes.
pub fn published_layout(meshes: [&TriMesh; 2], set: &BaseVertices, edge_nodes: u32) -> Result<Layout> {
    let candidate = published(meshes, set, edge_nodes)?;
    finish(meshes, candidate.keep(meshes, set.lasting)?, edge_nodes)
}

/// Lays out both meshes along the path hypotheses of a rough map (HYPOTHESIS 3), the shortest leading, and those of the
/// outermost base vertices; the layout with the shorter arcs first.
pub fn guided_by(meshes: [&TriMesh; 2], set: &BaseVertices, rough: &Rough, edge_nodes: u32) -> Result<Vec<Layout>> {
    let hypotheses = path_hypotheses(meshes, set.vertices.each_ref().map(Vec::as_slice), rough);
    let one = |lead: Lead| {
        let (grown, postponed) = guided(meshes, set, &hypotheses, lead, SCOUT_NODES)?;
        settle(meshes, set, grown, Way::Guided(lead), postponed, edge_nodes)
    };
    let (shortest, outermost) = rayon::join(|| one(Lead::Shortest), || one(Lead::OuterTree));
    Ok(sorted(meshes, vec![shortest?, outermost?]))
}

/// Lays out both meshes along the path hypotheses of the source draped over the target, and along those of the target over
/// the source; the layout with the shortest arcs first.
pub fn guided_layouts(meshes: [&TriMesh; 2], set: &BaseVertices, edge_nodes: u32) -> Result<Vec<Layout>> {
    let one = |meshes: [&TriMesh; 2], set: &BaseVertices| {
        let rough = rough_map(meshes, set.vertices.each_ref().map(Vec::as_slice))?;
        guided_by(meshes, set, &rough, edge_nodes)
    };
    let [source, target] = meshes;
    let (forward, backward) = rayon::join(|| one(meshes, set), || one([target, source], &set.swapped()));
    let mut all = forward?;
    all.extend(backward?.into_iter().map(Layout::swapped));
    Ok(sorted(meshes, all))
}

/// The layout with the shortest arcs first.
fn sorted(meshes: [&TriMesh; 2], mut layouts: Vec<Layout>) -> Vec<Layout> {
    layouts.sort_by(|a, b| a.size(meshes).total_cmp(&b.size(meshes)));
    layouts
}

/// Lays out both meshes by the greedy heuristic, as far as it goes.
pub fn greedy_layout(meshes: [&TriMesh; 2], set: &BaseVertices, edge_nodes: u32) -> Result<Greedy<Layout>> {
    Ok(match greedy(meshes, set, edge_nodes)? {
        Greedy::Complete(grown) => Greedy::Complete(settle(meshes, set, grown, Way::Greedy, 0, edge_nodes)?),
        Greedy::Stuck(ends) => Greedy::Stuck(ends),
    })
}

/// Takes auxiliary base vertices out of a layout and smooths its arcs.
fn settle(
    meshes: [&TriMesh; 2],
    set: &BaseVertices,
    Grown { base, cuts }: Grown,
    way: Way,
    postponed: usize,
    edge_nodes: u32,
) -> Result<Layout> {
    let candidate = Candidate::new(meshes, base, cuts, way, postponed);
    finish(meshes, candidate.keep(meshes, set.lasting)?, edge_nodes)
}

/// Re-routes the arcs, rebuilds the cut meshes and checks that both carry the base complex.
fn finish(meshes: [&TriMesh; 2], candidate: Candidate, edge_nodes: u32) -> Result<Layout> {
    let Candidate { base, cuts: [source, target], way, postponed, .. } = candidate;
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
    let lengths = cuts.each_ref().map(|cut| cut.arc_lengths(&base.arcs).iter().sum());
    Ok(Layout { base, cuts, lengths, way, postponed })
}

/// Traces every arc again inside the quad that taking it away opens, and keeps the shorter way.
fn reroute(mesh: &TriMesh, cut: &mut CutMesh, base: &BaseComplex, edge_nodes: u32) -> Result<()> {
    let mut searcher = Searcher::default();
    let mut upkeep = Upkeep::default();
    let complete = Subcomplex::complete(base);
    let mut lengths = cut.arc_lengths(&base.arcs);
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
