//! Arcs on and off a cut mesh.

use super::CutMesh;
use crate::error::{Error, Result};
use crate::mesh::{ArcId, HalfedgeId, Id, IdVec, LandmarkId, VertexId};
use crate::path::base_complex::DirectedArc;

impl CutMesh {
    /// Lets `arc` run along `h`.
    pub fn mark(&mut self, h: HalfedgeId, arc: DirectedArc) {
        self.arc_at[h] = Some(arc);
        if let Some(t) = self.conn.twin(h) {
            self.arc_at[t] = Some(arc.flipped());
        }
        self.blocked[self.conn.from(h)] = true;
        let to = self.conn.to(h);
        self.blocked[to] = true;
    }

    /// Takes an arc, given by its number and its first end, off the mesh; returns the vertices it passed.
    ///
    /// The vertices it made stay, as ordinary ones.
    pub fn unmark(&mut self, arc: ArcId, first: LandmarkId) -> Vec<VertexId> {
        let path = self.arc_path(arc, first);
        for &h in &path {
            for side in [Some(h), self.conn.twin(h)].into_iter().flatten() {
                self.arc_at[side] = None;
            }
            for v in [self.conn.from(h), self.conn.to(h)] {
                self.blocked[v] = self.landmark_at[v].is_some();
            }
        }
        let start = path.first().map(|&h| self.conn.from(h));
        start.into_iter().chain(path.iter().map(|&h| self.conn.to(h))).collect()
    }

    /// Lets `arc` run along the edges between the vertices.
    pub fn mark_along(&mut self, vertices: &[VertexId], arc: ArcId) -> Result<()> {
        for ends in vertices.windows(2) {
            let h = self.conn.find(ends[0], ends[1]);
            let h = h.ok_or_else(|| Error::bug("an arc runs where no edge is").at(format!("{arc} at {}", ends[0])))?;
            self.mark(h, DirectedArc { arc, reversed: false });
        }
        Ok(())
    }

    /// Makes a landmark without arcs an ordinary vertex; those behind it move up by one number.
    pub fn forget_landmark(&mut self, l: LandmarkId) {
        let v = self.landmarks[l];
        self.blocked[v] = false;
        self.landmark_at[v] = None;
        self.landmarks.raw.remove(l.index());
        for (l, &v) in self.landmarks.iter_ids() {
            self.landmark_at[v] = Some(l);
        }
    }

    /// Gives arcs new numbers; those on the mesh must have one.
    pub fn renumber_arcs(&mut self, number: &IdVec<ArcId, Option<ArcId>>) {
        for on in &mut self.arc_at.raw {
            *on = on.and_then(|d| Some(DirectedArc { arc: number[d.arc]?, ..d }));
        }
    }

    /// Exchanges the two ends of an arc; they must be one landmark.
    pub fn reverse(&mut self, arc: ArcId, end: LandmarkId) {
        for h in self.arc_path(arc, end) {
            self.mark(h, DirectedArc { arc, reversed: true });
        }
    }

    /// True if an arc, given by its number and its first end, runs along the boundary.
    pub fn is_rim(&self, arc: ArcId, first: LandmarkId) -> bool {
        self.arc_path(arc, first).first().is_some_and(|&h| self.conn.twin(h).is_none())
    }

    /// The half-edges of an arc from its first end to its second.
    pub fn arc_path(&self, arc: ArcId, first: LandmarkId) -> Vec<HalfedgeId> {
        let wanted = Some(DirectedArc { arc, reversed: false });
        let mut at = self.landmarks[first];
        let mut path: Vec<HalfedgeId> = Vec::new();
        while let Some(h) = self.conn.outgoing(at).find(|&h| self.arc_at[h] == wanted) {
            path.push(h);
            at = self.conn.to(h);
            if self.landmark_at[at].is_some() {
                break;
            }
        }
        path
    }

    /// Length of every arc, given by its ends, in mesh units.
    pub fn arc_lengths(&self, arcs: &IdVec<ArcId, [LandmarkId; 2]>) -> IdVec<ArcId, f64> {
        arcs.iter_ids().map(|(arc, ends)| self.arc_length(arc, ends[0])).collect()
    }

    /// Length of the arc that starts at a landmark.
    pub fn arc_length(&self, arc: ArcId, first: LandmarkId) -> f64 {
        self.arc_path(arc, first).into_iter().map(|h| self.length(h)).sum()
    }
}
