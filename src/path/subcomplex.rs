//! Some of the arcs of a base complex, and the regions they leave, told from the complex alone.
//!
//! The patches and the cyclic order of arcs around the landmarks are all there is to know: which patches the absent arcs
//! join, what an absent arc would separate, and between which arcs it ends.

use super::base_complex::{BaseComplex, DirectedArc};
use super::network::Corner;
use super::side::{Hand, Side};
use crate::mesh::{ArcId, IdVec, LandmarkId, PatchId};

/// What an absent arc would do to the region it runs through.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Role {
    /// It joins two boundary walks, or a landmark without arcs to something else.
    Joins,
    /// It ends where it starts, on one walk or at one landmark, and leaves the region in one piece.
    OpensHandle,
    /// It separates the region.
    Separates,
}

/// A base complex of which some arcs are present.
pub struct Subcomplex<'a> {
    base: &'a BaseComplex,
    side_of: Vec<(PatchId, usize)>,
    present: IdVec<ArcId, bool>,
    /// Number of ends of present arcs at each landmark.
    degree: IdVec<LandmarkId, u32>,
}

impl<'a> Subcomplex<'a> {
    /// The landmarks alone.
    pub fn bare(base: &'a BaseComplex) -> Self {
        let present = IdVec::filled(false, base.arcs.len());
        let degree = IdVec::filled(0, base.landmarks);
        Subcomplex { base, side_of: base.side_of(), present, degree }
    }

    /// All landmarks and arcs.
    pub fn complete(base: &'a BaseComplex) -> Self {
        let mut all = Self::bare(base);
        base.arcs.ids().for_each(|arc| all.add(arc));
        all
    }

    /// Adds an arc.
    pub fn add(&mut self, arc: ArcId) {
        self.present[arc] = true;
        for l in self.base.arcs[arc] {
            self.degree[l] += 1;
        }
    }

    /// The corner that an end of an arc leaves: behind the present arc before it, other than itself.
    pub fn corner_behind(&self, end: DirectedArc) -> Corner {
        let after = self.before(end, |d| d.arc != end.arc && self.present[d.arc]);
        Corner { landmark: self.base.start(end), after: (after.arc != end.arc).then_some(after) }
    }

    /// The next end clockwise of an end around its landmark, among the present arcs and the arc itself.
    pub fn neighbour(&self, end: DirectedArc) -> DirectedArc {
        self.before(end, |d| self.bounds(d.arc, end.arc))
    }

    /// The first of the arcs clockwise of an end around its landmark that fits; the end itself if none does.
    fn before(&self, end: DirectedArc, fits: impl Fn(DirectedArc) -> bool) -> DirectedArc {
        let mut at = end;
        loop {
            let (patch, side) = self.side_of[at.flipped().index()];
            at = self.base.patches[patch][(side + 1) % 3];
            if at == end || fits(at) {
                return at;
            }
        }
    }

    /// What an absent arc would do.
    pub fn role(&self, arc: ArcId) -> Role {
        let [start, end] = both_ways(arc).map(|d| self.corner_behind(d));
        let same_walk = match (start.after, end.after) {
            (None, None) => start.landmark == end.landmark,
            (Some(from), Some(to)) => self.walk(from).contains(&to),
            _ => false,
        };
        let [left, right] = both_ways(arc).map(|d| self.side_of[d.index()].0);
        if !same_walk {
            Role::Joins
        } else if self.reachable(left, arc)[right] {
            Role::OpensHandle
        } else {
            Role::Separates
        }
    }

    /// One side of an absent arc that separates.
    pub fn side(&self, arc: ArcId, hand: Hand) -> Side {
        let [left, right] = both_ways(arc).map(|d| self.side_of[d.index()].0);
        let inside = self.reachable(if hand == Hand::Left { left } else { right }, arc);
        let mut side = Side { boundary: Vec::new(), isolated: Vec::new(), euler: 0 };
        let mut inner_halves = 0;
        for (p, sides) in self.base.patches.iter_ids().filter(|&(p, _)| inside[p]) {
            side.euler += 1;
            for &d in sides {
                if self.bounds(d.arc, arc) {
                    side.boundary.push(d);
                } else {
                    inner_halves += 1;
                }
            }
            let alone = |l: &LandmarkId| self.degree[*l] == 0 && !self.base.arcs[arc].contains(l);
            side.isolated.extend(self.base.corners(p).into_iter().filter(alone));
        }
        side.boundary.sort_unstable();
        side.isolated.sort_unstable();
        side.isolated.dedup();
        side.euler += side.isolated.len() as i64 - inner_halves / 2;
        side
    }

    /// The boundary walk that a present arc is part of, with the region at its left.
    fn walk(&self, first: DirectedArc) -> Vec<DirectedArc> {
        let mut walk = vec![first];
        loop {
            let next = self.before(walk[walk.len() - 1].flipped(), |d| self.present[d.arc]);
            if next == first {
                return walk;
            }
            walk.push(next);
        }
    }

    /// The patches that absent arcs other than `wall` join to `seed`.
    fn reachable(&self, seed: PatchId, wall: ArcId) -> IdVec<PatchId, bool> {
        let mut reached = IdVec::filled(false, self.base.patches.len());
        reached[seed] = true;
        let mut stack = vec![seed];
        while let Some(p) = stack.pop() {
            for d in self.base.patches[p].iter().filter(|d| !self.bounds(d.arc, wall)) {
                let (q, _) = self.side_of[d.flipped().index()];
                if !std::mem::replace(&mut reached[q], true) {
                    stack.push(q);
                }
            }
        }
        reached
    }

    fn bounds(&self, arc: ArcId, wall: ArcId) -> bool {
        self.present[arc] || arc == wall
    }
}

/// An arc forwards and backwards.
fn both_ways(arc: ArcId) -> [DirectedArc; 2] {
    [false, true].map(|reversed| DirectedArc { arc, reversed })
}
