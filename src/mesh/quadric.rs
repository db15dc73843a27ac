//! Quadrics: what a point is off the planes of many triangles, in ten numbers (M. Garland, P. Heckbert, "Surface
//! simplification using quadric error metrics", 1997).

use glam::{DMat3, DVec3};

/// Squared distance from the planes of triangles, weighed with their areas: x A x + 2 b x + c.
#[derive(Clone, Copy)]
pub(super) struct Quadric {
    a: DMat3,
    b: DVec3,
    c: f64,
}

impl Quadric {
    /// Of no triangle.
    pub const NONE: Self = Quadric { a: DMat3::ZERO, b: DVec3::ZERO, c: 0.0 };

    /// Of one triangle; that of one without area counts for nothing.
    pub fn of_triangle([p, q, r]: [DVec3; 3]) -> Self {
        let cross = (q - p).cross(r - p);
        let Some(n) = cross.try_normalize() else { return Quadric::NONE };
        let (area, d) = (0.5 * cross.length(), -n.dot(p));
        let a = DMat3::from_cols(n * n.x, n * n.y, n * n.z) * area;
        Quadric { a, b: n * (d * area), c: d * d * area }
    }

    /// Takes in the triangles of another.
    pub fn add(&mut self, other: &Quadric) {
        self.a += other.a;
        self.b += other.b;
        self.c += other.c;
    }

    /// The sum for a point, not negative.
    pub fn at(&self, x: DVec3) -> f64 {
        (x.dot(self.a * x) + 2.0 * self.b.dot(x) + self.c).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_as_far_off_as_from_the_planes() {
        let [o, x, y, z] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let mut quadric = Quadric::of_triangle([o, x, y]);
        quadric.add(&Quadric::of_triangle([o, y * 2.0, z]));
        quadric.add(&Quadric::of_triangle([x, x * 2.0, x * 3.0]));
        let p = DVec3::new(3.0, 5.0, -2.0);
        assert!((quadric.at(p) - (0.5 * 4.0 + 9.0)).abs() < 1e-12);
        assert!(quadric.at(y * 7.0) < 1e-12);
    }
}
