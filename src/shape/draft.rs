//! A closed triangle manifold under construction: edges can be split, collapsed and flipped.
//!
//! Every vertex lists the faces around it. Each operation checks that the result is a manifold of the same genus and
//! leaves the mesh alone otherwise.

use super::field::{Field, project};
use glam::DVec3;

/// Marks the corners of a removed face.
const GONE: [u32; 3] = [u32::MAX; 3];
/// A collapse or flip is refused if a new face leans from the surface normal at one of its corners by more than the
/// angle with this cosine; a smaller value lets thin parts fold, a larger one keeps slivers.
const UPRIGHT: f64 = 0.35;

/// A flip must win more than this in the sum of opposite cotangents, or four points on a circle flip for ever.
const FLIP_MARGIN: f64 = 1e-9;

/// The mesh; see the module documentation.
pub struct Draft {
    /// Vertex positions; removed vertices keep theirs.
    pub positions: Vec<DVec3>,
    /// Unit surface normals at the vertices.
    pub normals: Vec<DVec3>,
    /// Wished edge length at the vertices.
    pub sizes: Vec<f64>,
    faces: Vec<[u32; 3]>,
    around: Vec<Vec<u32>>,
}

impl Draft {
    /// Takes over a closed manifold.
    pub fn new(positions: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Self {
        let mut around = vec![Vec::new(); positions.len()];
        for (f, face) in faces.iter().enumerate() {
            for &v in face {
                around[v as usize].push(f as u32);
            }
        }
        let n = positions.len();
        Draft { positions, normals: vec![DVec3::ZERO; n], sizes: vec![1.0; n], faces, around }
    }

    /// Number of vertices and faces ever made; those still in use are among them.
    pub fn capacity(&self) -> (usize, usize) {
        (self.positions.len(), self.faces.len())
    }

    /// The corners of a face, unless it was removed.
    pub fn face(&self, f: usize) -> Option<[u32; 3]> {
        (self.faces[f] != GONE).then(|| self.faces[f])
    }

    /// The neighbours of a vertex, each once; none for a removed vertex.
    pub fn neighbours(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        self.around[v as usize].iter().map(move |&f| after(self.faces[f as usize], v))
    }

    /// The number of vertices in use.
    pub fn live_vertices(&self) -> usize {
        self.around.iter().filter(|faces| !faces.is_empty()).count()
    }

    /// Length of the edge between two vertices divided by the length wished there.
    pub fn relative_length(&self, a: u32, b: u32) -> f64 {
        let wish = (self.sizes[a as usize] + self.sizes[b as usize]) * 0.5;
        self.at(a).distance(self.at(b)) / wish
    }

    /// The faces and opposite corners at the left and right of the edge from `a` to `b`.
    fn wings(&self, a: u32, b: u32) -> Option<[(u32, u32); 2]> {
        let mut wings = [None; 2];
        for &f in &self.around[a as usize] {
            let face = self.faces[f as usize];
            if after(face, a) == b {
                wings[0] = Some((f, after(face, b)));
            } else if after(face, b) == a {
                wings[1] = Some((f, after(face, a)));
            }
        }
        Some([wings[0]?, wings[1]?])
    }

    /// Puts a new vertex on the surface near the middle of an edge.
    pub fn split(&mut self, a: u32, b: u32, field: &Field) {
        let Some(wings) = self.wings(a, b) else { return };
        let m = self.positions.len() as u32;
        let (position, normal) = project(field, self.at(a).midpoint(self.at(b)));
        self.positions.push(position);
        self.normals.push(normal);
        self.sizes.push((self.sizes[a as usize] + self.sizes[b as usize]) * 0.5);
        self.around.push(Vec::new());
        for (f, _) in wings {
            let old = self.faces[f as usize];
            self.set_face(f, replace(old, b, m));
            self.faces.push(GONE);
            self.set_face(self.faces.len() as u32 - 1, replace(old, a, m));
        }
    }

    /// Merges `a` into `b`, unless that changes the topology, folds the surface, or makes an edge longer than
    /// `longest` times the wish.
    pub fn collapse(&mut self, a: u32, b: u32, longest: f64) -> bool {
        let Some(wings) = self.wings(a, b) else { return false };
        let shared = self.neighbours(a).filter(|&v| self.neighbours(b).any(|w| w == v)).count();
        let thin = wings.iter().any(|&(_, c)| self.around[c as usize].len() <= 3);
        if shared != 2 || thin || !self.may_move(a, b, wings, longest) {
            return false;
        }
        for (f, _) in wings {
            self.set_face(f, GONE);
        }
        for f in self.around[a as usize].clone() {
            self.set_face(f, replace(self.faces[f as usize], a, b));
        }
        true
    }

    fn may_move(&self, a: u32, b: u32, wings: [(u32, u32); 2], longest: f64) -> bool {
        let kept = self.around[a as usize].iter().filter(|&&f| wings.iter().all(|&(g, _)| g != f));
        let short = self.neighbours(a).all(|v| v == b || self.relative_length(b, v) < longest);
        short && kept.into_iter().all(|&f| self.is_upright(replace(self.faces[f as usize], a, b)))
    }

    /// Replaces an edge by the other diagonal of its two faces if that is Delaunay and folds nothing.
    pub fn flip(&mut self, a: u32, b: u32) -> bool {
        let Some([(f, c), (g, d)]) = self.wings(a, b) else { return false };
        let delaunay = self.cotangent(c, a, b) + self.cotangent(d, a, b);
        let degrees = [a, b].map(|v| self.around[v as usize].len());
        let (left, right) = ([a, d, c], [d, b, c]);
        let allowed = degrees.iter().all(|&n| n > 3) && self.neighbours(c).all(|v| v != d);
        if delaunay > -FLIP_MARGIN || !allowed || !self.is_upright(left) || !self.is_upright(right) {
            return false;
        }
        self.set_face(f, left);
        self.set_face(g, right);
        true
    }

    /// Cotangent of the angle at a corner between two others.
    fn cotangent(&self, at: u32, a: u32, b: u32) -> f64 {
        let (u, w) = (self.at(a) - self.at(at), self.at(b) - self.at(at));
        u.dot(w) / u.cross(w).length().max(f64::MIN_POSITIVE)
    }

    fn is_upright(&self, face: [u32; 3]) -> bool {
        let [a, b, c] = face.map(|v| self.at(v));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        face.iter().all(|&v| normal.dot(self.normals[v as usize]) > UPRIGHT)
    }

    fn set_face(&mut self, f: u32, face: [u32; 3]) {
        for v in self.faces[f as usize] {
            if v != u32::MAX {
                self.around[v as usize].retain(|&g| g != f);
            }
        }
        self.faces[f as usize] = face;
        for v in face {
            if v != u32::MAX {
                self.around[v as usize].push(f);
            }
        }
    }

    fn at(&self, v: u32) -> DVec3 {
        self.positions[v as usize]
    }

    /// The same mesh without the gaps that removed vertices and faces leave; normals and sizes start anew.
    pub fn compacted(self) -> Self {
        let (positions, faces) = self.finish();
        Draft::new(positions, faces)
    }

    /// The vertices and faces in use, renumbered in order.
    pub fn finish(self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let mut number = vec![u32::MAX; self.positions.len()];
        let mut positions = Vec::new();
        for (v, _) in self.around.iter().enumerate().filter(|(_, faces)| !faces.is_empty()) {
            number[v] = positions.len() as u32;
            positions.push(self.positions[v]);
        }
        let live = self.faces.iter().filter(|&&face| face != GONE);
        (positions, live.map(|face| face.map(|v| number[v as usize])).collect())
    }
}

/// The corner after `v` in a face that has it.
fn after(face: [u32; 3], v: u32) -> u32 {
    match face.iter().position(|&w| w == v) {
        Some(i) => face[(i + 1) % 3],
        None => u32::MAX,
    }
}

fn replace(face: [u32; 3], old: u32, new: u32) -> [u32; 3] {
    face.map(|v| if v == old { new } else { v })
}
