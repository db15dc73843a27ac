//! L2 stretch of planar embeddings (Sander et al. 2001), in double precision.

use super::patch_disc::PatchDisc;
use crate::mesh::metric;
use glam::{DVec2, DVec3};

/// Squared L2 stretch (G^2 + g^2)/2 of the map from the plane to the surface, for one triangle.
///
/// Infinite where the planar triangle is not positively oriented.
pub fn l2_sq(plane: [DVec2; 3], surface: [DVec3; 3]) -> f64 {
    let area = metric::signed_area(plane);
    if !area.is_normal() || area < 0.0 {
        return f64::INFINITY;
    }
    let [p, q, r] = plane;
    let [a, b, c] = surface;
    let du = (a * (q.y - r.y) + b * (r.y - p.y) + c * (p.y - q.y)) / (2.0 * area);
    let dv = (a * (r.x - q.x) + b * (p.x - r.x) + c * (q.x - p.x)) / (2.0 * area);
    (du.length_squared() + dv.length_squared()) * 0.5
}

/// Squared stretch and surface area of every triangle of a patch embedded in `frame` (see [`PatchDisc`]).
pub fn patch_stretch(disc: &PatchDisc, points: &[DVec3], frame: &Frame) -> Vec<(f64, f64)> {
    let one = |t: &[u32; 3]| {
        let plane = t.map(|v| frame.place(disc.positions[v as usize]));
        let surface = t.map(|v| points[v as usize]);
        (l2_sq(plane, surface), metric::area(surface))
    };
    disc.triangles.iter().map(one).collect()
}

/// E_L2 of a patch: root of the area-weighted mean of the squared stretch, scaled to be 1 for an isometry up to scale.
pub fn e_l2(stretch: &[(f64, f64)], plane_area: f64) -> f64 {
    let (sum, area) = stretch.iter().fold((0.0, 0.0), |(s, a), &(l, area)| {
        // A triangle without area has no say; it also may have an unbounded stretch.
        if area > 0.0 { (s + l * area, a + area) } else { (s, a) }
    });
    (sum / area * plane_area / area).sqrt()
}

/// The triangle in the plane that stands for a base triangle when stretch is measured.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Image of the reference corner (1, 0); the corner (0, 0) stays.
    pub first: DVec2,
    /// Image of the reference corner (0, 1).
    pub second: DVec2,
}

impl Frame {
    /// A triangle with the given side lengths (side 0 from corner 0 to corner 1, and so on).
    ///
    /// Lengths that violate the triangle inequality, or nearly so, are evened out until they satisfy it well.
    pub fn with_sides(sides: [f64; 3]) -> Self {
        let mean = (sides[0] + sides[1] + sides[2]) / 3.0;
        let slack = |s: &[f64; 3]| (0..3).all(|i| 2.0 * s[i] < 0.95 * (s[0] + s[1] + s[2]) && s[i] > 0.2 * mean);
        let mut even = sides;
        for _ in 0..64 {
            if slack(&even) {
                break;
            }
            even = even.map(|s| s + 0.1 * (mean - s));
        }
        let [c, a, b] = even;
        let x = (c * c + b * b - a * a) / (2.0 * c);
        Frame { first: DVec2::new(c, 0.0), second: DVec2::new(x, (b * b - x * x).sqrt()) }
    }

    /// From reference coordinates into the frame.
    pub fn place(&self, p: DVec2) -> DVec2 {
        self.first * p.x + self.second * p.y
    }

    /// From the frame back to reference coordinates.
    pub fn reference(&self, q: DVec2) -> DVec2 {
        let det = self.first.perp_dot(self.second);
        DVec2::new(q.perp_dot(self.second) / det, self.first.perp_dot(q) / det)
    }

    fn corner(&self, k: usize) -> DVec2 {
        [DVec2::ZERO, self.first, self.second][k % 3]
    }

    /// Length of side `k`.
    pub fn length(&self, k: usize) -> f64 {
        self.corner(k).distance(self.corner(k + 1))
    }

    /// Angle at corner `k`, in radians.
    pub fn angle(&self, k: usize) -> f64 {
        (self.corner(k + 1) - self.corner(k)).angle_to(self.corner(k + 2) - self.corner(k))
    }

    /// Where the corner opposite to `side` lies when that side is laid from (0, 0) to (1, 0).
    pub fn apex_over(&self, side: usize) -> DVec2 {
        let [a, b, c] = [0, 1, 2].map(|k| self.corner(side + k));
        let along = (b - a) / (b - a).length_squared();
        DVec2::new((c - a).dot(along), along.perp_dot(c - a))
    }

    /// Area of the frame's triangle.
    pub fn area(&self) -> f64 {
        self.first.perp_dot(self.second) * 0.5
    }
}
