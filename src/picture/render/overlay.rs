//! Lines and dots over a surface, hidden where it lies before them.

use super::camera::{Camera, Projected};
use super::raster::Hit;
use super::scene::{Color, Scene};
use glam::DVec2;

/// Width of a dot's rim, pixels.
const RIM: f64 = 1.0;
const RIM_COLOR: Color = [1.0; 3];

/// A straight piece of a line, or a disc where both ends are one point.
struct Stroke {
    ends: [Projected; 2],
    /// In samples.
    radius: f64,
    color: Color,
}

/// All marks of a scene in the order in which they are drawn.
pub(super) struct Overlay {
    strokes: Vec<Stroke>,
    lift: f64,
}

impl Overlay {
    /// Marks in a picture of `size` samples, `samples` along a pixel's side.
    pub fn new(scene: &Scene, camera: &Camera, size: [usize; 2], samples: f64) -> Self {
        let mut strokes = Vec::new();
        for line in &scene.lines {
            let points = camera.project(&line.points, size);
            let radius = 0.5 * line.width * samples;
            strokes.extend(points.windows(2).map(|w| Stroke { ends: [w[0], w[1]], radius, color: line.color }));
        }
        for dot in &scene.dots {
            let ends = camera.project(&[dot.at; 2], size);
            for (radius, color) in [(dot.radius + RIM, RIM_COLOR), (dot.radius, dot.color)] {
                strokes.push(Stroke { ends: [ends[0], ends[1]], radius: radius * samples, color });
            }
        }
        Overlay { strokes, lift: camera.lift() }
    }

    /// Draws over the samples of a band that starts at `first_row`.
    pub fn draw(&self, first_row: usize, width: usize, hits: &[Hit], samples: &mut [Color]) {
        let rows = samples.len() / width;
        let end = |x: f64, most: usize| ((x + 0.5).floor().max(0.0) as usize).min(most);
        for stroke in &self.strokes {
            let [a, b] = stroke.ends.map(|e| e.at);
            let (low, high) = (a.min(b) - stroke.radius, a.max(b) + stroke.radius);
            let top = first_row as f64;
            for y in end(low.y - top, rows)..end(high.y - top, rows) {
                for x in end(low.x, width)..end(high.x, width) {
                    let p = DVec2::new(x as f64 + 0.5, (first_row + y) as f64 + 0.5);
                    let i = y * width + x;
                    if stroke.nearness(p).is_some_and(|n| n + self.lift >= hits[i].nearness) {
                        samples[i] = stroke.color;
                    }
                }
            }
        }
    }
}

impl Stroke {
    /// How near the stroke is at a point of the picture; none beside it.
    fn nearness(&self, p: DVec2) -> Option<f64> {
        let [a, b] = self.ends;
        let way = b.at - a.at;
        let length_sq = way.length_squared();
        let t = if length_sq > 0.0 { ((p - a.at).dot(way) / length_sq).clamp(0.0, 1.0) } else { 0.0 };
        let is_on = p.distance_squared(a.at + way * t) <= self.radius * self.radius;
        is_on.then_some(a.nearness + (b.nearness - a.nearness) * t)
    }
}
