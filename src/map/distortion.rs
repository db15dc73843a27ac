//! How far a map is from an isometry: the measures that reports, tables and tests use.
//!
//! A map is given as a compatible mesh: the source's triangles with image positions. For the affine map of a triangle
//! let G >= g be its singular values after the one scale that makes both total areas equal, A its area before and B
//! after. L2 stretch: Sander, Snyder, Gortler, Hoppe, "Texture Mapping Progressive Meshes" (2001).

use crate::mesh::{IdVec, VertexId, metric};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A triangle whose area is below this share of the mean is degenerate: its singular values are rounding noise.
pub const DEGENERATE_SHARE: f64 = 1e-12;

/// What the squared stretch of a collapsed triangle counts as, so that sums stay numbers and no file holds infinities.
const COLLAPSED: f64 = 1e300;

/// The measures of a map in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Root of the mean squared L2 stretch, weighted by image area; at least 1, and 1 only for an isometry up to scale.
    pub e_l2: f64,
    /// Mean over corners of |angle - angle'|, radians, weighted by area before.
    pub e_ang: f64,
    /// Mean of (G^2 + g^2 + 1/G^2 + 1/g^2) / 4, weighted by area before; 1 for an isometry up to scale.
    pub symmetric_dirichlet: f64,
    /// Triangles whose image is collapsed or turned over.
    pub flips: usize,
}

/// The measures of a compatible mesh both ways.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distortion {
    /// From the mesh to its compatible mesh.
    pub forward: Measures,
    /// From the compatible mesh to the mesh.
    pub backward: Measures,
    /// Triangles left out because they are degenerate before the map.
    pub degenerate_source: usize,
}

/// Measures the piecewise linear map that moves the corners of `faces` from `before` to `after`.
///
/// `flips` is left to the caller, who knows what the image's normals are to be compared with: [`super::flips`].
/// Without a single sound triangle every mean is zero.
pub fn distortion(
    faces: &[[VertexId; 3]],
    before: &IdVec<VertexId, DVec3>,
    after: &IdVec<VertexId, DVec3>,
    flips: usize,
) -> Distortion {
    let triangles = faces.iter().map(|t| (t.map(|v| before[v]), t.map(|v| after[v])));
    let total: f64 = triangles.clone().map(|(s, _)| metric::area(s)).sum();
    let smallest = DEGENERATE_SHARE * total / faces.len().max(1) as f64;
    let sound = triangles.filter(|&(s, _)| metric::area(s) > smallest);
    let (sound_before, sound_after) =
        sound.clone().fold((0.0, 0.0), |(before, after), (s, t)| (before + metric::area(s), after + metric::area(t)));
    let scale_sq = sound_after / sound_before;
    let mut sums = Sums::default();
    for (s, t) in sound {
        sums.add(s, t, scale_sq);
    }
    let degenerate_source = faces.len() - sums.triangles;
    Distortion { forward: sums.forward(flips), backward: sums.backward(flips), degenerate_source }
}

/// Area-weighted sums over triangles; `before` and `after` are weighted by the area there.
#[derive(Default)]
struct Sums {
    triangles: usize,
    before: f64,
    after: f64,
    stretch_after: f64,
    inverse_stretch_before: f64,
    symmetric_before: f64,
    symmetric_after: f64,
    angle_before: f64,
    angle_after: f64,
}

impl Sums {
    fn add(&mut self, source: [DVec3; 3], image: [DVec3; 3], scale_sq: f64) {
        let (before, after) = (metric::area(source), metric::area(image) / scale_sq);
        let (large, small) = metric::singular_values(source, image);
        let (large_sq, small_sq) = (large * large / scale_sq, small * small / scale_sq);
        let stretch = finite((large_sq + small_sq) / 2.0);
        let inverse = finite((1.0 / large_sq + 1.0 / small_sq) / 2.0);
        let symmetric = (stretch + inverse) / 2.0;
        let (angles, images) = (metric::angles(source), metric::angles(image));
        let angle = (0..3).map(|i| (angles[i] - images[i]).abs()).sum::<f64>() / 3.0;
        self.triangles += 1;
        self.before += before;
        self.after += after;
        self.stretch_after += stretch * after;
        self.inverse_stretch_before += inverse * before;
        self.symmetric_before += symmetric * before;
        self.symmetric_after += symmetric * after;
        self.angle_before += angle * before;
        self.angle_after += angle * after;
    }

    fn forward(&self, flips: usize) -> Measures {
        Measures {
            e_l2: mean(self.stretch_after, self.after).sqrt(),
            e_ang: mean(self.angle_before, self.before),
            symmetric_dirichlet: mean(self.symmetric_before, self.before),
            flips,
        }
    }

    fn backward(&self, flips: usize) -> Measures {
        Measures {
            e_l2: mean(self.inverse_stretch_before, self.before).sqrt(),
            e_ang: mean(self.angle_after, self.after),
            symmetric_dirichlet: mean(self.symmetric_after, self.after),
            flips,
        }
    }
}

fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { COLLAPSED }
}

fn mean(sum: f64, weight: f64) -> f64 {
    if weight > 0.0 { finite(sum / weight) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriMesh;
    use glam::DQuat;

    const N: usize = 21;

    /// The unit square as a grid of N x N vertices.
    fn square() -> TriMesh {
        let step = 1.0 / (N - 1) as f64;
        let at = |i: usize, j: usize| VertexId((j * N + i) as u32);
        let positions = (0..N * N).map(|k| DVec3::new((k % N) as f64 * step, (k / N) as f64 * step, 0.0)).collect();
        let faces: Vec<_> = (0..(N - 1) * (N - 1))
            .map(|k| (k % (N - 1), k / (N - 1)))
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        TriMesh::new(positions, &faces).expect("a grid is a manifold")
    }

    fn mapped(mesh: &TriMesh, map: impl Fn(DVec3) -> DVec3) -> Distortion {
        let image = mesh.positions.iter().map(|&p| map(p)).collect();
        distortion(&mesh.faces(), &mesh.positions, &image, 0)
    }

    fn close(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{value} instead of {expected}");
    }

    #[test]
    fn similarities_have_no_distortion() {
        let mesh = square();
        let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
        for d in [mapped(&mesh, |p| p), mapped(&mesh, |p| turn * p * 3.7 + DVec3::new(1.0, 2.0, 3.0))] {
            for m in [d.forward, d.backward] {
                close(m.e_l2, 1.0);
                close(m.symmetric_dirichlet, 1.0);
                close(m.e_ang, 0.0);
            }
        }
    }

    /// x' = x + k y keeps area and has G^2 + g^2 = 2 + k^2, everywhere and both ways.
    #[test]
    fn a_shear_stretches_alike_both_ways() {
        let k = 0.8;
        let d = mapped(&square(), |p| DVec3::new(p.x + k * p.y, p.y, p.z));
        for m in [d.forward, d.backward] {
            close(m.e_l2, (1.0 + k * k / 2.0).sqrt());
            close(m.symmetric_dirichlet, 1.0 + k * k / 2.0);
            assert!(m.e_ang > 0.1);
        }
    }

    /// Half of the square is kept, half is widened twice: singular values (1, 1) and (2, 1) before the global scale.
    #[test]
    fn a_two_part_stretch_weighs_by_the_right_area() {
        let d = mapped(&square(), |p| if p.x > 0.5 { DVec3::new(2.0 * p.x - 0.5, p.y, 0.0) } else { p });
        let area: f64 = 1.5;
        close(d.forward.e_l2, ((0.5 * 1.0 + 1.0 * 2.5) / area / area).sqrt());
        close(d.backward.e_l2, ((0.5 * 1.0 + 0.5 * 0.625) * area).sqrt());
        close(d.forward.symmetric_dirichlet, 0.5 * (1.0 / area + area) / 2.0 + 0.5 * (2.5 / area + 0.625 * area) / 2.0);
        close(
            d.backward.symmetric_dirichlet,
            (0.5 * (1.0 / area + area) / 2.0 + 1.0 * (2.5 / area + 0.625 * area) / 2.0) / area,
        );
    }

    #[test]
    fn degenerate_triangles_of_the_source_are_left_out_and_counted() {
        let mut mesh = square();
        mesh.positions[VertexId(0)] = mesh.positions[VertexId(1)];
        let d = mapped(&mesh, |p| p * 2.0);
        assert_eq!(d.degenerate_source, 1);
        close(d.forward.e_l2, 1.0);
    }

    #[test]
    fn collapsed_images_give_large_numbers_and_no_infinities() {
        let d = mapped(&square(), |p| DVec3::new(p.x, 0.0, 0.0));
        for x in [d.backward.e_l2, d.forward.symmetric_dirichlet, d.forward.e_l2, d.backward.symmetric_dirichlet] {
            assert!(x.is_finite(), "{x}");
        }
        assert!(d.backward.e_l2 > 1e100);
    }
}
