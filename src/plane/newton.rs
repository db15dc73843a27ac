//! One Newton step for all free vertices of a domain at once.
//!
//! Single moves carry an error over one ring a sweep; this carries it over the whole domain, which is what unfolds a limb
//! that a convex embedding has crushed. Of the second derivative only the positive semidefinite part of every triangle's
//! is taken (see [`crate::solve::dirichlet::Rest::block`]). The step is cut back until no triangle turns over and the
//! model of the energy falls.

use super::smooth::Smoother;
use crate::solve::dirichlet::Block;
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use glam::DVec2;

/// The step goes at most this share of the way to the first triangle that collapses.
const SAFE_SHARE: f64 = 0.8;
/// Halvings of the step before it is given up.
const HALVINGS: usize = 8;
/// Added to the diagonal, as a share of its mean: keeps the system definite where triangles have no say.
const RIDGE: f64 = 1e-9;
/// Marks vertices that do not move.
const FIXED: u32 = u32::MAX;

/// Moves all free vertices along the Newton direction of the model; false if no step lowers it.
pub fn newton(smoother: &mut Smoother) -> bool {
    let Some(direction) = direction(smoother, &[]) else { return false };
    let start = smoother.moving.positions.clone();
    let before = model_energy(smoother);
    let mut share = (SAFE_SHARE * first_collapse(smoother, &direction)).min(1.0);
    for _ in 0..HALVINGS {
        for (p, (&from, &d)) in smoother.moving.positions.iter_mut().zip(start.iter().zip(&direction)) {
            *p = from + d * share;
        }
        if model_energy(smoother) < before {
            return true;
        }
        share *= 0.5;
    }
    smoother.moving.positions = start;
    false
}

/// Drags fixed vertices towards places, all others giving way as the model's energy has it, as far as no triangle turns
/// over; returns the share of the way that was gone, 1 at the places themselves.
pub fn drag(smoother: &mut Smoother, places: &[(u32, DVec2)]) -> f64 {
    let start = smoother.moving.positions.clone();
    let ways: Vec<(u32, DVec2)> = places.iter().map(|&(v, to)| (v, to - start[v as usize])).collect();
    let Some(direction) = direction(smoother, &ways) else { return 0.0 };
    let whole = SAFE_SHARE * first_collapse(smoother, &direction);
    let mut share = whole.min(1.0);
    for _ in 0..HALVINGS {
        for (p, (&from, &d)) in smoother.moving.positions.iter_mut().zip(start.iter().zip(&direction)) {
            *p = from + d * share;
        }
        if share == 1.0 {
            places.iter().for_each(|&(v, to)| smoother.moving.positions[v as usize] = to);
        }
        if model_energy(smoother).is_finite() {
            return share;
        }
        share *= 0.5;
    }
    smoother.moving.positions = start;
    0.0
}

fn model_energy(smoother: &Smoother) -> f64 {
    (0..smoother.moving.triangles.len()).filter_map(|t| smoother.model_energy(t)).sum()
}

/// The Newton direction of the free vertices, given the ways of some fixed ones.
fn direction(smoother: &Smoother, ways: &[(u32, DVec2)]) -> Option<Vec<DVec2>> {
    let mut direction = vec![DVec2::ZERO; smoother.moving.vertices.len()];
    ways.iter().for_each(|&(v, way)| direction[v as usize] = way);
    let mut number = vec![FIXED; smoother.moving.vertices.len()];
    let free: Vec<usize> = (0..number.len()).filter(|&v| smoother.moving.free[v]).collect();
    (0u32..).zip(&free).for_each(|(k, &v)| number[v] = k);
    if free.is_empty() {
        return None;
    }
    let n = 2 * free.len();
    let mut rhs = faer::Mat::<f64>::zeros(n, 1);
    let mut entries = Vec::with_capacity(21 * smoother.moving.triangles.len() + n);
    for t in 0..smoother.moving.triangles.len() {
        let Some(block) = smoother.model_block(t) else { continue };
        let corners = smoother.moving.triangles[t];
        let way = corners.map(|v| direction[v as usize]);
        scatter(&block, &corners.map(|v| number[v as usize]), &way, &mut entries, &mut rhs);
    }
    let trace: f64 = entries.iter().filter(|e| e.row == e.col).map(|e| e.val).sum();
    let ridge = RIDGE * trace / n as f64;
    entries.extend((0..n).map(|i| Triplet { row: i, col: i, val: ridge }));
    let matrix = SparseColMat::try_new_from_triplets(n, n, &entries).ok()?;
    let factor = matrix.sp_cholesky(faer::Side::Lower).ok()?;
    factor.solve_in_place(&mut rhs);
    for (k, &v) in free.iter().enumerate() {
        direction[v] = DVec2::new(rhs[(2 * k, 0)], rhs[(2 * k + 1, 0)]);
    }
    direction.iter().all(|d| d.is_finite()).then_some(direction)
}

/// Adds a triangle's derivatives to the lower half of the system.
fn scatter(
    block: &Block,
    number: &[u32; 3],
    way: &[DVec2; 3],
    entries: &mut Vec<Triplet<usize, usize, f64>>,
    rhs: &mut faer::Mat<f64>,
) {
    for i in (0..3).filter(|&i| number[i] != FIXED) {
        let row = 2 * number[i] as usize;
        rhs[(row, 0)] -= block.gradient[i].x;
        rhs[(row + 1, 0)] -= block.gradient[i].y;
        for j in (0..3).filter(|&j| number[j] == FIXED) {
            let pull = block.hessian[i][j] * way[j];
            rhs[(row, 0)] -= pull.x;
            rhs[(row + 1, 0)] -= pull.y;
        }
        for j in (0..3).filter(|&j| number[j] != FIXED && number[j] <= number[i]) {
            let col = 2 * number[j] as usize;
            let h = block.hessian[i][j];
            entries.push(Triplet { row, col, val: h.x_axis.x });
            entries.push(Triplet { row: row + 1, col, val: h.x_axis.y });
            entries.push(Triplet { row: row + 1, col: col + 1, val: h.y_axis.y });
            if i != j {
                entries.push(Triplet { row, col: col + 1, val: h.y_axis.x });
            }
        }
    }
}

/// The smallest positive share of the direction at which some triangle has no area; infinite if none ever does.
fn first_collapse(smoother: &Smoother, direction: &[DVec2]) -> f64 {
    let one = |(t, corners): (usize, &[u32; 3])| {
        let [p, q, r] = smoother.moving.triangle(t);
        let [d, e, f] = corners.map(|v| direction[v as usize]);
        let (u, w, du, dw) = (q - p, r - p, e - d, f - d);
        smallest_root(du.perp_dot(dw), u.perp_dot(dw) + du.perp_dot(w), u.perp_dot(w))
    };
    smoother.moving.triangles.iter().enumerate().map(one).fold(f64::INFINITY, f64::min)
}

/// The smallest positive root of a s^2 + b s + c with c > 0, or infinity.
fn smallest_root(a: f64, b: f64, c: f64) -> f64 {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let q = -0.5 * (b + b.signum() * discriminant.sqrt());
    [q / a, c / q].into_iter().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min)
}
