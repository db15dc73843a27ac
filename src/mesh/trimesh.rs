//! An oriented triangle manifold in space: positions, triangles, connectivity.

use super::connectivity::{Connectivity, ManifoldError};
use super::id::{FaceId, IdVec, VertexId};
use super::metric;
use glam::DVec3;

/// A triangle mesh that is an oriented manifold, possibly with boundary; vertices keep the order of their file.
#[derive(Clone, Debug)]
pub struct TriMesh {
    /// Vertex positions.
    pub positions: IdVec<VertexId, DVec3>,
    /// Half-edge connectivity; also holds the triangles.
    pub conn: Connectivity,
}

impl TriMesh {
    /// Joins positions and triangles; fails, naming the first fault, if they do not form an oriented manifold.
    pub fn new(positions: Vec<DVec3>, faces: &[[VertexId; 3]]) -> Result<Self, ManifoldError> {
        let conn = Connectivity::build(positions.len(), faces)?;
        Ok(TriMesh { positions: IdVec::from_raw(positions), conn })
    }

    /// The corners of a face.
    pub fn face(&self, f: FaceId) -> [VertexId; 3] {
        self.conn.face(f)
    }

    /// The corner positions of a face.
    pub fn triangle(&self, f: FaceId) -> [DVec3; 3] {
        self.face(f).map(|v| self.positions[v])
    }

    /// All triangles in order.
    pub fn faces(&self) -> Vec<[VertexId; 3]> {
        self.conn.faces().map(|f| self.face(f)).collect()
    }

    /// Total area.
    pub fn area(&self) -> f64 {
        self.conn.faces().map(|f| metric::area(self.triangle(f))).sum()
    }

    /// Enclosed volume by the divergence theorem; negative for a closed mesh that is inside out.
    pub fn volume(&self) -> f64 {
        let six: f64 = self.conn.faces().map(|f| self.triangle(f)).map(|[a, b, c]| a.dot(b.cross(c))).sum();
        six / 6.0
    }

    /// Diagonal of the bounding box of the referenced vertices; zero without faces.
    pub fn diagonal(&self) -> f64 {
        let used = self.conn.vertices().filter(|&v| self.conn.leaving(v).is_some());
        let (low, high) = used
            .map(|v| self.positions[v])
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        if low.is_finite() { low.distance(high) } else { 0.0 }
    }

    /// Genus, of all components together: (2 components - boundary loops - Euler characteristic) / 2.
    pub fn genus(&self) -> i64 {
        let components = self.conn.components().iter().max().map_or(0, |&last| i64::from(last) + 1);
        (2 * components - self.conn.boundary_loops().len() as i64 - self.conn.euler_characteristic()) / 2
    }
}
