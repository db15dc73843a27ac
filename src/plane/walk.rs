//! Point location in a domain by walking from triangle to triangle.

use super::domain::{Domain, OUTSIDE};
use glam::{DVec2, DVec3};

/// A walk longer than this goes round in circles on rounding errors; it then stops where it is.
const MAX_STEPS: usize = 4096;

/// A place in a domain: a triangle and barycentric coordinates, none negative, sum one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spot {
    /// The triangle.
    pub triangle: u32,
    /// The coordinates in corner order.
    pub weights: [f64; 3],
}

impl Spot {
    /// The point in space.
    pub fn point(&self, domain: &Domain) -> DVec3 {
        let [a, b, c] = domain.triangles[self.triangle as usize].map(|v| domain.points[v as usize]);
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
    }

    /// Derivative of the point in space by the two plane coordinates.
    pub fn derivative(&self, domain: &Domain) -> [DVec3; 2] {
        let [p, q, r] = domain.triangle(self.triangle as usize);
        let [a, b, c] = domain.triangles[self.triangle as usize].map(|v| domain.points[v as usize]);
        let twice = (q - p).perp_dot(r - p);
        [
            (a * (q.y - r.y) + b * (r.y - p.y) + c * (p.y - q.y)) / twice,
            (a * (r.x - q.x) + b * (p.x - r.x) + c * (q.x - p.x)) / twice,
        ]
    }
}

/// A point may lie outside a triangle by this much, in barycentric coordinates, and still count as in it: points on the
/// border of a domain miss it by rounding.
const TOLERANCE: f64 = 1e-9;

/// The spot of `p`, walking from triangle `start`; a point outside is moved to the triangle nearest to holding it.
///
/// A domain need not be convex, so a walk can end in a dead end; then all triangles are tried.
pub fn walk(domain: &Domain, start: u32, p: DVec2) -> Spot {
    let mut t = start;
    let mut came_from = OUTSIDE;
    for _ in 0..MAX_STEPS {
        let areas = areas(domain, t, p);
        let neighbours = domain.neighbours[t as usize];
        let behind = |i: &usize| areas[*i] < 0.0 && neighbours[*i] != OUTSIDE && neighbours[*i] != came_from;
        let Some(side) = (0..3).filter(behind).min_by(|&i, &j| areas[i].total_cmp(&areas[j])) else {
            if depth(areas) >= -TOLERANCE {
                return Spot { triangle: t, weights: weights(areas) };
            }
            break;
        };
        came_from = t;
        t = neighbours[side];
    }
    let depth_of = |t: &u32| depth(areas(domain, *t, p));
    let all = 0..domain.triangles.len() as u32;
    let t = all.max_by(|s, t| depth_of(s).total_cmp(&depth_of(t))).unwrap_or(start);
    Spot { triangle: t, weights: weights(areas(domain, t, p)) }
}

/// Twice the areas over the three sides of a triangle.
fn areas(domain: &Domain, t: u32, p: DVec2) -> [f64; 3] {
    let corners = domain.triangle(t as usize);
    std::array::from_fn(|i| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        (b - a).perp_dot(p - a)
    })
}

/// The least barycentric coordinate.
fn depth(areas: [f64; 3]) -> f64 {
    let least = areas.into_iter().fold(f64::INFINITY, f64::min);
    let depth = least / areas.iter().sum::<f64>();
    if depth.is_nan() { f64::NEG_INFINITY } else { depth }
}

/// Barycentric coordinates from the areas over the three sides, clamped to the triangle.
fn weights(areas: [f64; 3]) -> [f64; 3] {
    let inside = [areas[1], areas[2], areas[0]].map(|x| x.max(0.0));
    let sum: f64 = inside.iter().sum();
    if sum > 0.0 { inside.map(|x| x / sum) } else { [1.0 / 3.0; 3] }
}
