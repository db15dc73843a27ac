//! Normals of a normal map, from the tangent frames of one mesh to those of the other.

use super::attributes::corner_tangents;
use super::uv::UvTriangles;
use crate::map::transport::Arrival;
use crate::mesh::io::MeshFile;
use glam::{DMat2, DVec2, DVec3, Vec3};

/// The tangent frames of both meshes, the source first, at the corners of their triangles.
pub struct Frames {
    sides: [Side; 2],
}

struct Side {
    /// Tangent and handedness.
    tangents: Vec<(DVec3, f64)>,
    /// Corners in space.
    points: Vec<[DVec3; 3]>,
}

impl Frames {
    /// The frames of the source and the target.
    pub fn new(meshes: [&MeshFile; 2], uv: [&UvTriangles; 2]) -> Frames {
        let side = |k: usize| Side {
            tangents: corner_tangents(meshes[k], &uv[k].corners),
            points: meshes[k].triangles().iter().map(|t| t.map(|v| meshes[k].positions[v.0 as usize])).collect(),
        };
        Frames { sides: [side(0), side(1)] }
    }

    /// A normal of the source, as colour, in the frame of the target: it leans the same way on the surface, as the map turns
    /// it. `triangle` and `weights` are the point on the target.
    pub fn turn(&self, triangle: u32, weights: [f64; 3], arrival: &Arrival, colour: [f32; 4]) -> [f32; 4] {
        let [r, g, b, alpha] = colour;
        let normal = Vec3::new(r, g, b) * 2.0 - 1.0;
        let [source, target] = &self.sides;
        let (there, here) = (source.axes(arrival.face, arrival.b), target.axes(triangle, weights));
        // From the target's axes to weights, through the map, and to the source's axes.
        let turn = nearest_orthogonal(there * arrival.derivative * here.inverse());
        let lean = turn.transpose() * DVec2::new(normal.x.into(), normal.y.into());
        let turned = Vec3::new(lean.x as f32, lean.y as f32, normal.z);
        let colour = turned.normalize_or(Vec3::Z) * 0.5 + 0.5;
        [colour.x, colour.y, colour.z, alpha]
    }
}

impl Side {
    /// The edges of a triangle at its first corner along the tangent and the bitangent at a point: columns by weight.
    fn axes(&self, triangle: u32, weights: [f64; 3]) -> DMat2 {
        let first = 3 * triangle as usize;
        let [p, q, r] = self.points[triangle as usize];
        let normal = (q - p).cross(r - p).normalize_or_zero();
        let hand = self.tangents[first].1;
        let mean: DVec3 = (0..3).map(|k| self.tangents[first + k].0 * weights[k]).sum();
        let tangent = (mean - normal * mean.dot(normal)).normalize_or(normal.any_orthonormal_vector());
        let bitangent = normal.cross(tangent) * hand;
        let along = |e: DVec3| DVec2::new(e.dot(tangent), e.dot(bitangent));
        DMat2::from_cols(along(q - p), along(r - p))
    }
}

/// The orthogonal matrix nearest to another: its polar factor; the identity where there is none.
fn nearest_orthogonal(m: DMat2) -> DMat2 {
    // Of a matrix with positive determinant it is the rotation by the angle of (a + d, c - b); of others a reflection.
    let mirror = if m.determinant() < 0.0 { DMat2::from_diagonal(DVec2::new(1.0, -1.0)) } else { DMat2::IDENTITY };
    let m = m * mirror;
    let direction = DVec2::new(m.x_axis.x + m.y_axis.y, m.x_axis.y - m.y_axis.x).normalize_or(DVec2::X);
    if !direction.is_finite() {
        return DMat2::IDENTITY;
    }
    DMat2::from_cols(direction, direction.perp()) * mirror
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polar_factor_is_orthogonal_and_leaves_a_symmetric_rest() {
        for m in [[2.0, 1.0, -0.5, 3.0], [1.0, 2.0, 3.0, -1.0], [-1.0, 0.2, 0.1, -4.0]] {
            let m = DMat2::from_cols_array(&m);
            let q = nearest_orthogonal(m);
            assert!((q.transpose() * q).abs_diff_eq(DMat2::IDENTITY, 1e-12));
            let rest = q.transpose() * m;
            assert!((rest.x_axis.y - rest.y_axis.x).abs() < 1e-12 && rest.determinant() > 0.0 && rest.x_axis.x > 0.0);
        }
        assert_eq!(nearest_orthogonal(DMat2::NAN), DMat2::IDENTITY);
    }
}
