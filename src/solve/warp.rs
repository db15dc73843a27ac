//! A smooth warp of space that takes given points to given points.
//!
//! An affine map, fitted and held near a uniform scaling as far as the points leave it open, plus a combination of the
//! distances to the points that takes up what is left (J. Duchon's biharmonic splines; M. Buhmann, "Radial basis
//! functions", 2003, chapter 2: with a free constant the system is solvable for any distinct points).

use faer::linalg::solvers::Solve;
use glam::{DMat3, DVec3};

/// Weight of the uniform scaling against the points, relative to the source's area: what they say, they say far louder.
const STIFFNESS: f64 = 0.01;
/// The warp may miss points by about this share of their mean distance, so that two near ones do not tear it.
const SMOOTHING: f64 = 1e-3;

/// The warp; see the module documentation.
pub struct Warp {
    linear: DMat3,
    centres: [DVec3; 2],
    /// The points and the weights of the distances from them.
    bumps: Vec<(DVec3, DVec3)>,
    constant: DVec3,
}

impl Warp {
    /// Fits a warp from `from` to `to`, of equal number, not none; `areas` are those of the surfaces they lie on.
    pub fn fit(from: &[DVec3], to: &[DVec3], areas: [f64; 2]) -> Self {
        let centres = [from, to].map(|points| points.iter().sum::<DVec3>() / points.len() as f64);
        let linear = fit_linear(from, to, centres, areas);
        let mut warp = Warp { linear, centres, bumps: Vec::new(), constant: DVec3::ZERO };
        let rest: Vec<DVec3> = from.iter().zip(to).map(|(&x, &y)| y - warp.affine(x)).collect();
        warp.add_bumps(from, &rest);
        warp
    }

    /// Where the warp takes a point.
    pub fn apply(&self, x: DVec3) -> DVec3 {
        let bumps: DVec3 = self.bumps.iter().map(|&(p, weight)| weight * -x.distance(p)).sum();
        self.affine(x) + self.constant + bumps
    }

    /// The direction that the affine part turns a surface normal to, of unit length.
    pub fn turn(&self, normal: DVec3) -> DVec3 {
        (self.linear.inverse().transpose() * normal).normalize_or_zero()
    }

    fn affine(&self, x: DVec3) -> DVec3 {
        self.centres[1] + self.linear * (x - self.centres[0])
    }

    fn add_bumps(&mut self, points: &[DVec3], rest: &[DVec3]) {
        let n = points.len();
        let sum: f64 = points.iter().flat_map(|p| points.iter().map(move |q| p.distance(*q))).sum();
        let mean = sum / (n * n) as f64;
        let entry = |i: usize, j: usize| match (i < n, j < n) {
            (true, true) if i == j => SMOOTHING * mean,
            (true, true) => -points[i].distance(points[j]),
            (false, false) => 0.0,
            _ => 1.0,
        };
        let matrix = faer::Mat::from_fn(n + 1, n + 1, entry);
        let mut solution = faer::Mat::from_fn(n + 1, 3, |i, k| if i < n { rest[i][k] } else { 0.0 });
        matrix.partial_piv_lu().solve_in_place(&mut solution);
        let row = |i: usize| DVec3::new(solution[(i, 0)], solution[(i, 1)], solution[(i, 2)]);
        if (0..=n).all(|i| row(i).is_finite()) {
            self.bumps = points.iter().enumerate().map(|(i, &p)| (p, row(i))).collect();
            self.constant = row(n);
        }
    }
}

/// The linear map that takes the points nearest to their images, held near a uniform scaling.
fn fit_linear(from: &[DVec3], to: &[DVec3], centres: [DVec3; 2], areas: [f64; 2]) -> DMat3 {
    let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    let hold = STIFFNESS * areas[0];
    let mut cross = DMat3::from_diagonal(DVec3::splat(hold * (areas[1] / areas[0]).sqrt()));
    let mut square = DMat3::from_diagonal(DVec3::splat(hold));
    for (&x, &y) in from.iter().zip(to) {
        let x = x - centres[0];
        cross += outer(y - centres[1], x);
        square += outer(x, x);
    }
    cross * square.inverse()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(n: usize) -> Vec<DVec3> {
        (0..n).map(|i| DVec3::new((i as f64).sin(), (i as f64 * 1.7).cos(), (i as f64 * 0.3).sin())).collect()
    }

    #[test]
    fn an_affine_motion_of_many_points_is_found() {
        let from = cloud(12);
        let moved = |p: DVec3| DVec3::new(2.0 * p.z, p.x + 0.3 * p.y, -p.y) + DVec3::X;
        let to: Vec<DVec3> = from.iter().map(|&p| moved(p)).collect();
        let warp = Warp::fit(&from, &to, [1.0, 1.0]);
        let p = DVec3::new(0.2, -0.4, 0.1);
        assert!(warp.apply(p).distance(moved(p)) < 0.05, "{} for {}", warp.apply(p), moved(p));
    }

    #[test]
    fn the_given_points_are_met_nearly() {
        let (from, to) = (cloud(9), cloud(18)[9..].to_vec());
        let warp = Warp::fit(&from, &to, [1.0, 1.0]);
        for (&x, &y) in from.iter().zip(&to) {
            assert!(warp.apply(x).distance(y) < 0.02, "{} for {y}", warp.apply(x));
        }
    }

    #[test]
    fn one_point_gives_a_translation_and_a_scaling() {
        let warp = Warp::fit(&[DVec3::X], &[DVec3::Y], [1.0, 4.0]);
        assert!(warp.apply(DVec3::X + DVec3::Z).distance(DVec3::Y + 2.0 * DVec3::Z) < 1e-12);
    }
}
