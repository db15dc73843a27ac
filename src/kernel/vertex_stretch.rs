//! Stretch at every vertex: the area-weighted mean of the L2 stretch of its triangles.
//!
//! Yoshizawa, Belyaev, Seidel: A fast and simple stretch-minimizing mesh parameterization (2004), section 2. Areas are
//! those of the image, that is of the surface when the map leads from the plane to it.

use rayon::prelude::*;

use crate::error::Result;
use crate::gpu::{Access, Compute, GpuBuffer, GpuDevice, Kernel, Launch};

use super::rings::Lists;
use super::stretch::Stretch;
use super::{GRAIN, check_indices};

/// `kernels/vertex_stretch.wgsl`.
pub const KERNEL: Kernel = Kernel {
    name: "vertex_stretch",
    source: include_str!("../../kernels/vertex_stretch.wgsl"),
    buffers: &[Access::Read, Access::Read, Access::Read, Access::ReadWrite],
};

/// A vertex stretch is kept in `MIN_SIGMA..=MAX_SIGMA`, so that weights divided by it stay positive and finite.
pub const MIN_SIGMA: f32 = 1e-12;
/// See [`MIN_SIGMA`].
pub const MAX_SIGMA: f32 = 1e12;

/// Mean L2 stretch over the triangles `incident.of(v)` of every vertex `v`; 1 for a vertex without usable triangles.
///
/// Fails when a list names a triangle that does not exist, or on a device error.
pub fn vertex_stretch(compute: &Compute, incident: &Lists, stretches: &[Stretch]) -> Result<Vec<f32>> {
    check_indices("incident triangle", &incident.items, stretches.len())?;
    let gpu = match compute {
        Compute::Cpu => return Ok(reference(incident, stretches)),
        Compute::Gpu(gpu) => gpu,
    };
    let sigma = gpu.allocate("sigma", incident.len())?;
    let starts = gpu.upload("starts", &incident.starts)?;
    let items = gpu.upload("incident", &incident.items)?;
    let stretches = gpu.upload("stretches", stretches)?;
    gpu.submit([&launch(gpu, &starts, &items, &stretches, &sigma)])?;
    gpu.download(&sigma)
}

/// Binds the kernel to its buffers.
pub(super) fn launch(
    gpu: &GpuDevice,
    starts: &GpuBuffer<u32>,
    incident: &GpuBuffer<u32>,
    stretches: &GpuBuffer<Stretch>,
    sigma: &GpuBuffer<f32>,
) -> Launch {
    gpu.launch(&KERNEL, 0..sigma.len() as u32, |span| span, &[starts, incident, stretches, sigma])
}

/// The CPU twin: `stretches` holds every triangle that `incident` names.
pub fn reference(incident: &Lists, stretches: &[Stretch]) -> Vec<f32> {
    (0..incident.len()).into_par_iter().with_min_len(GRAIN).map(|v| of_vertex(incident.of(v), stretches)).collect()
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
    if area > 0.0 { (weighted / area).max(MIN_SIGMA).min(MAX_SIGMA) } else { 1.0 }
}
