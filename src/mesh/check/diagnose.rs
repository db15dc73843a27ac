//! Finds every fault of connectivity, and the faces to turn over where orientation is all that is wrong.
//!
//! A face that is a fault in itself (bad corners, a copy of another) is reported once and then left out, so that it does
//! not show up again as a non-manifold edge.

use super::parity::Parity;
use super::report::{Component, Fault};
use crate::mesh::{FaceId, HalfedgeId, VertexId, next};
use rayon::prelude::*;

/// What is wrong with the connectivity of a mesh.
#[derive(Default)]
pub struct Diagnosis {
    /// All faults, by kind and then by element.
    pub faults: Vec<Fault>,
    /// The faces to turn over.
    pub flipped: Vec<FaceId>,
    /// The components, as far as they can be told: faces only.
    pub components: Vec<Component>,
}

/// The mesh under examination.
struct Faces<'a> {
    triangles: &'a [[VertexId; 3]],
    /// True for the faces that are not faults in themselves.
    sound: Vec<bool>,
}

/// Looks for every fault of connectivity.
pub fn diagnose(vertices: usize, triangles: &[[VertexId; 3]]) -> Diagnosis {
    let mut faces = Faces { triangles, sound: vec![true; triangles.len()] };
    let mut diagnosis = Diagnosis::default();
    faces.check_corners(vertices, &mut diagnosis.faults);
    faces.check_copies(&mut diagnosis.faults);
    let halfedges = faces.by_edge();
    let edges: Vec<&[(u64, u32)]> = halfedges.chunk_by(|a, b| a.0 == b.0).collect();
    faces.check_edges(&edges, &mut diagnosis.faults);
    faces.check_fans(vertices, &edges, &mut diagnosis.faults);
    faces.orient(&edges, &mut diagnosis);
    diagnosis.components = faces.components(&edges);
    diagnosis
}

/// The face of a half-edge by number.
fn face(h: u32) -> u32 {
    h / 3
}

impl Faces<'_> {
    fn from(&self, h: u32) -> VertexId {
        self.triangles[face(h) as usize][(h % 3) as usize]
    }

    fn sound_faces(&self) -> impl Iterator<Item = (FaceId, [VertexId; 3])> {
        let all = (0..).zip(self.triangles).zip(&self.sound);
        all.filter(|(_, sound)| **sound).map(|((f, &corners), _)| (FaceId(f), corners))
    }

    /// Out-of-range and repeated corners.
    fn check_corners(&mut self, vertices: usize, faults: &mut Vec<Fault>) {
        for (f, &[a, b, c]) in self.triangles.iter().enumerate() {
            let face = FaceId(f as u32);
            let outside = [a, b, c].into_iter().filter(|v| v.0 as usize >= vertices);
            let before = faults.len();
            faults.extend(outside.map(|vertex| Fault::OutOfRange { face, vertex, vertices }));
            if a == b || b == c || c == a {
                faults.push(Fault::RepeatedVertex { face, vertex: if b == c { b } else { a } });
            }
            self.sound[f] = faults.len() == before;
        }
    }

    /// Faces on the same three vertices.
    fn check_copies(&mut self, faults: &mut Vec<Fault>) {
        let key = |(f, mut corners): (FaceId, [VertexId; 3])| {
            corners.sort_unstable();
            (corners, f)
        };
        let mut keys: Vec<_> = self.sound_faces().map(key).collect();
        keys.par_sort_unstable();
        let mut copies: Vec<_> = keys
            .chunk_by(|a, b| a.0 == b.0)
            .flat_map(|group| group[1..].iter().map(|&(_, face)| (face, group[0].1)))
            .collect();
        copies.sort_unstable();
        for (face, first) in copies {
            self.sound[face.0 as usize] = false;
            faults.push(Fault::DuplicateFace { face, first });
        }
    }

    /// The half-edges of sound faces, sorted by edge and then by number.
    fn by_edge(&self) -> Vec<(u64, u32)> {
        let mut halfedges: Vec<(u64, u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (f, corners) in self.sound_faces() {
            for i in 0..3 {
                let (a, b) = (corners[i].0, corners[(i + 1) % 3].0);
                halfedges.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), 3 * f.0 + i as u32));
            }
        }
        halfedges.par_sort_unstable();
        halfedges
    }

    fn edge_ends(&self, edge: &[(u64, u32)]) -> [VertexId; 2] {
        let key = edge[0].0;
        [VertexId((key >> 32) as u32), VertexId(key as u32)]
    }

    /// Edges of more than two faces.
    fn check_edges(&self, edges: &[&[(u64, u32)]], faults: &mut Vec<Fault>) {
        faults.extend(edges.iter().filter(|edge| edge.len() > 2).map(|edge| Fault::NonManifoldEdge {
            vertices: self.edge_ends(edge),
            faces: edge.iter().map(|&(_, h)| FaceId(face(h))).collect(),
        }));
    }

    /// Vertices whose faces do not hang together by edges.
    fn check_fans(&self, vertices: usize, edges: &[&[(u64, u32)]], faults: &mut Vec<Fault>) {
        let mut corners = Parity::new(3 * self.triangles.len());
        for (h, k) in neighbours(edges) {
            let ends = |h: u32| [h, next(HalfedgeId(h)).0];
            let ([h0, h1], [k0, k1]) = (ends(h), ends(k));
            let (k0, k1) = if self.from(h0) == self.from(k0) { (k0, k1) } else { (k1, k0) };
            corners.join(h0, k0, false);
            corners.join(h1, k1, false);
        }
        let mut fans = vec![0usize; vertices];
        for (f, triangle) in self.sound_faces() {
            for (c, v) in (3 * f.0..).zip(triangle) {
                fans[v.0 as usize] += usize::from(corners.find(c).0 == c);
            }
        }
        let split = (0..).zip(fans).filter(|&(_, fans)| fans > 1);
        faults.extend(split.map(|(v, fans)| Fault::NonManifoldVertex { vertex: VertexId(v), fans }));
    }

    /// Finds the fewest faces to turn over so that neighbours agree, or the edge where that is impossible.
    fn orient(&self, edges: &[&[(u64, u32)]], diagnosis: &mut Diagnosis) {
        let mut signs = Parity::new(self.triangles.len());
        let mut clashes = Vec::new();
        for edge in edges.iter().filter(|edge| edge.len() == 2) {
            let (h, k) = (edge[0].1, edge[1].1);
            if !signs.join(face(h), face(k), self.from(h) == self.from(k)) {
                clashes.push((self.edge_ends(edge), [FaceId(face(h)), FaceId(face(k))]));
            }
        }
        let mut one_sided = vec![false; self.triangles.len()];
        for (vertices, faces) in clashes {
            let (root, _) = signs.find(faces[0].0);
            if !std::mem::replace(&mut one_sided[root as usize], true) {
                diagnosis.faults.push(Fault::NotOrientable { vertices, faces });
            }
        }
        let mut balance = vec![0i64; self.triangles.len()];
        for (f, _) in self.sound_faces() {
            let (root, opposite) = signs.find(f.0);
            balance[root as usize] += if opposite { -1 } else { 1 };
        }
        for (f, _) in self.sound_faces() {
            let (root, opposite) = signs.find(f.0);
            if !one_sided[root as usize] && opposite == (balance[root as usize] >= 0) {
                diagnosis.flipped.push(f);
            }
        }
    }

    /// The sets of faces that hang together by edges, in the order of their first faces.
    fn components(&self, edges: &[&[(u64, u32)]]) -> Vec<Component> {
        let mut sets = Parity::new(self.triangles.len());
        for (h, k) in neighbours(edges) {
            sets.join(face(h), face(k), false);
        }
        let mut sizes = vec![0; self.triangles.len()];
        for (f, _) in self.sound_faces() {
            sizes[sets.find(f.0).0 as usize] += 1;
        }
        let components = (0..).zip(sizes).filter(|&(_, faces)| faces > 0);
        components.map(|(f, faces)| Component { first_face: FaceId(f), faces, ..Component::default() }).collect()
    }
}

/// Pairs of half-edges of one edge, enough to link all of them.
fn neighbours<'a>(edges: &'a [&[(u64, u32)]]) -> impl Iterator<Item = (u32, u32)> + 'a {
    edges.iter().flat_map(|edge| edge.windows(2).map(|pair| (pair[0].1, pair[1].1)))
}
