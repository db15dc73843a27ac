//! The same mesh in an order that its positions alone decide.
//!
//! Files list vertices and faces in any order, and where algorithms meet a tie the lower number wins. Numbered along a
//! space-filling curve, a mesh gives the same result whatever order it came in, and neighbours lie close in memory.
//! Vertices at one position keep the order of the file among each other.
//!
//! Source of the curve: G. M. Morton, "A computer oriented geodetic data base", 1966.

use super::{FaceId, HalfedgeId, Id, IdVec, SurfacePoint, TriMesh, VertexId, face_of};
use glam::DVec3;

/// Bits per coordinate of a place on the curve; vertices in one cell of the grid are sorted by their coordinates.
const BITS: u32 = 21;

/// A mesh in canonical order and the way back to the given one.
#[derive(Clone, Debug)]
pub struct Canonical {
    /// The mesh.
    pub mesh: TriMesh,
    /// For every vertex of the given mesh its number here.
    vertex_here: IdVec<VertexId, VertexId>,
    /// For every vertex here its number in the given mesh.
    vertex_there: IdVec<VertexId, VertexId>,
    /// For every corner here its number in the given mesh, as the half-edge that leaves it.
    corner_there: IdVec<HalfedgeId, HalfedgeId>,
}

impl Canonical {
    /// Orders a mesh by its positions.
    pub fn new(given: &TriMesh) -> Self {
        Self::ordered(given, curve_order(&given.positions.raw))
    }

    /// Orders a mesh that has the triangles of another one as the other is ordered.
    pub fn like(given: &TriMesh, other: &Canonical) -> Self {
        Self::ordered(given, other.vertex_there.raw.clone())
    }

    /// A mesh that is in canonical order already.
    pub fn as_given(mesh: &TriMesh) -> Self {
        let vertices: IdVec<VertexId, VertexId> = mesh.conn.vertices().collect();
        let corner_there = mesh.conn.halfedges().collect();
        Canonical { mesh: mesh.clone(), vertex_here: vertices.clone(), vertex_there: vertices, corner_there }
    }

    fn ordered(given: &TriMesh, vertex_there: Vec<VertexId>) -> Self {
        let mut vertex_here = IdVec::filled(VertexId(0), vertex_there.len());
        for (here, &there) in vertex_there.iter().enumerate() {
            vertex_here[there] = VertexId::new(here);
        }
        let mut faces: Vec<([VertexId; 3], FaceId, usize)> =
            given.conn.faces().map(|f| turned(given, f, &vertex_here)).collect();
        faces.sort_unstable();
        let corner_there =
            faces.iter().flat_map(|&(_, f, first)| [0, 1, 2].map(|i| HalfedgeId(3 * f.0 + ((i + first) % 3) as u32)));
        let corner_there = corner_there.collect();
        let triangles: Vec<_> = faces.iter().map(|&(corners, ..)| corners).collect();
        let positions = vertex_there.iter().map(|&v| given.positions[v]).collect();
        // Renumbering changes nothing that a manifold needs.
        let mesh = TriMesh::new(positions, &triangles).expect("a manifold in another order is a manifold");
        Canonical { mesh, vertex_here, vertex_there: IdVec::from_raw(vertex_there), corner_there }
    }

    /// The number here of a vertex of the given mesh.
    pub fn vertex(&self, there: VertexId) -> VertexId {
        self.vertex_here[there]
    }

    /// The number in the given mesh of a vertex here.
    pub fn vertex_there(&self, here: VertexId) -> VertexId {
        self.vertex_there[here]
    }

    /// The number in the given mesh of a face here.
    pub fn face_there(&self, here: FaceId) -> FaceId {
        face_of(self.corner_there[HalfedgeId(3 * here.0)])
    }

    /// A point in terms of the given mesh.
    pub fn point_there(&self, here: SurfacePoint) -> SurfacePoint {
        match here {
            SurfacePoint::Vertex(v) => SurfacePoint::Vertex(self.vertex_there[v]),
            SurfacePoint::Edge(h, t) => SurfacePoint::Edge(self.corner_there[h], t),
            SurfacePoint::Face(f, mut b) => {
                let first = self.corner_there[HalfedgeId(3 * f.0)];
                b.rotate_right(first.index() % 3);
                SurfacePoint::Face(face_of(first), b)
            }
        }
    }
}

/// A face with its corners by their numbers here, the lowest first, and which corner that was.
fn turned(given: &TriMesh, f: FaceId, here: &IdVec<VertexId, VertexId>) -> ([VertexId; 3], FaceId, usize) {
    let mut corners = given.face(f).map(|v| here[v]);
    let first = (0..3).min_by_key(|&i| corners[i]).unwrap_or(0);
    corners.rotate_left(first);
    (corners, f, first)
}

/// The vertices along the curve through the positions' bounding box.
fn curve_order(positions: &[DVec3]) -> Vec<VertexId> {
    let low = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let cells = f64::from(1u32 << BITS) - 1.0;
    let side = (high - low).max_element();
    let place = |p: DVec3| {
        let cell = ((p - low) / side * cells).to_array().map(|x| x as u64); // a box without extent gives zeros
        (0..BITS).rev().fold(0, |place, bit| cell.iter().fold(place, |place, c| place << 1 | (c >> bit & 1)))
    };
    let mut order: Vec<(u64, VertexId)> = (0..).zip(positions).map(|(v, &p)| (place(p), VertexId(v))).collect();
    let exact = |a: VertexId, b: VertexId| {
        let [p, q] = [a, b].map(|v| positions[v.index()]);
        p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(p.z.total_cmp(&q.z)).then(a.cmp(&b))
    };
    order.sort_unstable_by(|a, b| a.0.cmp(&b.0).then_with(|| exact(a.1, b.1)));
    order.into_iter().map(|(_, v)| v).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> TriMesh {
        let positions = vec![DVec3::splat(9.0), DVec3::Z, DVec3::ZERO, DVec3::X, DVec3::Y];
        let faces = [[2, 4, 3], [3, 1, 2], [3, 4, 1], [4, 2, 1]].map(|f| f.map(VertexId));
        TriMesh::new(positions, &faces).expect("a tetrahedron and a loose vertex")
    }

    #[test]
    fn points_keep_their_place() {
        let given = tetrahedron();
        let canonical = Canonical::new(&given);
        for f in canonical.mesh.conn.faces() {
            let mut points = vec![SurfacePoint::Face(f, [0.5, 0.3, 0.2])];
            points.extend((0..3).map(|i| SurfacePoint::Edge(HalfedgeId(3 * f.0 + i), 0.25)));
            points.extend(canonical.mesh.face(f).map(SurfacePoint::Vertex));
            for point in points {
                let there = canonical.point_there(point);
                assert_eq!(there.position(&given), point.position(&canonical.mesh), "{point:?} is {there:?}");
            }
        }
        for v in given.conn.vertices() {
            assert_eq!(canonical.mesh.positions[canonical.vertex(v)], given.positions[v]);
        }
    }

    #[test]
    fn the_given_order_does_not_matter() {
        let given = tetrahedron();
        let faces: Vec<_> =
            given.faces().into_iter().rev().map(|[a, b, c]| [b, c, a].map(|v| VertexId(4 - v.0))).collect();
        let other = TriMesh::new(given.positions.raw.iter().rev().copied().collect(), &faces).expect("renumbered");
        let [a, b] = [&given, &other].map(Canonical::new);
        assert_eq!(
            (a.mesh.positions.raw, a.mesh.conn.face(FaceId(2))),
            (b.mesh.positions.raw, b.mesh.conn.face(FaceId(2)))
        );
    }
}
