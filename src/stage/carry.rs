//! The layout of the source carried over to the target (VORONOI 5.2).
//!
//! Arcs are taken in some order. Each is traced as the shortest path between the corners that the source's cyclic order
//! prescribes, and kept if the region structure of both meshes agrees afterwards; otherwise it is postponed. Arcs that
//! join separate parts of the network never disagree, so once the network is connected every region of a closed surface
//! of genus zero is a disc and every remaining arc has one way to go: a layout always comes out.

use super::trace::Traced;
use crate::error::{Error, Result};
use crate::mesh::{ArcId, Id, IdVec, LandmarkId, TriMesh, VertexId};
use crate::path::base_complex::DirectedArc;
use crate::path::cut_mesh::CutMesh;
use crate::path::network::{Corner, connect, corner_behind, embed};
use crate::path::rebuild::Upkeep;
use crate::path::region::Regions;
use crate::path::rim::rims;
use crate::path::search::Searcher;

/// An arc longer than this many times its reference is postponed in the first pass (HYPOTHESIS 3.2).
const SWIRL: f64 = 1.5;
/// The same in the second pass; the third takes every length.
const SWIRL_LATER: f64 = 3.0;

/// A layout carried to the target in one order of arcs.
#[derive(Clone, Debug)]
pub struct Carried {
    /// The target's cut mesh with all arcs.
    pub cut: CutMesh,
    /// Length of every arc on the target.
    pub lengths: IdVec<ArcId, f64>,
    /// How often an arc was put off.
    pub postponed: usize,
}

impl Carried {
    /// Total length of the arcs.
    pub fn total(&self) -> f64 {
        self.lengths.iter().sum()
    }
}

/// What stays the same for every order of arcs.
pub struct Carrier<'a> {
    /// The source's layout.
    pub source: &'a Traced,
    /// The target.
    pub mesh: &'a TriMesh,
    /// The target's landmarks.
    pub landmarks: &'a [VertexId],
    /// Least number of edge nodes.
    pub edge_nodes: u32,
    /// Length of every arc on the bare target, without regard to other arcs.
    pub reference: &'a IdVec<ArcId, f64>,
}

struct State {
    cut: CutMesh,
    searcher: Searcher,
    placed: IdVec<ArcId, bool>,
    lengths: IdVec<ArcId, f64>,
    network: Vec<usize>,
    upkeep: Upkeep,
    postponed: usize,
}

impl Carrier<'_> {
    /// Carries all arcs, tried in the given order.
    pub fn carry(&self, order: &[ArcId]) -> Result<Carried> {
        let arcs = self.source.arcs.len();
        let mut state = State {
            cut: CutMesh::new(self.mesh, self.landmarks, self.edge_nodes),
            searcher: Searcher::default(),
            placed: IdVec::filled(false, arcs),
            lengths: IdVec::filled(0.0, arcs),
            network: (0..self.landmarks.len()).collect(),
            upkeep: Upkeep::default(),
            postponed: 0,
        };
        self.lay_rims(&mut state)?;
        let mut left: Vec<ArcId> = order.iter().copied().filter(|&a| !state.placed[a]).collect();
        for limit in [SWIRL, SWIRL_LATER] {
            self.sweep(&mut state, &mut left, limit)?;
        }
        while !left.is_empty() {
            let before = left.len();
            self.sweep(&mut state, &mut left, f64::INFINITY)?;
            if left.len() == before {
                return Err(Error::bug("no arc of the layout can be carried to the target").at(left[0]));
            }
        }
        Ok(Carried { cut: state.cut, lengths: state.lengths, postponed: state.postponed })
    }

    /// Lays the arcs along the boundary, which both meshes number alike.
    fn lay_rims(&self, state: &mut State) -> Result<()> {
        for (i, rim) in rims(self.mesh, self.landmarks).iter().enumerate() {
            let arc = ArcId::new(i);
            if self.source.arcs.raw.get(i) != Some(&rim.ends) {
                return Err(Error::bug("the boundary loops carry different base vertices").at(arc));
            }
            rim.lay(&mut state.cut, arc);
            state.lengths[arc] = rim.length(&state.cut);
            state.placed[arc] = true;
            let [a, b] = rim.ends.map(|l| root(&state.network, l));
            state.network[a] = b;
        }
        Ok(())
    }

    /// Tries every arc once; those that fail stay in `left`.
    fn sweep(&self, state: &mut State, left: &mut Vec<ArcId>, limit: f64) -> Result<()> {
        let mut still = Vec::new();
        for &arc in left.iter() {
            if !self.place(state, arc, limit)? {
                state.postponed += 1;
                still.push(arc);
            }
        }
        *left = still;
        Ok(())
    }

    /// Traces one arc on the target; false if it is too long or splits a region differently than on the source.
    fn place(&self, state: &mut State, arc: ArcId, limit: f64) -> Result<bool> {
        let corners = [false, true].map(|reversed| self.corner(state, DirectedArc { arc, reversed }));
        let path = connect(&mut state.cut, self.mesh, &mut state.searcher, corners)?;
        if path.length > limit * self.reference[arc] {
            return Ok(false);
        }
        let [a, b] = self.source.arcs[arc].map(|l| root(&state.network, l));
        let before = (a == b).then(|| state.cut.clone());
        embed(&mut state.cut, self.mesh, &path, arc)?;
        state.placed[arc] = true;
        if let Some(before) = before.filter(|_| !self.agrees(state)) {
            state.cut = before;
            state.placed[arc] = false;
            return Ok(false);
        }
        state.network[a] = b;
        state.lengths[arc] = path.length;
        state.upkeep.after_arc(self.mesh, &mut state.cut, &self.source.arcs, self.edge_nodes);
        Ok(true)
    }

    /// The corner on the target where an end of an arc belongs: behind the arc that precedes it on the source.
    fn corner(&self, state: &State, end: DirectedArc) -> Corner {
        corner_behind(&self.source.cut, &self.source.arcs, end, &|a| state.placed[a])
    }

    fn agrees(&self, state: &State) -> bool {
        let placed = |a: ArcId| state.placed[a];
        let source = Regions::find(&self.source.cut, &placed).structure();
        source == Regions::find(&state.cut, &placed).structure()
    }
}

/// The representative of the part of the network a landmark belongs to.
fn root(network: &[usize], l: LandmarkId) -> usize {
    let mut at = l.index();
    while network[at] != at {
        at = network[at];
    }
    at
}
