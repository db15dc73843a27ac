//! Stretch at every vertex: the area-weighted mean of the L2 stretch of its triangles.
//!
//! Yoshizawa, Belyaev, Seidel: A fast and simple stretch-minimizing mesh parameterization (2004), section 2. Areas are
//! those of the image, that is of the surface when the map leads from the plane to it.
//!
//! The paper divides weights by the stretch and solves anew each time. Where stretch is measured after every sweep
//! instead, two things are better than the plain mean: a power of it, since each solve of the paper multiplies one more
//! stretch in, and the geometric mean with the last value, since a stiff patch answers a sweep by overshooting. On
//! graded and jittered hills the third power ends at or below the energy of the exact solves; without the averaging it
//! runs away.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::gpu::{Access, Compute, GpuBuffer, GpuDevice, Kernel, Launch, Span};

use super::rings::Lists;
use super::stretch::Stretch;
use super::{GRAIN, check_indices, check_len};

/// `kernels/vertex_stretch.wgsl`.
pub const KERNEL: Kernel = Kernel {
    name: "vertex_stretch",
    source: include_str!("../../kernels/vertex_stretch.wgsl"),
    buffers: &[Access::Read, Access::Read, Access::Read, Access::ReadWrite],
};

/// The mean is kept in `MIN_MEAN..=MAX_MEAN`, so that its powers, and weights divided by them, stay positive and
/// finite.
pub const MIN_MEAN: f32 = 1e-6;
/// See [`MIN_MEAN`].
pub const MAX_MEAN: f32 = 1e6;
/// The largest power: more would leave the range of f32 at the ends of the means' range.
pub const MAX_POWER: u32 = 3;

/// Parameters of one dispatch.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct VertexStretchParams {
    /// The first vertex.
    pub first: u32,
    /// Number of vertices.
    pub count: u32,
    /// 0: sigma becomes the mean. 1 to 3: sigma becomes the geometric mean of its old value and this power of the mean.
    pub power: u32,
    /// Keeps the size a multiple of 16 bytes.
    pub unused: u32,
}

/// Updates `sigma` from the triangles `incident.of(v)` of every vertex `v`; the mean is 1 without usable triangles.
///
/// With `power` 0 the result is the mean and does not depend on `sigma`; for the others (up to [`MAX_POWER`]) see
/// [`VertexStretchParams::power`]. Fails when a list names a triangle that does not exist, the lengths disagree or the
/// power is too large, or on a device error.
pub fn vertex_stretch(
    compute: &Compute,
    incident: &Lists,
    stretches: &[Stretch],
    sigma: &[f32],
    power: u32,
) -> Result<Vec<f32>> {
    check_indices("incident triangle", &incident.items, stretches.len())?;
    check_len("vertex stretches", sigma.len(), incident.len())?;
    check_power(power)?;
    let gpu = match compute {
        Compute::Cpu => return Ok(reference(incident, stretches, sigma, power)),
        Compute::Gpu(gpu) => gpu,
    };
    let sigma = gpu.upload("sigma", sigma)?;
    let starts = gpu.upload("starts", &incident.starts)?;
    let items = gpu.upload("incident", &incident.items)?;
    let stretches = gpu.upload("stretches", stretches)?;
    gpu.submit([&launch(gpu, power, &starts, &items, &stretches, &sigma)])?;
    gpu.download(&sigma)
}

/// Refuses powers above [`MAX_POWER`].
pub(super) fn check_power(power: u32) -> Result<()> {
    if power <= MAX_POWER {
        return Ok(());
    }
    Err(Error::bug(format!("vertex stretch to the power {power}; {MAX_POWER} is the largest")))
}

/// Binds the kernel to its buffers.
pub(super) fn launch(
    gpu: &GpuDevice,
    power: u32,
    starts: &GpuBuffer<u32>,
    incident: &GpuBuffer<u32>,
    stretches: &GpuBuffer<Stretch>,
    sigma: &GpuBuffer<f32>,
) -> Launch {
    let vertices: Range<u32> = 0..sigma.len() as u32;
    let params = |Span { first, count }| VertexStretchParams { first, count, power, unused: 0 };
    gpu.launch(&KERNEL, vertices, params, &[starts, incident, stretches, sigma])
}

/// The CPU twin: `stretches` holds every triangle that `incident` names, `sigma` runs parallel to `incident`.
pub fn reference(incident: &Lists, stretches: &[Stretch], sigma: &[f32], power: u32) -> Vec<f32> {
    let vertices = sigma.par_iter().enumerate().with_min_len(GRAIN);
    vertices.map(|(v, &old)| updated(old, of_vertex(incident.of(v), stretches), power)).collect()
}

fn updated(old: f32, mean: f32, power: u32) -> f32 {
    if power == 0 {
        return mean;
    }
    let mut product = old;
    for _ in 0..power {
        product *= mean;
    }
    product.sqrt()
}

fn of_vertex(incident: &[u32], stretches: &[Stretch]) -> f32 {
    let mut weighted = 0.0;
    let mut area = 0.0;
    for &f in incident {
        let s = stretches[f as usize];
        if s.large > 0.0 {
            let ratio = s.small / s.large;
            weighted += s.area_to * (s.large * (0.5 * (1.0 + ratio * ratio)).sqrt());
            area += s.area_to;
        }
    }
    if area > 0.0 { (weighted / area).clamp(MIN_MEAN, MAX_MEAN) } else { 1.0 }
}
