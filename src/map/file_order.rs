//! Points of a mesh in the terms of its file.

use crate::mesh::{FaceId, Id, SurfacePoint, TriMesh, VertexId};

/// The mesh that image points lie on, with its triangles' corners in the order of its file.
///
/// The orders differ where a triangle had to be turned over; files speak of the file's order.
#[derive(Clone, Copy, Debug)]
pub struct Onto<'a> {
    /// The mesh.
    pub mesh: &'a TriMesh,
    /// The file's triangles.
    pub triangles: &'a [[VertexId; 3]],
    /// The numbers of those that the mesh lacks, in order.
    pub omitted: &'a [FaceId],
}

impl Onto<'_> {
    /// A point as face and barycentric coordinates in the file's corner order; None at a vertex that no face uses.
    pub fn in_file_order(self, point: SurfacePoint) -> Option<(FaceId, [f64; 3])> {
        let (f, b) = point.on_face(self.mesh)?;
        Some(self.to_file_order(f, b))
    }

    /// The file's number of a face and barycentric coordinates in its corner order there.
    pub fn to_file_order(self, f: FaceId, b: [f64; 3]) -> (FaceId, [f64; 3]) {
        let number = number_in_file(f, self.omitted);
        (number, reordered(b, self.mesh.face(f), self.triangles[number.index()]))
    }

    /// The point at barycentric coordinates in a triangle of the file; None in one that the mesh lacks.
    pub fn from_file_order(self, number: FaceId, b: [f64; 3]) -> Option<SurfacePoint> {
        let before = self.omitted.partition_point(|&o| o < number);
        if self.omitted.get(before) == Some(&number) {
            return None;
        }
        let f = FaceId::new(number.index() - before);
        let b = reordered(b, self.triangles[number.index()], self.mesh.face(f));
        Some(SurfacePoint::from_barycentric(self.mesh, f, b))
    }
}

/// The file's number of a face of a mesh that lacks the file's triangles `omitted`, given in order.
pub fn number_in_file(f: FaceId, omitted: &[FaceId]) -> FaceId {
    omitted.iter().fold(f, |f, &o| if o <= f { FaceId(f.0 + 1) } else { f })
}

/// The coordinates `b` of corners `given`, for the same corners in the order `wanted`.
fn reordered(b: [f64; 3], given: [VertexId; 3], wanted: [VertexId; 3]) -> [f64; 3] {
    wanted.map(|v| given.iter().zip(b).find_map(|(&w, x)| (w == v).then_some(x)).unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_triangle_that_was_turned_over_keeps_the_order_of_its_file() {
        let (kept, turned) = ([0, 1, 2].map(VertexId), [0, 2, 1].map(VertexId));
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mesh = TriMesh::new(positions, &[turned]).expect("one triangle is a manifold");
        let onto = Onto { mesh: &mesh, triangles: &[kept], omitted: &[] };
        assert_eq!(
            onto.in_file_order(SurfacePoint::Face(FaceId(0), [0.5, 0.2, 0.3])),
            Some((FaceId(0), [0.5, 0.3, 0.2]))
        );
        let read = onto.from_file_order(FaceId(0), [0.5, 0.3, 0.2]);
        assert_eq!(read, Some(SurfacePoint::Face(FaceId(0), [0.5, 0.2, 0.3])));
        assert_eq!(onto.in_file_order(SurfacePoint::Vertex(VertexId(1))), Some((FaceId(0), [0.0, 1.0, 0.0])));
    }
}
