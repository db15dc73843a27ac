//! The kernel of a polygon in the plane: the points that see all of it.

use glam::DVec2;

/// A convex region as a polygon, counter-clockwise.
#[derive(Clone, Debug)]
pub struct Region {
    corners: Vec<DVec2>,
}

/// The points left of every edge of a counter-clockwise polygon, as exactly as floating point gives them.
pub fn kernel(polygon: &[DVec2]) -> Region {
    let low = polygon.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = polygon.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let mut corners = vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    for (i, &a) in polygon.iter().enumerate() {
        corners = clip(&corners, a, polygon[(i + 1) % polygon.len()]);
    }
    Region { corners }
}

/// The part of a convex polygon left of the line from `a` to `b`.
fn clip(corners: &[DVec2], a: DVec2, b: DVec2) -> Vec<DVec2> {
    let height = |p: DVec2| (b - a).perp_dot(p - a);
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (i, &p) in corners.iter().enumerate() {
        let q = corners[(i + 1) % corners.len()];
        let (hp, hq) = (height(p), height(q));
        if hp >= 0.0 {
            kept.push(p);
        }
        if (hp > 0.0 && hq < 0.0) || (hp < 0.0 && hq > 0.0) {
            kept.push(p.lerp(q, hp / (hp - hq)));
        }
    }
    kept
}

impl Region {
    /// The mean of the corners; NaN for an empty region.
    pub fn mean(&self) -> DVec2 {
        self.corners.iter().sum::<DVec2>() / self.corners.len() as f64
    }

    /// The centroid; the mean of the corners where there is no area to speak of.
    pub fn centre(&self) -> DVec2 {
        let Some(&o) = self.corners.first() else { return DVec2::NAN };
        let mut sum = (DVec2::ZERO, 0.0);
        for pair in self.corners[1..].windows(2) {
            let (p, q) = (pair[0] - o, pair[1] - o);
            let area = p.perp_dot(q);
            sum = (sum.0 + (p + q) * area, sum.1 + area);
        }
        if sum.1.is_normal() { o + sum.0 / (3.0 * sum.1) } else { self.mean() }
    }
}
