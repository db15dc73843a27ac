//! (u, v) of a region from four fronts (DIFFUSION 2.8), made to agree with its neighbours.
//!
//! u = d_u0 / (d_u0 + d_u1) and v likewise: d is the distance, inside the region, from all vertices of a side. So u is 0 on
//! u0 and 1 on u1, corners take the values of both of their sides. Along u0 and u1, v as it comes depends on the region:
//! its neighbours would have other values. Both get the share of the length instead, and the difference dies away towards
//! the other side: v + (1 - u) (share - v on u0) + u (share - v on u1).

use super::disc::Disc;
use crate::mesh::TriMesh;
use crate::path::side_front::{FrontGraph, Travel};
use glam::DVec2;
use rayon::prelude::*;

/// A side of a region.
#[derive(Clone, Debug)]
pub struct Side {
    /// Its vertices in the disc, counter-clockwise, both corners included.
    pub vertices: Vec<u32>,
    /// The share of the way at every vertex, 0 to 1.
    pub shares: Vec<f64>,
}

/// The coordinates of every vertex of a disc, from (0, 0) at the first corner counter-clockwise to (0, 1).
pub fn square(mesh: &TriMesh, disc: &Disc, sides: &[Side; 4], travel: Travel) -> Vec<DVec2> {
    let graph = FrontGraph::new(&disc.points(mesh), &disc.triangles);
    let distances: Vec<Vec<f64>> = sides.par_iter().map(|side| graph.distances(&side.vertices, travel)).collect();
    let ratio = |near: f64, far: f64| if near + far > 0.0 { (near / (near + far)).clamp(0.0, 1.0) } else { 0.5 };
    let [below, right, above, left] = [0, 1, 2, 3].map(|k| &distances[k]);
    let mut st: Vec<DVec2> =
        (0..disc.vertices.len()).map(|v| DVec2::new(ratio(left[v], right[v]), ratio(below[v], above[v]))).collect();
    let along = |k: usize, axis: usize| Agreement::new(&sides[k], &st, axis, k >= 2);
    let agreements = [along(0, 0), along(1, 1), along(2, 0), along(3, 1)];
    for p in &mut st {
        let DVec2 { x: s, y: t } = *p;
        let s_moved = s + (1.0 - t) * agreements[0].shift(s) + t * agreements[2].shift(s);
        let t_moved = t + (1.0 - s) * agreements[3].shift(t) + s * agreements[1].shift(t);
        *p = DVec2::new(s_moved.clamp(0.0, 1.0), t_moved.clamp(0.0, 1.0));
    }
    pin(sides, &mut st);
    st
}

/// Puts the vertices of the sides exactly on the sides of the square.
pub fn pin(sides: &[Side; 4], st: &mut [DVec2]) {
    for (k, side) in sides.iter().enumerate() {
        for (&v, &share) in side.vertices.iter().zip(&side.shares) {
            st[v as usize] = on_side(k, share);
        }
    }
}

/// The point at a share of side `k` of the unit square, counter-clockwise from (0, 0).
pub fn on_side(k: usize, share: f64) -> DVec2 {
    match k {
        0 => DVec2::new(share, 0.0),
        1 => DVec2::new(1.0, share),
        2 => DVec2::new(1.0 - share, 1.0),
        _ => DVec2::new(0.0, 1.0 - share),
    }
}

/// What a coordinate is along a side as it comes, and what it should be; both from 0 to 1 and not falling.
struct Agreement {
    has: Vec<f64>,
    wants: Vec<f64>,
}

impl Agreement {
    fn new(side: &Side, st: &[DVec2], axis: usize, is_backward: bool) -> Self {
        let mut pairs: Vec<(f64, f64)> =
            side.vertices.iter().zip(&side.shares).map(|(&v, &share)| (st[v as usize][axis], share)).collect();
        if is_backward {
            pairs.reverse();
            pairs.iter_mut().for_each(|pair| pair.1 = 1.0 - pair.1);
        }
        let last = pairs.len() - 1;
        (pairs[0].0, pairs[last].0) = (0.0, 1.0);
        let mut most = 0.0f64;
        pairs.iter_mut().for_each(|pair| {
            most = most.max(pair.0);
            pair.0 = most;
        });
        let (has, wants) = pairs.into_iter().unzip();
        Agreement { has, wants }
    }

    /// How far a value is to move, by linear interpolation; where several shares have one value, as their middle.
    fn shift(&self, x: f64) -> f64 {
        let (below, above) = (self.has.partition_point(|&h| h < x), self.has.partition_point(|&h| h <= x));
        if below < above {
            return 0.5 * (self.wants[below] + self.wants[above - 1]) - x;
        }
        if below == 0 || below == self.has.len() {
            return 0.0;
        }
        let (low, high) = (self.has[below - 1], self.has[below]);
        let t = (x - low) / (high - low);
        self.wants[below - 1] + (self.wants[below] - self.wants[below - 1]) * t - x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_interpolates_and_levels_plateaus() {
        let side = Side { vertices: vec![0, 1, 2, 3, 4], shares: vec![0.0, 0.25, 0.5, 0.75, 1.0] };
        let st = [0.0, 0.4, 0.3, 0.8, 1.0].map(|x| DVec2::new(x, 0.0));
        let a = Agreement::new(&side, &st, 0, false);
        for (x, expected) in [(0.0, 0.0), (0.2, 0.125), (0.4, 0.375), (0.6, 0.625), (1.0, 1.0)] {
            assert!((x + a.shift(x) - expected).abs() < 1e-12, "{x}");
        }
    }
}
