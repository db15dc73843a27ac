//! Relaxation of the composed map inside a domain.
//!
//! Both meshes are embedded in the same domain. The vertices of one move, one at a time, so that the symmetric
//! Dirichlet energy of the map between the meshes falls. Every triangle of the moving mesh sees the metrics of the fixed
//! mesh at its own centroid and at the centroids of all fixed triangles inside it, so a fine mesh under a coarse one is
//! not overlooked, and the energy is the same one whichever mesh moves: the mean of both meshes' area-weighted energies.

use super::domain::{Domain, Fans};
use super::stretch::Frame;
use super::walk::{Spot, walk};
use crate::mesh::metric;
use crate::solve::dirichlet::{Local, Metrics, Rest, newton_step};
use glam::DVec2;

/// A triangle of the ring keeps at least this share of its planar area in one move.
const KEEP_AREA: f64 = 0.1;
/// Halvings of a step before the vertex stays.
const HALVINGS: usize = 6;
/// A move must lower the ring's energy by this share, or it is not worth taking.
const LEAST_GAIN: f64 = 1e-8;
/// Cap on the energy per area when domains are compared: slivers between an arc and a vertex would drown everything.
const CAP: f64 = 100.0;
/// Triangles with less than this share of the mean area have no say: their shape is rounding noise.
const NEGLIGIBLE: f64 = 1e-9;

/// The moving mesh over a fixed one.
pub struct Smoother<'a> {
    pub(super) moving: &'a mut Domain,
    fans: Fans,
    pub(super) rest: Vec<Rest>,
    pub(super) metrics: Vec<Metrics>,
}

impl<'a> Smoother<'a> {
    /// Gathers the metrics of `fixed` over every triangle of `moving`.
    pub fn new(moving: &'a mut Domain, fixed: &Domain) -> Self {
        let rest = moving.triangles.iter().map(|t| Rest::new(metric::flatten(spatial(moving, t)))).collect();
        let metrics = gather(moving, fixed);
        Smoother { fans: moving.fans(), moving, rest, metrics }
    }

    /// A patch over the flat triangle of its frame, scaled to the patch's area: for embeddings of one mesh alone.
    pub fn flat(moving: &'a mut Domain, frame: &Frame) -> Self {
        let rest = moving.triangles.iter().map(|t| Rest::new(metric::flatten(spatial(moving, t)))).collect();
        let areas = areas(moving);
        let total: f64 = areas.iter().sum();
        let unit = (total / frame.area()).sqrt();
        let derivative = [frame.first, frame.second].map(|d| (d * unit).extend(0.0));
        let weigh = |&area: &f64| {
            let mut metrics = Metrics::NONE;
            if area > NEGLIGIBLE * total / areas.len() as f64 {
                metrics.add(derivative, area);
            }
            metrics
        };
        let metrics = areas.iter().map(weigh).collect();
        Smoother { fans: moving.fans(), moving, rest, metrics }
    }

    /// Energy of all triangles, each capped at `CAP` times its weight: the area of the domain's meshes for an isometry.
    pub fn energy(&self) -> f64 {
        let one = |t: usize| {
            let [p, b, c] = self.moving.triangle(t);
            let energy = self.rest[t].energy(&self.metrics[t], 0, p, b, c);
            if self.has_say(t) { energy.min(CAP * self.metrics[t].weight) } else { 0.0 }
        };
        (0..self.rest.len()).map(one).sum()
    }

    /// Energy of all triangles, none capped.
    pub(super) fn raw_energy(&self) -> f64 {
        let one = |t: usize| {
            let [p, b, c] = self.moving.triangle(t);
            if self.has_say(t) { self.rest[t].energy(&self.metrics[t], 0, p, b, c) } else { 0.0 }
        };
        (0..self.rest.len()).map(one).sum()
    }

    pub(super) fn has_say(&self, t: usize) -> bool {
        self.metrics[t] != Metrics::NONE
    }

    /// Moves every free vertex once, in order or in reverse order; returns how many moved.
    pub fn sweep(&mut self, backwards: bool) -> usize {
        let n = self.moving.vertices.len();
        let order = |i: usize| if backwards { n - 1 - i } else { i };
        (0..n).map(order).filter(|&v| self.moving.free[v] && self.improve(v)).count()
    }

    fn improve(&mut self, v: usize) -> bool {
        let start = self.local(v);
        let Some(step) = newton_step(&start) else { return false };
        let goal = start.energy * (1.0 - LEAST_GAIN);
        let from = self.moving.positions[v];
        for k in 0..=HALVINGS {
            let p = from + step * 0.5f64.powi(k as i32);
            if self.keeps_orientation(v, p) && self.energy_at(v, p) < goal {
                self.moving.positions[v] = p;
                return true;
            }
        }
        false
    }

    fn local(&self, v: usize) -> Local {
        let mut sum = Local::default();
        for &(t, i) in self.fans.around(v).iter().filter(|&&(t, _)| self.has_say(t as usize)) {
            let [b, c] = self.others(t, i);
            let at = self.moving.positions[v];
            let local = self.rest[t as usize].local(&self.metrics[t as usize], i as usize, at, b, c);
            sum.energy += local.energy;
            sum.gradient += local.gradient;
            sum.hessian += local.hessian;
        }
        sum
    }

    fn energy_at(&self, v: usize, p: DVec2) -> f64 {
        let ring = self.fans.around(v).iter().filter(|&&(t, _)| self.has_say(t as usize));
        ring.map(|&(t, i)| {
            let [b, c] = self.others(t, i);
            self.rest[t as usize].energy(&self.metrics[t as usize], i as usize, p, b, c)
        })
        .sum()
    }

    /// The two corners of `t` after corner `i`.
    fn others(&self, t: u32, i: u8) -> [DVec2; 2] {
        let corners = self.moving.triangles[t as usize];
        [1, 2].map(|k| self.moving.positions[corners[(i as usize + k) % 3] as usize])
    }

    fn keeps_orientation(&self, v: usize, p: DVec2) -> bool {
        let old = self.moving.positions[v];
        self.fans.around(v).iter().all(|&(t, i)| {
            let [b, c] = self.others(t, i);
            (b - p).perp_dot(c - p) > KEEP_AREA * (b - old).perp_dot(c - old)
        })
    }
}

fn spatial(domain: &Domain, t: &[u32; 3]) -> [glam::DVec3; 3] {
    t.map(|v| domain.points[v as usize])
}

/// The metrics of `fixed` over every triangle of `moving`: half the weight from each mesh's areas.
fn gather(moving: &Domain, fixed: &Domain) -> Vec<Metrics> {
    let mut metrics = vec![Metrics::NONE; moving.triangles.len()];
    let areas = areas(moving);
    let floor = NEGLIGIBLE * areas.iter().sum::<f64>() / areas.len() as f64;
    let mut near = 0;
    for (t, &area) in areas.iter().enumerate().filter(|&(_, &area)| area > floor) {
        near = walk(fixed, near, centroid(moving, t)).triangle;
        metrics[t].add(derivative(fixed, near), 0.5 * area);
    }
    near = 0;
    for (t, area) in self::areas(fixed).into_iter().enumerate() {
        near = walk(moving, near, centroid(fixed, t)).triangle;
        if areas[near as usize] > floor {
            metrics[near as usize].add(derivative(fixed, t as u32), 0.5 * area);
        }
    }
    metrics
}

fn areas(domain: &Domain) -> Vec<f64> {
    domain.triangles.iter().map(|t| metric::area(spatial(domain, t))).collect()
}

fn centroid(domain: &Domain, t: usize) -> DVec2 {
    let [a, b, c] = domain.triangle(t);
    (a + b + c) / 3.0
}

fn derivative(domain: &Domain, triangle: u32) -> [glam::DVec3; 2] {
    Spot { triangle, weights: [0.0; 3] }.derivative(domain)
}
