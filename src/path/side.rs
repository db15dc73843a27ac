//! What an arc separates from the rest of its region.

use super::base_complex::DirectedArc;
use super::cut_mesh::CutMesh;
use super::region::on_arc;
use crate::mesh::{ArcId, FaceId, HalfedgeId, IdVec, LandmarkId, VertexId, corner, face_of};

/// One side of an arc that separates its region. Two meshes with the same cyclic order of arcs around every landmark
/// have the same boundary walks, so it is enough to compare which arcs and landmarks a side holds, and its shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Side {
    /// The arcs that bound it, with it at their left, in order of number.
    pub boundary: Vec<DirectedArc>,
    /// The landmarks inside that no arc meets, in order of number.
    pub isolated: Vec<LandmarkId>,
    /// V - E + F of the open side; it is 2 - 2 genus - boundary walks.
    pub euler: i64,
}

/// Which side of an arc was looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    /// The one at the left of the arc.
    Left,
    /// The one at its right.
    Right,
}

/// Reusable working memory that finds sides: marks of faces and vertices, valid if they carry a current number.
#[derive(Default)]
pub struct Explorer {
    faces: IdVec<FaceId, u32>,
    vertices: IdVec<VertexId, u32>,
    mark: u32,
}

/// A growing set of faces.
struct Flood {
    mark: u32,
    faces: Vec<FaceId>,
    at: usize,
}

impl Explorer {
    /// The smaller side of an arc that starts at `first`, and which it is; None if the arc does not separate its region.
    ///
    /// Both sides are searched in turns, so the time is that of the smaller one.
    pub fn smaller_side(&mut self, cut: &CutMesh, arc: ArcId, first: LandmarkId) -> Option<(Hand, Side)> {
        let h = *cut.arc_path(arc, first).first()?;
        let mut floods = [self.start(cut, face_of(h)), self.start(cut, face_of(cut.conn.twin(h)?))];
        loop {
            for (k, hand) in [Hand::Left, Hand::Right].into_iter().enumerate() {
                let other = floods[1 - k].mark;
                match self.step(cut, &mut floods[k], Some(other)) {
                    Step::Met => return None,
                    Step::Done => return Some((hand, self.describe(cut, &floods[k].faces))),
                    Step::Grew => {}
                }
            }
        }
    }

    /// What lies on one side of an arc that starts at `first`; none where there is no surface.
    pub fn side_of(&mut self, cut: &CutMesh, arc: ArcId, first: LandmarkId, hand: Hand) -> Option<Side> {
        let h = *cut.arc_path(arc, first).first()?;
        let h = if hand == Hand::Left { h } else { cut.conn.twin(h)? };
        Some(self.left_of(cut, h))
    }

    /// What lies left of a half-edge that carries an arc.
    pub fn left_of(&mut self, cut: &CutMesh, h: HalfedgeId) -> Side {
        let mut flood = self.start(cut, face_of(h));
        while self.step(cut, &mut flood, None) == Step::Grew {}
        self.describe(cut, &flood.faces)
    }

    fn start(&mut self, cut: &CutMesh, seed: FaceId) -> Flood {
        self.mark += 1;
        self.faces.raw.resize(cut.conn.face_count(), 0);
        self.vertices.raw.resize(cut.conn.vertex_count(), 0);
        self.faces[seed] = self.mark;
        Flood { mark: self.mark, faces: vec![seed], at: 0 }
    }

    /// Takes one face further; `other` marks the faces of another flood, if there is one.
    fn step(&mut self, cut: &CutMesh, flood: &mut Flood, other: Option<u32>) -> Step {
        let Some(&f) = flood.faces.get(flood.at) else { return Step::Done };
        flood.at += 1;
        for h in (0..3).map(|i| corner(f, i)).filter(|&h| cut.arc_at(h).is_none()) {
            let Some(g) = cut.conn.twin(h).map(face_of) else { continue };
            if Some(self.faces[g]) == other {
                return Step::Met;
            }
            if self.faces[g] != flood.mark {
                self.faces[g] = flood.mark;
                flood.faces.push(g);
            }
        }
        Step::Grew
    }

    fn describe(&mut self, cut: &CutMesh, faces: &[FaceId]) -> Side {
        self.mark += 1;
        let mut side = Side { boundary: Vec::new(), isolated: Vec::new(), euler: faces.len() as i64 };
        let mut inner_halves = 0;
        for h in faces.iter().flat_map(|&f| (0..3).map(move |i| corner(f, i))) {
            match cut.arc_at(h) {
                Some(arc) => side.boundary.push(arc),
                None => inner_halves += 1,
            }
            let v = cut.conn.from(h);
            if self.vertices[v] != self.mark {
                self.vertices[v] = self.mark;
                let on_arc = on_arc(cut, v);
                side.euler += i64::from(!on_arc);
                side.isolated.extend(cut.landmark_at[v].filter(|_| !on_arc));
            }
        }
        side.euler -= inner_halves / 2;
        side.boundary.sort_unstable();
        side.boundary.dedup();
        side.isolated.sort_unstable();
        side
    }
}

#[derive(PartialEq, Eq)]
enum Step {
    Grew,
    Met,
    Done,
}
