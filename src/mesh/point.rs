//! A point on a surface, as combinatorics plus coordinates inside one element.

use super::id::{FaceId, HalfedgeId, VertexId};
use super::trimesh::TriMesh;
use super::{corner, face_of};
use glam::DVec3;

/// A point on a triangle mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfacePoint {
    /// At a vertex.
    Vertex(VertexId),
    /// On an edge, at the share `t` in (0, 1) of the way along the half-edge.
    Edge(HalfedgeId, f64),
    /// In a face, with barycentric coordinates in corner order that sum to one.
    Face(FaceId, [f64; 3]),
}

impl SurfacePoint {
    /// The position in space.
    pub fn position(self, mesh: &TriMesh) -> DVec3 {
        match self {
            SurfacePoint::Vertex(v) => mesh.positions[v],
            SurfacePoint::Edge(h, t) => {
                mesh.positions[mesh.conn.from(h)] * (1.0 - t) + mesh.positions[mesh.conn.to(h)] * t
            }
            SurfacePoint::Face(f, b) => {
                let [p, q, r] = mesh.face(f).map(|v| mesh.positions[v]);
                p * b[0] + q * b[1] + r * b[2]
            }
        }
    }

    /// The point's barycentric coordinates in face `f`; None if `f` does not contain it.
    pub fn barycentric_in(self, mesh: &TriMesh, f: FaceId) -> Option<[f64; 3]> {
        match self {
            SurfacePoint::Vertex(v) => {
                let i = mesh.face(f).iter().position(|&w| w == v)?;
                Some(std::array::from_fn(|k| f64::from(u8::from(k == i))))
            }
            SurfacePoint::Edge(h, t) => {
                let (h, t) = match mesh.conn.twin(h) {
                    Some(k) if face_of(k) == f => (k, 1.0 - t),
                    _ if face_of(h) == f => (h, t),
                    _ => return None,
                };
                let mut b = [0.0; 3];
                b[(h.0 % 3) as usize] = 1.0 - t;
                b[((h.0 + 1) % 3) as usize] = t;
                Some(b)
            }
            SurfacePoint::Face(g, b) => (g == f).then_some(b),
        }
    }

    /// The point as face and barycentric coordinates; None for an unreferenced vertex.
    pub fn on_face(self, mesh: &TriMesh) -> Option<(FaceId, [f64; 3])> {
        let f = match self {
            SurfacePoint::Vertex(v) => face_of(mesh.conn.leaving(v)?),
            SurfacePoint::Edge(h, _) => face_of(h),
            SurfacePoint::Face(f, _) => f,
        };
        self.barycentric_in(mesh, f).map(|b| (f, b))
    }

    /// The point of face `f` with barycentric coordinates `b`, as the lowest-dimensional element that contains it.
    ///
    /// A coordinate counts as zero only if it is exactly zero.
    pub fn from_barycentric(mesh: &TriMesh, f: FaceId, b: [f64; 3]) -> Self {
        let zero = b.map(|x| x == 0.0);
        for i in 0..3 {
            if zero[(i + 1) % 3] && zero[(i + 2) % 3] {
                return SurfacePoint::Vertex(mesh.face(f)[i]);
            }
        }
        for i in 0..3 {
            if zero[(i + 2) % 3] {
                return SurfacePoint::Edge(corner(f, i), b[(i + 1) % 3] / (b[i] + b[(i + 1) % 3]));
            }
        }
        SurfacePoint::Face(f, b)
    }
}
