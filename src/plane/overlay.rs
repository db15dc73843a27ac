//! Overlay of two meshes embedded in one domain: the parts that a triangle of one shares with triangles of the other.

use super::domain::{Domain, OUTSIDE};
use super::walk::walk;
use glam::DVec2;

/// Corners of the common part of two triangles: at most six, and perhaps more where rounding bends a side.
const MOST_CORNERS: usize = 8;

/// What a triangle of the moving mesh shares with one of the fixed mesh.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// The fixed triangle.
    pub fixed: u32,
    /// Area in the plane.
    pub area: f64,
    /// Derivative of the area by the three corners of the moving triangle; zero unless asked for.
    pub slope: [DVec2; 3],
}

/// Finds the parts over a fixed mesh, triangle after triangle.
pub struct Overlay<'a> {
    fixed: &'a Domain,
    round: u32,
    visited: Vec<u32>,
    waiting: Vec<u32>,
}

impl<'a> Overlay<'a> {
    /// Prepares the overlay over `fixed`.
    pub fn new(fixed: &'a Domain) -> Self {
        Overlay { fixed, round: 0, visited: vec![0; fixed.triangles.len()], waiting: Vec::new() }
    }

    /// The fixed triangle at the middle of `corners`, walking from triangle `near`; the last one met on the way if the
    /// middle lies outside the domain.
    pub fn seat(&self, corners: &[DVec2; 3], near: u32) -> u32 {
        walk(self.fixed, near, (corners[0] + corners[1] + corners[2]) / 3.0).triangle
    }

    /// Visits the parts of the counter-clockwise triangle `corners`, spreading from the fixed triangle `start` in it.
    pub fn parts(&mut self, corners: &[DVec2; 3], start: u32, slopes: bool, mut visit: impl FnMut(Part)) {
        self.round += 1;
        self.visited[start as usize] = self.round;
        self.waiting.push(start);
        while let Some(g) = self.waiting.pop() {
            let polygon = Polygon::common(corners, &self.fixed.triangle(g as usize));
            let area = polygon.area();
            if area <= 0.0 {
                continue;
            }
            let slope = if slopes { polygon.slope(corners) } else { [DVec2::ZERO; 3] };
            visit(Part { fixed: g, area, slope });
            for side in 0..3 {
                let behind = self.fixed.neighbours[g as usize][side];
                let crosses = behind != OUTSIDE && self.visited[behind as usize] != self.round;
                if crosses && polygon.sides().any(|s| s == FIXED_SIDE + side as u8) {
                    self.visited[behind as usize] = self.round;
                    self.waiting.push(behind);
                }
            }
        }
    }
}

/// Sides of a part below this number lie on the moving triangle, the others on the fixed one.
const FIXED_SIDE: u8 = 3;

/// A convex polygon whose sides remember which triangle's side they lie on.
struct Polygon {
    len: usize,
    corner: [DVec2; MOST_CORNERS],
    /// Side from a corner to the next one.
    side: [u8; MOST_CORNERS],
}

impl Polygon {
    /// The common part of two counter-clockwise triangles.
    fn common(moving: &[DVec2; 3], fixed: &[DVec2; 3]) -> Self {
        let mut polygon = Polygon { len: 0, corner: [DVec2::ZERO; MOST_CORNERS], side: [0; MOST_CORNERS] };
        (0..3).for_each(|i| polygon.push(fixed[i], FIXED_SIDE + i as u8));
        for i in 0..3 {
            polygon.clip(moving[i], moving[(i + 1) % 3], i as u8);
        }
        polygon
    }

    fn push(&mut self, corner: DVec2, side: u8) {
        if self.len < MOST_CORNERS {
            (self.corner[self.len], self.side[self.len]) = (corner, side);
            self.len += 1;
        }
    }

    /// Keeps what lies left of the line from `a` to `b` (Sutherland and Hodgman); the new side gets the given number.
    fn clip(&mut self, a: DVec2, b: DVec2, number: u8) {
        let heights: [f64; MOST_CORNERS] = std::array::from_fn(|k| (b - a).perp_dot(self.corner[k] - a));
        let heights = &heights[..self.len];
        if heights.iter().all(|&h| h >= 0.0) {
            return;
        }
        let (len, corner, side) = (self.len, self.corner, self.side);
        self.len = 0;
        for k in 0..len {
            let next = if k + 1 < len { k + 1 } else { 0 };
            let (hp, hq) = (heights[k], heights[next]);
            if hp >= 0.0 {
                self.push(corner[k], side[k]);
            }
            if (hp >= 0.0) != (hq >= 0.0) {
                let meeting = corner[k] + (corner[next] - corner[k]) * (hp / (hp - hq));
                self.push(meeting, if hp >= 0.0 { number } else { side[k] });
            }
        }
    }

    fn area(&self) -> f64 {
        let first = self.corner[0];
        let fan =
            (1..self.len.saturating_sub(1)).map(|k| (self.corner[k] - first).perp_dot(self.corner[k + 1] - first));
        0.5 * fan.sum::<f64>()
    }

    fn sides(&self) -> impl Iterator<Item = u8> {
        self.side[..self.len].iter().copied()
    }

    /// Derivative of the area by the corners of the moving triangle: only the sides that lie on it sweep over area.
    fn slope(&self, moving: &[DVec2; 3]) -> [DVec2; 3] {
        let mut slope = [DVec2::ZERO; 3];
        for k in (0..self.len).filter(|&k| self.side[k] < FIXED_SIDE) {
            let i = self.side[k] as usize;
            let j = (i + 1) % 3;
            let along = moving[j] - moving[i];
            let share = |p: DVec2| (p - moving[i]).dot(along) / along.length_squared();
            let (from, to) = (share(self.corner[k]), share(self.corner[(k + 1) % self.len]));
            let outward = -along.perp();
            let far = 0.5 * (to * to - from * from);
            slope[i] += outward * (to - from - far);
            slope[j] += outward * far;
        }
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2 as V;

    /// A unit square of two triangles.
    fn square() -> Domain {
        Domain {
            positions: vec![V::ZERO, V::X, V::ONE, V::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            neighbours: vec![[OUTSIDE, OUTSIDE, 1], [0, OUTSIDE, OUTSIDE]],
            ..Domain::default()
        }
    }

    fn parts(corners: &[V; 3]) -> Vec<Part> {
        let domain = square();
        let mut parts = Vec::new();
        let mut overlay = Overlay::new(&domain);
        overlay.parts(corners, overlay.seat(corners, 0), true, |p| parts.push(p));
        parts.sort_by_key(|p| p.fixed);
        parts
    }

    const ACROSS: [V; 3] = [V::new(0.3, 0.1), V::new(0.8, 0.4), V::new(0.2, 0.9)];

    #[test]
    fn parts_fill_the_triangle() {
        let area = 0.5 * (ACROSS[1] - ACROSS[0]).perp_dot(ACROSS[2] - ACROSS[0]);
        let found = parts(&ACROSS);
        assert_eq!(found.iter().map(|p| p.fixed).collect::<Vec<_>>(), [0, 1]);
        assert!((found.iter().map(|p| p.area).sum::<f64>() - area).abs() < 1e-15);
    }

    #[test]
    fn what_sticks_out_of_the_domain_is_left_out() {
        let found = parts(&[V::new(0.5, 0.25), V::new(1.5, 0.25), V::new(0.5, 1.25)]);
        let area: f64 = found.iter().map(|p| p.area).sum();
        assert!((area - 0.34375).abs() < 1e-12, "{area}");
    }

    #[test]
    fn slopes_are_the_derivatives_of_the_areas() {
        let step = 1e-6;
        for i in 0..3 {
            for axis in [V::X, V::Y] {
                let moved = |by: f64| {
                    let mut corners = ACROSS;
                    corners[i] += axis * by;
                    parts(&corners)
                };
                let (up, down) = (moved(step), moved(-step));
                for (k, part) in parts(&ACROSS).iter().enumerate() {
                    let measured = (up[k].area - down[k].area) / (2.0 * step);
                    assert!((measured - part.slope[i].dot(axis)).abs() < 1e-8, "corner {i}, part {k}");
                }
            }
        }
    }
}
