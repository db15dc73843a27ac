//! Symmetric Dirichlet energy of a triangle that moves in a plane domain with a metric, and its derivatives.
//!
//! A triangle of one mesh, at rest in its own plane, is mapped into the domain by a matrix M. The other mesh, embedded in
//! the same domain, gives it a metric G there: lengths on that mesh. The map between the meshes then stretches by
//! tr(M' G M), its inverse by tr(M' G M) / det(M' G M). A triangle may lie under several metrics with weights w; their
//! sums are all that is needed, so they are gathered once:
//!
//!   energy = ( tr(M' P M) + tr(M' Q M) / det(M)^2 ) / 4,    P = sum w G,    Q = sum w G / det G.
//!
//! With weights that sum to the triangle's area this is the area times the symmetric Dirichlet energy, 1 for an
//! isometry.

use glam::{DMat2, DVec2};

/// The metrics over a triangle, gathered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Metrics {
    /// Weighted sum of the metrics.
    pub sum: DMat2,
    /// Weighted sum of the metrics divided by their determinants.
    pub inverse: DMat2,
    /// Sum of the weights.
    pub weight: f64,
}

impl Metrics {
    /// Nothing gathered yet.
    pub const NONE: Metrics = Metrics { sum: DMat2::ZERO, inverse: DMat2::ZERO, weight: 0.0 };

    /// Space itself, for a triangle of the given area whose image is laid flat.
    pub fn identity(area: f64) -> Self {
        let sum = DMat2::from_diagonal(DVec2::splat(area));
        Metrics { sum, inverse: sum, weight: area }
    }

    /// Adds metrics, their weights multiplied.
    pub fn add_weighted(&mut self, other: &Metrics, weight: f64) {
        self.sum += other.sum * weight;
        self.inverse += other.inverse * weight;
        self.weight += other.weight * weight;
    }

    /// Adds the metric that a derivative by the two plane coordinates gives.
    pub fn add(&mut self, [du, dv]: [glam::DVec3; 2], weight: f64) {
        let (a, b, c) = (du.length_squared(), du.dot(dv), dv.length_squared());
        let metric = DMat2::from_cols(DVec2::new(a, b), DVec2::new(b, c));
        let det = du.cross(dv).length_squared();
        if det.is_normal() {
            self.sum += metric * weight;
            self.inverse += metric * (weight / det);
            self.weight += weight;
        }
    }
}

/// First and second derivatives of a triangle's energy by its three corners.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// By each corner.
    pub gradient: [DVec2; 3],
    /// By each pair of corners.
    pub hessian: [[DMat2; 3]; 3],
}

/// A triangle at rest.
#[derive(Clone, Copy, Debug)]
pub struct Rest {
    /// Maps its two edges at the first corner to the unit vectors.
    inverse: DMat2,
}

impl Rest {
    /// From the corners in a plane of its own, counter-clockwise.
    pub fn new([a, b, c]: [DVec2; 3]) -> Self {
        Rest { inverse: DMat2::from_cols(b - a, c - a).inverse() }
    }

    /// Maps the triangle's two edges at its first corner to the unit vectors.
    pub fn inverse(&self) -> DMat2 {
        self.inverse
    }

    /// Energy with the corners at the given places; infinite unless they turn left.
    pub fn energy(&self, metrics: &Metrics, [p, b, c]: [DVec2; 3]) -> f64 {
        let m = DMat2::from_cols(b - p, c - p) * self.inverse;
        let det = m.determinant();
        if det.is_nan() || det <= 0.0 {
            return f64::INFINITY;
        }
        (quadratic(metrics.sum, m) + quadratic(metrics.inverse, m) / (det * det)) * 0.25
    }

    /// What a triangle of a compatible mesh costs, of the given area and with its image laid flat: its energy E times
    /// 1 + c D^2, where the image is D times as large and c is `dislike`.
    pub fn cost(&self, area: f64, dislike: f64, image: [DVec2; 3]) -> f64 {
        let swelling = self.swelling(image);
        self.energy(&Metrics::identity(area), image) * (1.0 + dislike * swelling * swelling)
    }

    /// Derivatives of the cost by all three corners, the second one made positive semidefinite: of what is not the energy's
    /// own, that multiple of c E dD dD' is kept which is right where the image grows evenly.
    pub fn cost_block(&self, area: f64, dislike: f64, image: [DVec2; 3]) -> Block {
        let [p, b, c] = image;
        let mut block = self.block(&Metrics::identity(area), image);
        let energy = self.energy(&Metrics::identity(area), image);
        let swelling = self.swelling(image);
        let slope = [c - b, p - c, b - p].map(|edge| edge.perp() * self.inverse.determinant());
        let square = swelling * swelling;
        let factor = 1.0 + dislike * square;
        let joint = dislike * energy * ((7.0 * square - 1.0) / (square + 1.0)).max(0.0);
        for i in 0..3 {
            block.gradient[i] = block.gradient[i] * factor + slope[i] * (2.0 * dislike * swelling * energy);
            for j in 0..3 {
                block.hessian[i][j] = block.hessian[i][j] * factor + outer(slope[i], slope[j]) * joint;
            }
        }
        block
    }

    /// By which factor the image is larger.
    fn swelling(&self, [p, b, c]: [DVec2; 3]) -> f64 {
        (b - p).perp_dot(c - p) * self.inverse.determinant()
    }

    /// Derivatives by all three corners, the second one made positive semidefinite.
    ///
    /// With q = tr(M' Q M) and D = det M the term q / D^2 has the second differential
    /// 2 tr(dM' Q dM) / D^2 - 8 tr(M' Q dM) dD / D^3 + 6 q dD^2 / D^4 - 2 q d2D / D^3. The last part is left out and the
    /// 6 becomes an 8; what remains is twice the square of Q^(1/2) (dM / D - 2 M dD / D^2).
    pub fn block(&self, metrics: &Metrics, [p, b, c]: [DVec2; 3]) -> Block {
        let inverse = self.inverse;
        let m = DMat2::from_cols(b - p, c - p) * inverse;
        let det = m.determinant();
        let (d2, d3) = (det * det, det * det * det);
        let cofactor = DMat2::from_cols(DVec2::new(m.y_axis.y, -m.y_axis.x), DVec2::new(-m.x_axis.y, m.x_axis.x));
        let (pm, qm) = (metrics.sum * m, metrics.inverse * m);
        let q = quadratic(metrics.inverse, m);
        let slope = pm * 2.0 + qm * (2.0 / d2) - cofactor * (2.0 * q / d3);
        let same = metrics.sum * 2.0 + metrics.inverse * (2.0 / d2);
        let part = |k: usize, l: usize| {
            let (a, w) = ([qm.col(k), qm.col(l)], [cofactor.col(k), cofactor.col(l)]);
            let cross = (outer(a[0], w[1]) + outer(w[0], a[1])) * (4.0 / d3);
            let base = if k == l { same } else { DMat2::ZERO };
            base - cross + outer(w[0], w[1]) * (8.0 * q / d2 / d2)
        };
        let parts = [[part(0, 0), part(0, 1)], [part(1, 0), part(1, 1)]];
        let rows = [inverse.row(0), inverse.row(1)];
        let weights = [-(rows[0] + rows[1]), rows[0], rows[1]];
        let hessian = |i: usize, j: usize| {
            let (x, y) = (weights[i], weights[j]);
            (parts[0][0] * (x.x * y.x)
                + parts[0][1] * (x.x * y.y)
                + parts[1][0] * (x.y * y.x)
                + parts[1][1] * (x.y * y.y))
                * 0.25
        };
        Block {
            gradient: weights.map(|w| slope * w * 0.25),
            hessian: std::array::from_fn(|i| std::array::from_fn(|j| hessian(i, j))),
        }
    }
}

/// tr(M' S M).
fn quadratic(s: DMat2, m: DMat2) -> f64 {
    m.x_axis.dot(s * m.x_axis) + m.y_axis.dot(s * m.y_axis)
}

fn outer(a: DVec2, b: DVec2) -> DMat2 {
    DMat2::from_cols(a * b.x, a * b.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: [DVec2; 3] = [DVec2::ZERO, DVec2::new(2.0, 0.1), DVec2::new(0.4, 1.5)];

    #[test]
    fn a_larger_image_costs_more_than_a_smaller_one() {
        let rest = Rest::new(REST);
        let scaled = |s: f64| REST.map(|p| p * s);
        assert!((rest.cost(1.0, 0.1, REST) - 1.1).abs() < 1e-12);
        assert!(rest.cost(1.0, 0.1, scaled(4.0)) > 2.0 * rest.cost(1.0, 0.1, scaled(0.25)));
        assert!(rest.cost(1.0, 0.1, [REST[0], REST[2], REST[1]]).is_infinite());
    }

    #[test]
    fn the_slope_of_the_cost_is_what_differences_tell() {
        let rest = Rest::new(REST);
        for image in [REST, [DVec2::new(0.3, -0.2), DVec2::new(7.0, 1.0), DVec2::new(-1.0, 4.0)]] {
            let block = rest.cost_block(0.7, 0.1, image);
            for i in 0..3 {
                for axis in [DVec2::X, DVec2::Y] {
                    let at = |step: f64| {
                        let mut moved = image;
                        moved[i] += axis * step;
                        rest.cost(0.7, 0.1, moved)
                    };
                    let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
                    let told = block.gradient[i].dot(axis);
                    assert!((slope - told).abs() < 1e-6 * (1.0 + slope.abs()), "{slope} {told}");
                    assert!(axis.dot(block.hessian[i][i] * axis) >= 0.0);
                }
            }
        }
    }
}
