//! One colour of a Gauss-Seidel pass of stretch-minimising relaxation.
//!
//! Yoshizawa, Belyaev, Seidel: A fast and simple stretch-minimizing mesh parameterization (2004): a vertex belongs at
//! the mean of its ring weighted by `weight / sigma`, with `sigma` the stretch at the neighbour. The step towards it is
//! halved until every triangle of the ring keeps a safe area; the error bound is that of Shewchuk: Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates (1997), section 4.2. It holds for the stored f32
//! positions, so a valid embedding stays one exactly, on any device.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use crate::error::Result;
use crate::gpu::{Access, Compute, GpuBuffer, GpuDevice, Kernel, Launch};

use super::rings::Rings;
use super::{GRAIN, Lanes, check_indices, check_len};

/// `kernels/relax.wgsl`.
pub const KERNEL: Kernel = Kernel {
    name: "relax",
    source: include_str!("../../kernels/relax.wgsl"),
    buffers: &[Access::Read, Access::Read, Access::Read, Access::Read, Access::Read, Access::ReadWrite],
};

/// How often a step is halved before the vertex stays where it is: down to 1/64 of the full step.
pub const TRIES: u32 = 7;
/// The least share of the area of a vertex's ring that a step may leave to one triangle; without it, triangles of a
/// ring that stretch drives to one side shrink from sweep to sweep until no step is possible.
pub const MIN_SHARE: f32 = 1e-5;
/// Bound of the rounding error of a doubled triangle area, relative to the sum of its two products: Shewchuk's
/// `(3 + 16 u) u` with `u = 2^-24` is 1.8e-7. Above it the exact area of the rounded corners is positive.
pub const AREA_ERROR: f32 = 2.5e-7;
/// What products that underflow may lose of a doubled area.
pub const AREA_UNDERFLOW: f32 = 1e-30;

/// Parameters of one dispatch.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct RelaxParams {
    /// The first entry of the list of vertices.
    pub first: u32,
    /// Number of entries.
    pub count: u32,
    /// Length of the first step tried: 1 goes to the mean itself, more than 1 over-relaxes.
    pub step: f32,
    /// Keeps the size a multiple of 16 bytes.
    pub unused: u32,
}

/// Moves `vertices`, no two of which share an edge, and returns all positions.
///
/// `weights` runs parallel to the entries of `rings`, `sigma` and `positions` to the vertices. A vertex whose ring is
/// empty stays. Fails when an index is out of range or the lengths disagree, or on a device error.
pub fn relax(
    compute: &Compute,
    vertices: &[u32],
    rings: &Rings,
    weights: &[f32],
    sigma: &[f32],
    positions: &[Lanes],
    step: f32,
) -> Result<Vec<Lanes>> {
    check_indices("vertex to relax", vertices, positions.len())?;
    check_lengths(rings, weights, positions)?;
    check_len("vertex stretches", sigma.len(), positions.len())?;
    let gpu = match compute {
        Compute::Cpu => {
            let mut moved = positions.to_vec();
            reference(vertices, rings, weights, sigma, &mut moved, step);
            return Ok(moved);
        }
        Compute::Gpu(gpu) => gpu,
    };
    let buffers = RelaxBuffers {
        vertices: gpu.upload("vertices", vertices)?,
        ring_starts: gpu.upload("ring_starts", &rings.lists().starts)?,
        rings: gpu.upload("rings", &rings.lists().items)?,
        weights: gpu.upload("weights", weights)?,
        sigma: gpu.upload("sigma", sigma)?,
        positions: gpu.upload("positions", positions)?,
    };
    gpu.submit([&launch(gpu, 0..vertices.len() as u32, step, &buffers)])?;
    gpu.download(&buffers.positions)
}

/// Rings, weights and positions must speak of the same vertices.
pub(super) fn check_lengths(rings: &Rings, weights: &[f32], positions: &[Lanes]) -> Result<()> {
    check_len("rings", rings.lists().len(), positions.len())?;
    check_len("ring weights", weights.len(), rings.lists().items.len())
}

/// The kernel's buffers in binding order.
pub(super) struct RelaxBuffers {
    pub vertices: GpuBuffer<u32>,
    pub ring_starts: GpuBuffer<u32>,
    pub rings: GpuBuffer<u32>,
    pub weights: GpuBuffer<f32>,
    pub sigma: GpuBuffer<f32>,
    pub positions: GpuBuffer<Lanes>,
}

/// Binds the kernel to its buffers for the vertices at `range` of their list.
pub(super) fn launch(gpu: &GpuDevice, range: std::ops::Range<u32>, step: f32, buffers: &RelaxBuffers) -> Launch {
    let b = buffers;
    gpu.launch(
        &KERNEL,
        range,
        |span| RelaxParams { first: span.first, count: span.count, step, unused: 0 },
        &[&b.vertices, &b.ring_starts, &b.rings, &b.weights, &b.sigma, &b.positions],
    )
}

/// The CPU twin; moved positions are written after all are computed, which a proper colouring makes no difference to.
pub fn reference(vertices: &[u32], rings: &Rings, weights: &[f32], sigma: &[f32], positions: &mut [Lanes], step: f32) {
    let at_rest: &[Lanes] = positions;
    let moved: Vec<Lanes> = vertices
        .par_iter()
        .with_min_len(GRAIN)
        .map(|&v| {
            let v = v as usize;
            relaxed(at_rest[v], rings.of(v), &weights[rings.lists().range(v)], sigma, at_rest, step)
        })
        .collect();
    for (&v, p) in vertices.iter().zip(moved) {
        positions[v as usize] = p;
    }
}

/// Where the vertex at `centre` goes.
fn relaxed(centre: Lanes, ring: &[u32], weights: &[f32], sigma: &[f32], positions: &[Lanes], step: f32) -> Lanes {
    if ring.is_empty() {
        return centre;
    }
    let p = [centre[0], centre[1]];
    let move_by = displacement(ring, weights, sigma, positions, p);
    let least = (MIN_SHARE * ring_area(ring, positions, p)).max(0.0);
    let mut step = step;
    for _ in 0..TRIES {
        let candidate = [p[0] + step * move_by[0], p[1] + step * move_by[1]];
        if ring_holds(ring, positions, candidate, least) {
            return [candidate[0], candidate[1], 0.0, 0.0];
        }
        step *= 0.5;
    }
    centre
}

type Vec2 = [f32; 2];

fn at(positions: &[Lanes], v: u32) -> Vec2 {
    let p = positions[v as usize];
    [p[0], p[1]]
}

/// Towards the weighted mean of the ring, seen from `p`.
fn displacement(ring: &[u32], weights: &[f32], sigma: &[f32], positions: &[Lanes], p: Vec2) -> Vec2 {
    let mut sum = [0.0, 0.0];
    let mut total = 0.0;
    for (&v, weight) in ring.iter().zip(weights) {
        let weight = weight / sigma[v as usize];
        let q = at(positions, v);
        sum = [sum[0] + weight * (q[0] - p[0]), sum[1] + weight * (q[1] - p[1])];
        total += weight;
    }
    // Also false for NaN.
    if total > 0.0 { [sum[0] / total, sum[1] / total] } else { [0.0, 0.0] }
}

/// The two products whose difference is twice the area of triangle `(p, q, r)`.
fn area_products(p: Vec2, q: Vec2, r: Vec2) -> Vec2 {
    [(q[0] - p[0]) * (r[1] - p[1]), (q[1] - p[1]) * (r[0] - p[0])]
}

/// The triangles of the ring around `p`, each as its [`area_products`]; the first is the one that closes the ring.
fn ring_triangles<'a>(ring: &'a [u32], positions: &'a [Lanes], p: Vec2) -> impl Iterator<Item = Vec2> + 'a {
    let tails = ring.last().into_iter().chain(ring);
    tails.zip(ring).map(move |(&q, &r)| area_products(p, at(positions, q), at(positions, r)))
}

/// Twice the area inside the ring.
fn ring_area(ring: &[u32], positions: &[Lanes], p: Vec2) -> f32 {
    let mut sum = 0.0;
    for [x, y] in ring_triangles(ring, positions, p) {
        sum += x - y;
    }
    sum
}

/// Whether every triangle of the ring, with its centre at `p`, has more than `least` as its doubled area.
fn ring_holds(ring: &[u32], positions: &[Lanes], p: Vec2, least: f32) -> bool {
    ring_triangles(ring, positions, p).all(|[x, y]| x - y > least + (AREA_ERROR * (x.abs() + y.abs()) + AREA_UNDERFLOW))
}
