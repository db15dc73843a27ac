//! The layout of the source carried over to the target (VORONOI 5.2).
//!
//! Arcs are taken in some order. Each is traced as the shortest path between the corners that the source's cyclic order
//! prescribes. One that joins boundary walks blocks nothing; nor does one that opens a handle, if it leaves its region in
//! one piece here as well. One that separates its region is kept only if both sides hold the same on both meshes, and is
//! postponed otherwise. When only postponed arcs are left, those that join or open a handle succeed, until every region
//! is a disc and every remaining arc has one way to go: a layout always comes out.

use super::trace::{Link, Traced};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, Id, IdVec, LandmarkId, TriMesh, VertexId};
use crate::path::base_complex::DirectedArc;
use crate::path::cut_mesh::CutMesh;
use crate::path::edge_loop::GivenArc;
use crate::path::handle::lay_across_handle;
use crate::path::network::{Corner, connect, embed, rotation};
use crate::path::rebuild::Upkeep;
use crate::path::search::Searcher;
use crate::path::side::Explorer;
use crate::path::subcomplex::{Role, Subcomplex};

/// An arc longer than this many times its reference is postponed in the first pass (HYPOTHESIS 3.2).
const SWIRL: f64 = 1.5;
/// The same in the second pass; the third takes every length.
const SWIRL_LATER: f64 = 3.0;

/// A layout carried to the target in one order of arcs.
#[derive(Clone, Debug)]
pub struct Carried {
    /// The target's cut mesh with all arcs.
    pub cut: CutMesh,
    /// How often an arc was put off.
    pub postponed: usize,
}

/// What stays the same for every order of arcs.
pub struct Carrier<'a> {
    /// The source's layout.
    pub source: &'a Traced,
    /// The target.
    pub mesh: &'a TriMesh,
    /// The target's landmarks.
    pub landmarks: &'a [VertexId],
    /// The target's given arcs.
    pub given: &'a [GivenArc],
    /// Least number of edge nodes.
    pub edge_nodes: u32,
    /// Length of every arc on the bare target, without regard to other arcs; infinite where that says nothing.
    pub reference: &'a IdVec<ArcId, f64>,
    /// The length, in mesh units, at which the layout is given up.
    pub enough: &'a (dyn Fn() -> f64 + Sync),
}

struct State<'a> {
    cut: CutMesh,
    searcher: Searcher,
    explorer: Explorer,
    placed: Subcomplex<'a>,
    /// Length of the arcs so far, and the least that of the others.
    length: f64,
    /// How long an arc was when it was last too long: later it is longer still.
    too_long: IdVec<ArcId, f64>,
    upkeep: Upkeep,
    postponed: usize,
    given_up: bool,
}

impl Carrier<'_> {
    /// Carries all arcs, tried in the given order; None if they become too long together.
    pub fn carry(&self, order: &[ArcId]) -> Result<Option<Carried>> {
        let mut state = State {
            cut: CutMesh::new(self.mesh, self.landmarks, self.edge_nodes),
            searcher: Searcher::default(),
            explorer: Explorer::default(),
            placed: Subcomplex::bare(&self.source.base),
            length: order.iter().map(|&arc| self.least(arc)).sum(),
            too_long: IdVec::filled(0.0, order.len()),
            upkeep: Upkeep::default(),
            postponed: 0,
            given_up: false,
        };
        self.lay_given(&mut state)?;
        let mut left: Vec<ArcId> = order.iter().copied().filter(|&a| self.source.links[a] != Link::Given).collect();
        for limit in [SWIRL, SWIRL_LATER] {
            self.sweep(&mut state, &mut left, limit);
        }
        while !left.is_empty() {
            let before = left.len();
            let failure = self.sweep(&mut state, &mut left, f64::INFINITY);
            if state.given_up {
                return Ok(None);
            }
            if left.len() == before {
                let stuck = || Error::bug("no arc of the layout can be carried to the target").at(left[0]);
                return Err(failure.unwrap_or_else(stuck));
            }
        }
        Ok(Some(Carried { cut: state.cut, postponed: state.postponed }))
    }

    /// Lays the arcs along the boundary and the guides, which both meshes number alike.
    fn lay_given(&self, state: &mut State) -> Result<()> {
        for (i, one) in self.given.iter().enumerate() {
            let arc = ArcId::new(i);
            if self.source.base.arcs.raw.get(i) != Some(&one.ends) {
                return Err(Error::bug("loops that correspond carry different base vertices").at(arc));
            }
            one.lay(&mut state.cut, arc);
            state.length += one.length(&state.cut) - self.least(arc);
            state.placed.add(arc);
        }
        Ok(())
    }

    /// Tries every arc once; those that fail stay in `left`. Returns the last failure that was not a refusal.
    fn sweep(&self, state: &mut State, left: &mut Vec<ArcId>, limit: f64) -> Option<Error> {
        let mut failure = None;
        left.retain(|&arc| {
            state.given_up |= state.length > (self.enough)();
            if state.given_up {
                return true;
            }
            // No limit times a length of zero, between landmarks at one position, is no limit.
            let longest = if limit.is_finite() { limit * self.reference[arc] } else { limit };
            let placed = self.place(state, arc, longest).unwrap_or_else(|e| {
                failure = Some(e);
                false
            });
            state.postponed += usize::from(!placed);
            !placed
        });
        failure
    }

    /// Traces one arc on the target; false if it is longer than `limit` or separates other things than on the source.
    ///
    /// If it fails, the target carries the same arcs as before, though it may be finer.
    fn place(&self, state: &mut State, arc: ArcId, limit: f64) -> Result<bool> {
        if state.too_long[arc] > limit {
            return Ok(false);
        }
        let role = state.placed.role(arc);
        let corners = [false, true].map(|reversed| state.placed.corner_behind(DirectedArc { arc, reversed }));
        let length = match role {
            Role::OpensHandle => self.open_handle(state, arc, corners)?,
            // The shortest loop through one corner encloses nothing.
            Role::Separates if corners[0] == corners[1] => return Ok(false),
            _ => self.join(state, arc, corners, limit)?,
        };
        let ends = self.source.base.arcs[arc];
        if length > limit {
            state.too_long[arc] = length;
        }
        let agrees = length <= limit
            && (ends[0] != ends[1] || state.turns_as_on_source(arc, ends[0]))
            && (role != Role::Separates || state.separates_as_on_source(arc, ends[0]));
        if agrees {
            state.placed.add(arc);
            state.length += length - self.least(arc);
            state.upkeep.after_arc(self.mesh, &mut state.cut, &self.source.base.arcs, self.edge_nodes);
        } else {
            state.cut.unmark(arc, ends[0]);
        }
        Ok(agrees)
    }

    /// An arc is at least so long.
    fn least(&self, arc: ArcId) -> f64 {
        if self.reference[arc].is_finite() { self.reference[arc] } else { 0.0 }
    }

    /// Lays an arc along the shortest path, unless it is longer than `limit`; returns its length.
    fn join(&self, state: &mut State, arc: ArcId, corners: [Corner; 2], limit: f64) -> Result<f64> {
        let State { cut, searcher, .. } = state;
        let path = connect(cut, self.mesh, searcher, corners)?;
        if path.length <= limit {
            let laid = embed(cut, self.mesh, &path, arc);
            laid.inspect_err(|_| drop(cut.unmark(arc, corners[0].landmark)))?;
        }
        Ok(path.length)
    }

    fn open_handle(&self, state: &mut State, arc: ArcId, [start, goal]: [Corner; 2]) -> Result<f64> {
        let State { cut, searcher, .. } = state;
        Ok(lay_across_handle(cut, self.mesh, searcher, [&[start], &[goal]], arc)?.length)
    }
}

impl State<'_> {
    /// True if the loop just laid leaves its landmark between the same arcs as on the source; it is turned around if
    /// that makes it so.
    fn turns_as_on_source(&mut self, arc: ArcId, landmark: LandmarkId) -> bool {
        for _ in 0..2 {
            let around = rotation(&self.cut, landmark, &|_| true);
            let before = |i: usize| around[(i + around.len() - 1) % around.len()];
            if (0..around.len()).all(|i| around[i].arc != arc || before(i) == self.placed.neighbour(around[i])) {
                return true;
            }
            self.cut.reverse(arc, landmark);
        }
        false
    }

    /// True if the arc just laid has the same on either side as on the source.
    fn separates_as_on_source(&mut self, arc: ArcId, first: LandmarkId) -> bool {
        let found = self.explorer.smaller_side(&self.cut, arc, first);
        found.is_some_and(|(hand, side)| self.placed.side(arc, hand) == side)
    }
}
