//! Barycentric resampling of a vertex attribute.

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use crate::error::Result;
use crate::gpu::{Access, Compute, GpuDevice, Kernel};

use super::{GRAIN, Lanes, check_indices};

/// `kernels/resample.wgsl`.
pub const KERNEL: Kernel = Kernel {
    name: "resample",
    source: include_str!("../../kernels/resample.wgsl"),
    buffers: &[Access::Read, Access::Read, Access::ReadWrite],
};

/// Three vertices and their barycentric weights, which sum to one.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Query {
    /// The first vertex.
    pub i0: u32,
    /// The second vertex.
    pub i1: u32,
    /// The third vertex.
    pub i2: u32,
    /// Weight of the first vertex.
    pub w0: f32,
    /// Weight of the second vertex.
    pub w1: f32,
    /// Weight of the third vertex.
    pub w2: f32,
}

/// `w0 values[i0] + w1 values[i1] + w2 values[i2]` for every query, in order.
///
/// Fails when a query names a vertex that does not exist, or on a device error.
pub fn resample(compute: &Compute, queries: &[Query], values: &[Lanes]) -> Result<Vec<Lanes>> {
    check_indices("query vertex", queries.iter().flat_map(|q| [&q.i0, &q.i1, &q.i2]), values.len())?;
    match compute {
        Compute::Cpu => Ok(reference(queries, values)),
        Compute::Gpu(gpu) => on_device(gpu, queries, values),
    }
}

/// Queries go through in pieces a device can bind at once, the values stay.
fn on_device(gpu: &GpuDevice, queries: &[Query], values: &[Lanes]) -> Result<Vec<Lanes>> {
    let values = gpu.upload("values", values)?;
    let mut result = Vec::with_capacity(queries.len());
    for piece in queries.chunks(gpu.stream_len::<Query>()) {
        let queries = gpu.upload("queries", piece)?;
        let samples = gpu.allocate::<Lanes>("samples", piece.len())?;
        let range = 0..piece.len() as u32;
        gpu.submit([&gpu.launch(&KERNEL, range, |span| span, &[&queries, &values, &samples])])?;
        result.extend(gpu.download(&samples)?);
    }
    Ok(result)
}

/// The CPU twin: `values` holds every vertex that `queries` name.
pub fn reference(queries: &[Query], values: &[Lanes]) -> Vec<Lanes> {
    let sample = |q: &Query| {
        let [a, b, c] = [q.i0, q.i1, q.i2].map(|i| values[i as usize]);
        [0, 1, 2, 3].map(|k| q.w0 * a[k] + q.w1 * b[k] + q.w2 * c[k])
    };
    queries.par_iter().with_min_len(GRAIN).map(sample).collect()
}
