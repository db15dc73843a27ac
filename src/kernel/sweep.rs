//! One colour of a sweep over domains in which one mesh moves over another.
//!
//! Every vertex makes a Newton step of its own that lowers the symmetric Dirichlet energy of its triangles
//! ([`crate::solve::dirichlet`] has the formulas and says what of the second derivative is taken). The step goes at most a
//! share of the way to the first triangle that collapses and is halved until the energy of the ring falls. So the energy
//! never rises, and no triangle turns over.

use bytemuck::{Pod, Zeroable};
use glam::{DMat2, DVec2};
use rayon::prelude::*;

use crate::gpu::{Access, GpuBuffer, GpuDevice, Kernel, Launch};
use crate::solve::dirichlet::{Metrics, Rest};

use super::rings::Lists;
use super::{GRAIN, Lanes};

/// `kernels/sweep.wgsl`.
pub const KERNEL: Kernel = Kernel {
    name: "sweep",
    source: include_str!("../../kernels/sweep.wgsl"),
    buffers: &[Access::Read, Access::Read, Access::Read, Access::Read, Access::Read, Access::ReadWrite],
};

/// A step goes at most this share of the way to the first triangle that collapses.
pub const SAFE_SHARE: f32 = 0.8;
/// How often a step is tried, each time half as long, before the vertex stays where it is.
pub const TRIES: u32 = 4;
/// Energy of a triangle that has turned over: more than any other, and few of them add up without overflow.
pub const FOLDED: f32 = 1e36;

/// Parameters of one dispatch.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct SweepParams {
    /// The first entry of the list of vertices.
    pub first: u32,
    /// Number of entries.
    pub count: u32,
}

/// A moving triangle and the metrics it sees below it; symmetric matrices are `[xx, xy, yy, 0]`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Sight {
    /// Maps the unit vectors to the triangle's edges at its first corner, at rest, inverted; column by column.
    pub rest: [f32; 4],
    /// Weighted sum of the metrics.
    pub sum: [f32; 4],
    /// The same of the metrics divided by their determinants.
    pub inverse: [f32; 4],
}

impl Sight {
    /// What a triangle sees that has its corners at the given places; with no metrics it only may not turn over.
    ///
    /// The triangle at rest is scaled to the size it has in the plane, and the metrics with it, which changes no energy:
    /// in f32 all must be of order one, however small the triangle has become.
    pub fn new(rest: &Rest, metrics: &Metrics, [a, b, c]: [DVec2; 3]) -> Sight {
        let inverse = rest.inverse();
        let determinant = (b - a).perp_dot(c - a) * inverse.determinant();
        let scale = if determinant.is_normal() { determinant.abs() } else { 1.0 };
        let packed = |s: DMat2| [s.x_axis.x as f32, s.x_axis.y as f32, s.y_axis.y as f32, 0.0];
        Sight {
            rest: (inverse * scale.sqrt().recip()).to_cols_array().map(|x| x as f32),
            sum: packed(metrics.sum * scale),
            inverse: packed(metrics.inverse * scale.recip()),
        }
    }
}

/// A position in the plane as the kernel has it: rounded to f32, and what is missing. The first part stays, the second
/// takes up the moves, so differences keep their bits where triangles are tiny.
pub fn split(p: DVec2) -> Lanes {
    let (x, y) = (p.x as f32, p.y as f32);
    [x, y, (p.x - f64::from(x)) as f32, (p.y - f64::from(y)) as f32]
}

/// The position that [`split`] took apart.
pub fn joined([x, y, dx, dy]: Lanes) -> DVec2 {
    DVec2::new(f64::from(x) + f64::from(dx), f64::from(y) + f64::from(dy))
}

/// Meshes that move, as the kernel has them.
#[derive(Clone, Debug)]
pub struct Moving {
    /// The triangles around every vertex: four times the triangle, plus the corner that the vertex is of it.
    pub fans: Lists,
    /// Corners of every triangle, counter-clockwise, and one number unused.
    pub triangles: Vec<[u32; 4]>,
    /// What every triangle sees.
    pub sights: Vec<Sight>,
    /// See [`split`].
    pub positions: Vec<Lanes>,
}

/// The kernel's buffers in binding order.
pub(super) struct SweepBuffers {
    pub vertices: GpuBuffer<u32>,
    pub fan_starts: GpuBuffer<u32>,
    pub fans: GpuBuffer<u32>,
    pub triangles: GpuBuffer<[u32; 4]>,
    pub sights: GpuBuffer<Sight>,
    pub positions: GpuBuffer<Lanes>,
}

/// Binds the kernel to its buffers for the vertices at `range` of their list.
pub(super) fn launch(gpu: &GpuDevice, range: std::ops::Range<u32>, buffers: &SweepBuffers) -> Launch {
    let b = buffers;
    gpu.launch(
        &KERNEL,
        range,
        |span| SweepParams { first: span.first, count: span.count },
        &[&b.vertices, &b.fan_starts, &b.fans, &b.triangles, &b.sights, &b.positions],
    )
}

/// The CPU twin; moved positions are written after all are computed, which a proper colouring makes no difference to.
pub fn reference(vertices: &[u32], moving: &mut Moving) {
    let at_rest: &Moving = moving;
    let one = |&v: &u32| improved(at_rest, at_rest.fans.of(v as usize), at_rest.positions[v as usize]);
    let moved: Vec<Lanes> = vertices.par_iter().with_min_len(GRAIN).map(one).collect();
    for (&v, p) in vertices.iter().zip(moved) {
        moving.positions[v as usize] = p;
    }
}

type Vec2 = [f32; 2];

/// Where the vertex at `here` goes.
fn improved(moving: &Moving, fan: &[u32], here: Lanes) -> Lanes {
    let step = newton(moving, fan, here);
    let before = fan_energy(moving, fan, here);
    let mut share = safe_share(moving, fan, here, step);
    for _ in 0..TRIES {
        let to = [here[0], here[1], here[2] + share * step[0], here[3] + share * step[1]];
        if fan_energy(moving, fan, to) < before {
            return to;
        }
        share *= 0.5;
    }
    here
}

/// From `p` to `q`.
fn between(p: Lanes, q: Lanes) -> Vec2 {
    [(q[0] - p[0]) + (q[2] - p[2]), (q[1] - p[1]) + (q[3] - p[3])]
}

/// The map from a triangle at rest into the plane, its two columns one after the other; `u` and `w` are its edges there
/// from its first corner.
fn map_of(rest: [f32; 4], u: Vec2, w: Vec2) -> [f32; 4] {
    [
        u[0] * rest[0] + w[0] * rest[1],
        u[1] * rest[0] + w[1] * rest[1],
        u[0] * rest[2] + w[0] * rest[3],
        u[1] * rest[2] + w[1] * rest[3],
    ]
}

/// A symmetric matrix times the columns of `m`.
fn times(s: [f32; 4], m: [f32; 4]) -> [f32; 4] {
    [s[0] * m[0] + s[1] * m[1], s[1] * m[0] + s[2] * m[1], s[0] * m[2] + s[1] * m[3], s[1] * m[2] + s[2] * m[3]]
}

fn dot4(a: [f32; 4], b: [f32; 4]) -> f32 {
    ((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]) + a[3] * b[3]
}

/// Energy of a triangle with the edges `u` and `w` from its first corner.
pub(super) fn energy_of(sight: &Sight, u: Vec2, w: Vec2) -> f32 {
    let m = map_of(sight.rest, u, w);
    let det = m[0] * m[3] - m[1] * m[2];
    // Also true for NaN.
    if !matches!(det.partial_cmp(&0.0), Some(std::cmp::Ordering::Greater)) {
        return FOLDED;
    }
    let p = dot4(m, times(sight.sum, m));
    let q = dot4(m, times(sight.inverse, m));
    (p + q / (det * det)) * 0.25
}

/// The corners of the triangle at an entry of the fans, the centre of the fan put to `centre`.
fn corners_of(moving: &Moving, entry: u32, centre: Lanes) -> [Lanes; 3] {
    let [a, b, c, _] = moving.triangles[(entry / 4) as usize];
    let mut corners = [a, b, c].map(|v| moving.positions[v as usize]);
    corners[(entry % 4) as usize] = centre;
    corners
}

fn fan_energy(moving: &Moving, fan: &[u32], centre: Lanes) -> f32 {
    let mut sum = 0.0;
    for &entry in fan {
        let [a, b, c] = corners_of(moving, entry, centre);
        sum += energy_of(&moving.sights[(entry / 4) as usize], between(a, b), between(a, c));
    }
    sum
}

/// Gradient and second derivative (xx, xy, yy) of a triangle's energy by the corner whose weights of the columns are `by`.
fn slope_of(sight: &Sight, u: Vec2, w: Vec2, by: Vec2) -> (Vec2, [f32; 3]) {
    let m = map_of(sight.rest, u, w);
    let det = m[0] * m[3] - m[1] * m[2];
    let d2 = det * det;
    let pm = times(sight.sum, m);
    let qm = times(sight.inverse, m);
    let q = dot4(m, qm);
    // What P m, Q m and the cofactor of m make of the weights.
    let p = [pm[0] * by[0] + pm[2] * by[1], pm[1] * by[0] + pm[3] * by[1]];
    let a = [qm[0] * by[0] + qm[2] * by[1], qm[1] * by[0] + qm[3] * by[1]];
    let g = [m[3] * by[0] - m[1] * by[1], m[0] * by[1] - m[2] * by[0]];
    let along = 0.5 / d2;
    let across = 0.5 * (q / (d2 * det));
    let square = by[0] * by[0] + by[1] * by[1];
    let cross = 1.0 / (d2 * det);
    let push = 2.0 * (q / (d2 * d2));
    let gradient = [(0.5 * p[0] + along * a[0]) - across * g[0], (0.5 * p[1] + along * a[1]) - across * g[1]];
    let same = |k: usize| (0.5 * sight.sum[k] + along * sight.inverse[k]) * square;
    let hessian = [
        (same(0) - cross * (2.0 * a[0] * g[0])) + push * (g[0] * g[0]),
        (same(1) - cross * (a[0] * g[1] + g[0] * a[1])) + push * (g[0] * g[1]),
        (same(2) - cross * (2.0 * a[1] * g[1])) + push * (g[1] * g[1]),
    ];
    (gradient, hessian)
}

/// How much each corner has of the columns of the map.
fn weights_of(rest: [f32; 4], corner: u32) -> Vec2 {
    match corner {
        1 => [rest[0], rest[2]],
        2 => [rest[1], rest[3]],
        _ => [-(rest[0] + rest[1]), -(rest[2] + rest[3])],
    }
}

/// The Newton step of the energy of a fan; zero where there is none.
fn newton(moving: &Moving, fan: &[u32], centre: Lanes) -> Vec2 {
    let (mut gradient, mut hessian) = ([0.0; 2], [0.0; 3]);
    for &entry in fan {
        let [a, b, c] = corners_of(moving, entry, centre);
        let sight = &moving.sights[(entry / 4) as usize];
        let slope = slope_of(sight, between(a, b), between(a, c), weights_of(sight.rest, entry % 4));
        gradient = [gradient[0] + slope.0[0], gradient[1] + slope.0[1]];
        hessian = [hessian[0] + slope.1[0], hessian[1] + slope.1[1], hessian[2] + slope.1[2]];
    }
    let [xx, xy, yy] = hessian;
    let det = xx * yy - xy * xy;
    // Also false for NaN.
    if det > 0.0 {
        [(xy * gradient[1] - yy * gradient[0]) / det, (xy * gradient[0] - xx * gradient[1]) / det]
    } else {
        [0.0; 2]
    }
}

/// The share of the step that is safe: less than the way to the first triangle that collapses, and no more than all.
fn safe_share(moving: &Moving, fan: &[u32], centre: Lanes, step: Vec2) -> f32 {
    let mut share = 1.0f32;
    for &entry in fan {
        let c = corners_of(moving, entry, centre);
        let [next, last] = [1, 2].map(|k| c[(entry % 4 + k) as usize % 3]);
        let (u, w, side) = (between(centre, next), between(centre, last), between(next, last));
        let area = u[0] * w[1] - u[1] * w[0];
        let loss = step[0] * side[1] - step[1] * side[0];
        if loss > 0.0 {
            share = share.min(SAFE_SHARE * (area / loss));
        }
    }
    share
}
