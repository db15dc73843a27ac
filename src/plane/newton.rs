//! One Newton step for all free vertices of a domain at once.
//!
//! Single moves carry an error over one ring a sweep; this carries it over the whole domain, which is what unfolds a limb
//! that a convex embedding has crushed. Of the second derivative only the positive semidefinite part of every triangle's
//! is taken (see [`crate::solve::dirichlet::Rest::block`]). The step is cut back until no triangle turns over and the
//! model of the energy falls.

use super::smooth::Smoother;
use crate::solve::blocks::{Blocks, Pattern};
use crate::solve::dirichlet::Block;
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
    let numbered = |t: &[u32; 3]| t.map(|v| number[v as usize]);
    let pattern = Pattern::new(free.len(), smoother.moving.triangles.iter().map(numbered));
    let system = || {
        let (mut system, mut rhs) = (Blocks::new(&pattern), vec![DVec2::ZERO; free.len()]);
        for (t, corners) in smoother.moving.triangles.iter().enumerate() {
            let Some(block) = smoother.model_block(t) else { continue };
            let way = corners.map(|v| direction[v as usize]);
            scatter(&block, &numbered(corners), &way, &mut system, &mut rhs);
        }
        system.add_ridge(RIDGE * system.mean_diagonal());
        (system, rhs)
    };
    let (plan, (system, rhs)) = rayon::join(|| pattern.plan(), system);
    let found = system.solve(&plan?, &rhs)?;
    free.iter().zip(found).for_each(|(&v, d)| direction[v] = d);
    direction.iter().all(|d| d.is_finite()).then_some(direction)
}

/// Adds a triangle's derivatives to the lower half of the system.
fn scatter(block: &Block, number: &[u32; 3], way: &[DVec2; 3], system: &mut Blocks<'_>, rhs: &mut [DVec2]) {
    for i in (0..3).filter(|&i| number[i] != FIXED) {
        let row = &mut rhs[number[i] as usize];
        *row -= block.gradient[i];
        for j in 0..3 {
            if number[j] == FIXED {
                *row -= block.hessian[i][j] * way[j];
            } else if number[j] <= number[i] {
                system.add(number[i], number[j], block.hessian[i][j]);
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
