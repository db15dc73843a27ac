//! Auxiliary base vertices taken out of a layout again.
//!
//! They lead arcs the same way on both meshes and would only pin the map afterwards. The patches around such a vertex
//! make up a disc; its arcs go, and the disc is cut into triangles again by diagonals, each of which has one way to run
//! on either mesh. The diagonals that are shortest on both meshes together are taken first.

use crate::error::Result;
use crate::mesh::{ArcId, Id, IdVec, LandmarkId, TriMesh};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cut_mesh::CutMesh;
use crate::path::network::{Corner, connect, embed};
use crate::path::region::base_complex;
use crate::path::search::Searcher;

/// Takes out the base vertices from number `keep` on, the last first, as far as the layout allows.
///
/// A vertex stays if it has a loop that cannot be flipped away, or a single arc.
pub fn take_out(meshes: [&TriMesh; 2], cuts: &mut [CutMesh; 2], base: BaseComplex, keep: usize) -> Result<BaseComplex> {
    let mut base = base;
    for l in (keep..base.landmarks).rev().map(LandmarkId::new) {
        while let Some(flip) = Flip::of_a_loop(&base, l) {
            base = flip.make(meshes, cuts, base)?;
        }
        let Some(disc) = Disc::around(&base, l) else { continue };
        let mut work = Work { meshes, cuts, base, freed: Vec::new(), searcher: Searcher::default() };
        work.remove(&disc, l);
        work.fill(disc.walk)?;
        base = work.finish()?;
    }
    Ok(base)
}

/// An arc exchanged for the other diagonal of the quad of its two patches.
struct Flip {
    arc: ArcId,
    /// The corners that the new arc joins.
    corners: [Corner; 2],
}

impl Flip {
    /// Takes a loop at `l` away from it, if one has two patches with other vertices opposite.
    fn of_a_loop(base: &BaseComplex, l: LandmarkId) -> Option<Self> {
        let side_of = base.side_of();
        let opposite = |d: DirectedArc| {
            let (patch, side) = side_of[d.index()];
            let after = base.patches[patch][(side + 2) % 3];
            Some((patch, Corner { landmark: base.start(after), after: Some(after) })).filter(|(_, c)| c.landmark != l)
        };
        let loops = base.arcs.iter_ids().filter(|(_, ends)| **ends == [l, l]);
        loops.map(|(arc, _)| arc).find_map(|arc| {
            let [(left, from), (right, to)] = both(|reversed| opposite(DirectedArc { arc, reversed }))?;
            (left != right).then_some(Flip { arc, corners: [from, to] })
        })
    }

    /// Flips the arc on both meshes.
    fn make(&self, meshes: [&TriMesh; 2], cuts: &mut [CutMesh; 2], mut base: BaseComplex) -> Result<BaseComplex> {
        let mut searcher = Searcher::default();
        for (mesh, cut) in meshes.into_iter().zip(cuts.iter_mut()) {
            cut.unmark(self.arc, base.arcs[self.arc][0]);
            let path = connect(cut, mesh, &mut searcher, self.corners)?;
            embed(cut, mesh, &path, self.arc)?;
        }
        base.arcs[self.arc] = self.corners.map(|c| c.landmark);
        base_complex(&cuts[0], &base.arcs)
    }
}

fn both<T>(one: impl Fn(bool) -> Option<T>) -> Option<[T; 2]> {
    Some([one(false)?, one(true)?])
}

/// The patches around a vertex.
struct Disc {
    /// The arcs of the vertex.
    spokes: Vec<ArcId>,
    /// The other sides of the patches, counter-clockwise.
    walk: Vec<DirectedArc>,
}

impl Disc {
    /// The disc around `l`, unless it is bounded by fewer than two arcs or meets itself at `l`.
    fn around(base: &BaseComplex, l: LandmarkId) -> Option<Self> {
        let side_of = base.side_of();
        let is_spoke = |arc: ArcId| base.arcs[arc].contains(&l);
        let first = base.arcs.iter_ids().find(|(_, ends)| ends.contains(&l)).map(|(arc, _)| arc)?;
        let first = DirectedArc { arc: first, reversed: base.arcs[first][0] != l };
        let mut disc = Disc { spokes: Vec::new(), walk: Vec::new() };
        let mut spoke = first;
        loop {
            let (patch, side) = side_of[spoke.index()];
            let [rim, last] = [1, 2].map(|k| base.patches[patch][(side + k) % 3]);
            if is_spoke(rim.arc) {
                return None;
            }
            disc.spokes.push(spoke.arc);
            disc.walk.push(rim);
            spoke = last.flipped();
            if spoke == first {
                break;
            }
        }
        let bounded = matches!(*disc.walk, [first, second, ..] if first.arc != second.arc);
        bounded.then_some(disc)
    }
}

struct Work<'a> {
    meshes: [&'a TriMesh; 2],
    cuts: &'a mut [CutMesh; 2],
    base: BaseComplex,
    /// Arcs that are no longer in use.
    freed: Vec<ArcId>,
    searcher: Searcher,
}

impl Work<'_> {
    fn remove(&mut self, disc: &Disc, l: LandmarkId) {
        for cut in self.cuts.iter_mut() {
            for &arc in &disc.spokes {
                cut.unmark(arc, self.base.arcs[arc][0]);
            }
            cut.forget_landmark(l);
        }
        self.freed.extend(disc.spokes.iter().rev());
        for end in self.base.arcs.raw.iter_mut().flatten().filter(|end| **end > l) {
            end.0 -= 1;
        }
    }

    /// Cuts a disc, given by its boundary walk, into triangles; of two sides with nothing between, one goes.
    fn fill(&mut self, walk: Vec<DirectedArc>) -> Result<()> {
        match *walk {
            [_, _, _] => return Ok(()),
            [a, b] => {
                self.merge(a.arc, b.arc);
                return Ok(());
            }
            _ => {}
        }
        let corners: Vec<Corner> =
            walk.iter().map(|&d| Corner { landmark: self.base.start(d), after: Some(d) }).collect();
        let (i, j) = self.shortest_diagonal(&corners)?;
        let Some(arc) = self.freed.pop() else { return Ok(()) };
        self.base.arcs[arc] = [corners[i].landmark, corners[j].landmark];
        for k in 0..2 {
            let path = connect(&mut self.cuts[k], self.meshes[k], &mut self.searcher, [corners[i], corners[j]])?;
            embed(&mut self.cuts[k], self.meshes[k], &path, arc)?;
        }
        let [there, back] = [false, true].map(|reversed| DirectedArc { arc, reversed });
        self.fill(walk[i..j].iter().copied().chain([back]).collect())?;
        self.fill(walk[j..].iter().chain(&walk[..i]).copied().chain([there]).collect())
    }

    /// Takes away one of two arcs that run side by side; not one along the boundary.
    fn merge(&mut self, a: ArcId, b: ArcId) {
        let first = |arc: ArcId| self.base.arcs[arc][0];
        let gone = if self.cuts[0].is_rim(a, first(a)) { b } else { a };
        let start = first(gone);
        self.cuts.iter_mut().for_each(|cut| drop(cut.unmark(gone, start)));
        self.freed.push(gone);
    }

    /// The corners i < j of the diagonal that is shortest on both meshes, relative to their size.
    fn shortest_diagonal(&mut self, corners: &[Corner]) -> Result<(usize, usize)> {
        let n = corners.len();
        let pairs = (0..n).flat_map(|i| (i + 2..n).map(move |j| (i, j))).filter(|&(i, j)| (j + 1) % n != i);
        let mut best = (f64::INFINITY, (0, 2));
        for (i, j) in pairs {
            let mut length = 0.0;
            for k in 0..2 {
                let ends = [corners[i], corners[j]];
                let path = connect(&mut self.cuts[k], self.meshes[k], &mut self.searcher, ends)?;
                length += path.length / self.meshes[k].area().sqrt();
            }
            // A loop goes only where nothing else does.
            let is_loop = corners[i].landmark == corners[j].landmark;
            let rank = if is_loop { f64::MAX } else { length };
            if rank < best.0 {
                best = (rank, (i, j));
            }
        }
        Ok(best.1)
    }

    /// Renumbers what is left, and reads the base complex off the source.
    fn finish(self) -> Result<BaseComplex> {
        let mut arcs = IdVec::default();
        let used = |arc: ArcId| !self.freed.contains(&arc);
        let number = self.base.arcs.iter_ids().map(|(arc, &ends)| used(arc).then(|| arcs.push(ends)));
        let number: IdVec<ArcId, Option<ArcId>> = number.collect();
        for cut in self.cuts.iter_mut() {
            cut.renumber_arcs(&number);
        }
        base_complex(&self.cuts[0], &arcs)
    }
}
