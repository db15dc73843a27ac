//! The colour of the surface: its paint under a light at the viewer.

use super::camera::{Camera, Projected};
use super::scene::{Color, Paint, Scene};
use crate::mesh::{Id, VertexId, metric};
use glam::{DVec2, DVec3};

/// Light from everywhere; less lets the outline drown, more flattens shapes.
const AMBIENT: f64 = 0.3;
/// The insides of surfaces show this share of the light.
const INSIDE: f64 = 0.45;
/// A picture without colour where a surface has no texture coordinates.
const MISSING: Color = [1.0; 3];

/// Everything that the colour of a sample follows from.
pub(super) struct Shader<'a> {
    scene: &'a Scene<'a>,
    camera: &'a Camera,
    corners: &'a [Projected],
    /// Normals at vertices, of any length.
    normals: Vec<DVec3>,
}

impl<'a> Shader<'a> {
    /// Prepares the light.
    pub fn new(scene: &'a Scene, camera: &'a Camera, corners: &'a [Projected]) -> Self {
        let mut normals = vec![DVec3::ZERO; scene.positions.len()];
        for t in scene.triangles {
            let normal = face_normal(t.map(|v| scene.positions[v.index()]));
            t.iter().for_each(|v| normals[v.index()] += normal);
        }
        Shader { scene, camera, corners, normals }
    }

    /// The colour of a triangle at a point of the picture.
    pub fn color(&self, triangle: u32, p: DVec2) -> Color {
        let t = self.scene.triangles[triangle as usize];
        let seen = t.map(|v| self.corners[v.index()]);
        let b = in_space(&seen, p);
        let light = self.light(t, b) as f32;
        self.paint(triangle as usize, t, b, &seen).map(|c| c * light)
    }

    fn light(&self, t: [VertexId; 3], b: [f64; 3]) -> f64 {
        let points = t.map(|v| self.scene.positions[v.index()]);
        let at = weighted(points, b);
        let towards = self.camera.towards(at);
        let flat = face_normal(points);
        let normal = if self.scene.smooth { weighted(t.map(|v| self.normals[v.index()]), b) } else { flat };
        let outside = if flat.dot(towards) >= 0.0 { 1.0 } else { INSIDE };
        let facing = normal.normalize_or_zero().dot(towards).abs();
        outside * (AMBIENT + (1.0 - AMBIENT) * facing)
    }

    fn paint(&self, triangle: usize, t: [VertexId; 3], b: [f64; 3], seen: &[Projected; 3]) -> Color {
        match self.scene.paint {
            Paint::Plain(color) => color,
            Paint::Faces(colors) => colors[triangle],
            Paint::Vertices(colors) => {
                let [p, q, r] = t.map(|v| colors[v.index()]);
                std::array::from_fn(|k| [p, q, r].iter().zip(b).map(|(c, w)| c[k] * w as f32).sum())
            }
            Paint::Texture(uv, image) => {
                let corners = uv[triangle];
                let at = weighted(corners, b);
                if !at.is_finite() {
                    return MISSING;
                }
                let in_picture = metric::signed_area(seen.map(|c| c.at)).abs();
                let in_image = metric::signed_area(corners.map(|c| c * image.size())).abs();
                let [r, g, b, _] = image.sample(at, (in_image / in_picture).sqrt());
                [r, g, b]
            }
            Paint::Checker(uv, squares, colors) => {
                let at = weighted(uv[triangle], b) * squares;
                let is_second = (at.x.floor() + at.y.floor()).rem_euclid(2.0) != 0.0;
                if at.is_finite() { colors[usize::from(is_second)] } else { MISSING }
            }
        }
    }
}

/// The weights in space of a point of the picture.
fn in_space(corners: &[Projected; 3], p: DVec2) -> [f64; 3] {
    let Some(b) = super::raster::weights(corners, p) else { return [1.0 / 3.0; 3] };
    let w: [f64; 3] = std::array::from_fn(|k| b[k] * corners[k].weight);
    let sum: f64 = w.iter().sum();
    w.map(|w| w / sum)
}

fn weighted<T: std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>>([p, q, r]: [T; 3], b: [f64; 3]) -> T {
    p * b[0] + q * b[1] + r * b[2]
}

fn face_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}
