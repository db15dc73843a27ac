//! One colour of a sweep over domains in which one mesh moves over another.
//!
//! Every vertex makes a Newton step of its own that lowers the symmetric Dirichlet energy of its triangles
//! ([`crate::solve::dirichlet`] has the formulas and says what of the second derivative is taken). The step goes at most a
//! share of the way to the first triangle that collapses and is halved until the energy of the ring falls. So the energy
//! never rises, and no triangle turns over. The CPU twin is [`super::sweep_lanes`].

use bytemuck::{Pod, Zeroable};
use glam::{DMat2, DVec2};

use crate::gpu::{Access, GpuBuffer, GpuDevice, Kernel, Launch};
use crate::solve::dirichlet::{Metrics, Rest};

use super::Lanes;
use super::rings::Lists;

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
