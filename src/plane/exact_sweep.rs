//! Vertices of distorted triangles moved one at a time, by the energy itself.
//!
//! A Newton step for a whole domain is cut back by its worst triangle. Here every vertex makes a Newton step of its own,
//! and only its ring of triangles can cut it back.

use super::domain::Fans;
use super::smooth::Smoother;
use glam::{DMat2, DVec2};

/// A triangle is distorted if its energy is above this many times that of an isometry.
const DISTORTED: f64 = 1.2;
/// A step goes at most this share of the way to the first triangle that collapses.
const SAFE_SHARE: f64 = 0.8;
/// Halvings of a step before the vertex stays.
const HALVINGS: usize = 4;

/// Moves the free vertices of distorted triangles once so that the energy falls.
pub fn sweep_exactly(smoother: &mut Smoother) {
    let fans = smoother.moving.fans();
    let mut distorted = vec![false; smoother.moving.vertices.len()];
    for t in 0..smoother.moving.triangles.len() {
        if smoother.exact_energy_of(t).is_some_and(|p| p.energy > DISTORTED * p.weight) {
            smoother.moving.triangles[t].iter().for_each(|&v| distorted[v as usize] = true);
        }
    }
    for v in 0..distorted.len() {
        if distorted[v] && smoother.moving.free[v] {
            fans.around(v).iter().for_each(|&(t, _)| smoother.look_at(t as usize));
            improve(smoother, &fans, v, |smoother| {
                let ring = fans.around(v).iter();
                ring.filter_map(|&(t, _)| smoother.exact_energy_of(t as usize)).map(|p| p.energy).sum()
            });
        }
    }
}

fn improve(smoother: &mut Smoother, fans: &Fans, v: usize, ring_energy: impl Fn(&mut Smoother) -> f64) {
    let (mut gradient, mut hessian) = (DVec2::ZERO, DMat2::ZERO);
    for &(t, i) in fans.around(v) {
        if let Some(block) = smoother.model_block(t as usize) {
            gradient += block.gradient[i as usize];
            hessian += block.hessian[i as usize][i as usize];
        }
    }
    let step = -(hessian.inverse() * gradient);
    if !step.is_finite() {
        return;
    }
    let from = smoother.moving.positions[v];
    let before = ring_energy(smoother);
    let mut share = (SAFE_SHARE * first_collapse(smoother, fans, v, step)).min(1.0);
    for _ in 0..HALVINGS {
        smoother.moving.positions[v] = from + step * share;
        if ring_energy(smoother) < before {
            return;
        }
        share *= 0.5;
    }
    smoother.moving.positions[v] = from;
}

/// The share of the step at which the first triangle of the ring collapses.
fn first_collapse(smoother: &Smoother, fans: &Fans, v: usize, step: DVec2) -> f64 {
    let at = |v: u32| smoother.moving.positions[v as usize];
    let one = |&(t, i): &(u32, u8)| {
        let corners = smoother.moving.triangles[t as usize];
        let [p, b, c] = [0, 1, 2].map(|k| at(corners[(i as usize + k) % 3]));
        let (area, loss) = ((b - p).perp_dot(c - p), step.perp_dot(c - b));
        if loss > 0.0 { area / loss } else { f64::INFINITY }
    };
    fans.around(v).iter().map(one).fold(f64::INFINITY, f64::min)
}
