//! Turned-over triangles of a compatible mesh.
//!
//! The map itself is certified in the base triangles; a compatible mesh only samples it at the vertices, so a coarse
//! triangle that spans a fold of the target can still come out turned over. These functions find such triangles.

use super::distortion::DEGENERATE_SHARE;
use crate::mesh::face_tree::FaceTree;
use crate::mesh::{FaceId, Id, IdVec, SurfacePoint, TriMesh, VertexId, face_of, metric};
use glam::DVec3;
use std::cell::OnceCell;

/// Faces of the target within this share of its diagonal, and the distance of a triangle's middle from the target on
/// top, say which side of that triangle is out: less takes coarse triangles across sharp edges for turned over, more
/// lets the far wall of a thin part excuse a triangle that is.
pub const NEARBY: f64 = 0.01;

/// The triangles of `mesh` that are collapsed or turned over on `target`, in order.
///
/// `points` are the vertices' images (None without one, for a vertex that no face uses), `image` their positions.
///
/// Turned over: the image's normal opposes the normals of *all* faces of the target near its middle, which are those
/// within the middle's own distance from the target plus [`NEARBY`] of the target's diagonal. So a triangle that cuts
/// a corner of the target with its front outward is sound, whatever the faces say that carry its vertices. Degenerate
/// target faces have no normal and do not vote; without a vote a triangle counts as sound.
pub fn flips_on_target(
    mesh: &TriMesh,
    target: &TriMesh,
    points: &IdVec<VertexId, Option<SurfacePoint>>,
    image: &IdVec<VertexId, DVec3>,
) -> Vec<FaceId> {
    let normals: IdVec<FaceId, DVec3> = target.conn.faces().map(|f| area_vector(target.triangle(f))).collect();
    let nearby = NEARBY * target.diagonal();
    let tree = OnceCell::new();
    let mut carriers = Vec::new();
    turned(&mesh.faces(), image, |t, normal| {
        let middle = t.iter().map(|&v| image[v]).sum::<DVec3>() / 3.0;
        carriers.clear();
        t.iter().filter_map(|&v| points[v]).for_each(|p| push_carriers(target, p, &mut carriers));
        // Most triangles are settled by a face that carries them; the tree is for the others.
        let agrees = |g: FaceId| normal.dot(normals[g]) > 0.0;
        let is_near = |g: FaceId| metric::distance_sq(middle, target.triangle(g)) <= nearby * nearby;
        if carriers.iter().any(|&g| agrees(g) && is_near(g)) {
            return false;
        }
        let tree = tree.get_or_init(|| FaceTree::new(target));
        let radius = tree.distance(middle) + nearby;
        let opposes = |g: FaceId| normal.dot(normals[g]) < 0.0;
        !tree.any_within(middle, radius, agrees) && tree.any_within(middle, radius, opposes)
    })
}

/// The triangles that are collapsed or turned over against their surroundings, for a compatible mesh whose target is
/// not at hand: the normal opposes the area vectors of the rings of all three corners.
///
/// The area vector of a closed ring does not depend on its middle vertex, so a vertex pushed over its neighbours is
/// found; a region that is turned over as a whole is not.
pub fn local_flips(faces: &[[VertexId; 3]], image: &IdVec<VertexId, DVec3>) -> Vec<FaceId> {
    let mut rings = IdVec::filled(DVec3::ZERO, image.len());
    for t in faces {
        let normal = area_vector(t.map(|v| image[v]));
        for v in t {
            rings[*v] += normal;
        }
    }
    turned(faces, image, |t, normal| opposes_all(normal, t.into_iter().map(|v| rings[v])))
}

/// The faces whose image is collapsed, or for which `is_turned` holds of the corners and the image's area vector.
fn turned(
    faces: &[[VertexId; 3]],
    image: &IdVec<VertexId, DVec3>,
    mut is_turned: impl FnMut([VertexId; 3], DVec3) -> bool,
) -> Vec<FaceId> {
    let total: f64 = faces.iter().map(|t| metric::area(t.map(|v| image[v]))).sum();
    let smallest = DEGENERATE_SHARE * total / faces.len().max(1) as f64;
    let mut is_flip = |t: [VertexId; 3]| {
        let normal = area_vector(t.map(|v| image[v]));
        let is_sound = normal.length() * 0.5 > smallest;
        !is_sound || is_turned(t, normal)
    };
    (0..faces.len()).filter(|&i| is_flip(faces[i])).map(FaceId::new).collect()
}

/// Twice the area times the unit normal.
fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// True if there is a non-zero vector among `others` and `normal` points against each of them.
fn opposes_all(normal: DVec3, others: impl Iterator<Item = DVec3>) -> bool {
    let mut votes = others.filter(|n| *n != DVec3::ZERO).peekable();
    votes.peek().is_some() && votes.all(|n| normal.dot(n) < 0.0)
}

/// Appends the faces of `target` that contain `point`.
fn push_carriers(target: &TriMesh, point: SurfacePoint, carriers: &mut Vec<FaceId>) {
    match point {
        SurfacePoint::Vertex(v) => carriers.extend(target.conn.outgoing(v).map(face_of)),
        SurfacePoint::Edge(h, _) => carriers.extend([Some(h), target.conn.twin(h)].into_iter().flatten().map(face_of)),
        SurfacePoint::Face(f, _) => carriers.push(f),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::corner;

    /// ```text
    ///      ______        a wedge with a sharp rim at the right: a triangle whose corners lie on the lower side and
    ///     /______>       whose middle is at the rim faces up; the upper side, close by, agrees with it
    /// ```
    #[test]
    fn a_triangle_that_spans_a_sharp_rim_is_sound() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let rim = [at(1.0, -1.0, 0.0), at(1.0, 1.0, 0.0)];
        let thick = 0.001;
        let far = [at(-1.0, -1.0, -thick), at(-1.0, 1.0, -thick), at(-1.0, -1.0, thick), at(-1.0, 1.0, thick)];
        let positions = rim.into_iter().chain(far).collect();
        let faces = [[0, 1, 5], [0, 5, 4], [1, 0, 2], [1, 2, 3]].map(|t| t.map(VertexId));
        let wedge = TriMesh::new(positions, &faces).expect("a wedge is a manifold");
        let low = |x: f64, y: f64| SurfacePoint::Face(FaceId(2), barycentric(&wedge, FaceId(2), x, y));
        let one = TriMesh::new(vec![DVec3::ZERO; 3], &[[0, 1, 2].map(VertexId)]).expect("a triangle is a manifold");
        let up = IdVec::from_raw(vec![Some(low(0.70, -0.5)), Some(low(0.75, -0.5)), Some(low(0.75, -0.45))]);
        let image = up.iter().map(|p| p.map_or(DVec3::ZERO, |p| p.position(&wedge))).collect();
        assert!(flips_on_target(&one, &wedge, &up, &image).is_empty(), "the upper side is near and agrees");
        let mut thicker = wedge.clone();
        thicker.positions.raw[4..].iter_mut().for_each(|p| p.z += 1.0);
        assert_eq!(flips_on_target(&one, &thicker, &up, &image), [FaceId(0)], "now it is far away");
    }

    /// Barycentric coordinates of the point of a face above (x, y).
    fn barycentric(mesh: &TriMesh, f: FaceId, x: f64, y: f64) -> [f64; 3] {
        let flat = mesh.triangle(f).map(|p| p.truncate());
        let p = glam::DVec2::new(x, y);
        let all = metric::signed_area(flat);
        let share = |i: usize| metric::signed_area([p, flat[(i + 1) % 3], flat[(i + 2) % 3]]) / all;
        std::array::from_fn(share)
    }

    /// A closed fan of six triangles around vertex 0 in the plane, normals up.
    fn fan() -> TriMesh {
        let rim = (0..6).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_3);
        let positions = [DVec3::ZERO].into_iter().chain(rim.map(|a| DVec3::new(a.cos(), a.sin(), 0.0))).collect();
        let faces: Vec<_> = (0..6).map(|i| [0, 1 + i, 1 + (i + 1) % 6].map(VertexId)).collect();
        TriMesh::new(positions, &faces).expect("a fan is a manifold")
    }

    fn identity(mesh: &TriMesh) -> IdVec<VertexId, Option<SurfacePoint>> {
        mesh.conn.vertices().map(|v| Some(SurfacePoint::Vertex(v))).collect()
    }

    fn flips(mesh: &TriMesh, points: &IdVec<VertexId, Option<SurfacePoint>>) -> Vec<FaceId> {
        let image = points.iter().map(|p| p.map_or(DVec3::ZERO, |p| p.position(mesh))).collect();
        flips_on_target(mesh, mesh, points, &image)
    }

    #[test]
    fn the_identity_has_no_flips() {
        let mesh = fan();
        assert!(flips(&mesh, &identity(&mesh)).is_empty());
        assert!(local_flips(&mesh.faces(), &mesh.positions).is_empty());
    }

    ///      2___1
    ///      / \ /        rim vertex 1 is mapped into the face (0 2 3): face (0 1 2) turns over there
    ///     3___0
    #[test]
    fn a_vertex_mapped_across_an_edge_turns_its_triangle_over() {
        let mesh = fan();
        let mut points = identity(&mesh);
        points[VertexId(1)] = Some(SurfacePoint::Face(FaceId(1), [0.2, 0.4, 0.4]));
        assert_eq!(flips(&mesh, &points), [FaceId(0)]);
    }

    #[test]
    fn a_triangle_mapped_onto_one_edge_is_collapsed() {
        let mesh = fan();
        let mut points = identity(&mesh);
        points[VertexId(1)] = Some(SurfacePoint::Edge(corner(FaceId(1), 0), 0.5));
        assert!(flips(&mesh, &points).contains(&FaceId(0)));
    }

    #[test]
    fn a_middle_vertex_pushed_over_the_rim_is_found_without_the_target() {
        let mesh = fan();
        let mut image = mesh.positions.clone();
        image[VertexId(0)] = DVec3::new(0.9, 0.5, 0.0);
        assert_eq!(local_flips(&mesh.faces(), &image), [FaceId(0)]);
    }
}
