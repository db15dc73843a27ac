//! Kernels and how they are launched: pipelines compiled once, ranges split to what one dispatch may cover.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, MutexGuard};

use bytemuck::{Pod, Zeroable};

use crate::error::Result;

use super::buffer::GpuBuffer;
use super::device::GpuDevice;

/// Invocations in a workgroup; every kernel file declares the same number.
pub const WORKGROUP: u32 = 64;

/// Structs shared by several kernels, put before each kernel's source.
const SHARED: &str = include_str!("../../kernels/structs.wgsl");

/// How a kernel uses a storage buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// `var<storage, read>`.
    Read,
    /// `var<storage, read_write>`.
    ReadWrite,
}

/// A compute kernel: binding 0 is its uniform parameters, bindings 1.. its storage buffers in order.
#[derive(Debug)]
pub struct Kernel {
    /// File name without ending, and the entry point.
    pub name: &'static str,
    /// The text of `kernels/NAME.wgsl`.
    pub source: &'static str,
    /// Access of the storage buffers at bindings 1, 2, ...
    pub buffers: &'static [Access],
}

impl Kernel {
    /// The complete WGSL module: shared structs, then the kernel.
    pub fn module(&self) -> String {
        format!("{SHARED}\n{}", self.source)
    }
}

/// The elements one dispatch covers; parameters of kernels that need no others.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct Span {
    /// The first element.
    pub first: u32,
    /// Number of elements.
    pub count: u32,
}

/// Cuts `range` into spans of at most `max_workgroups` workgroups each, in order and without gaps.
pub fn spans(range: Range<u32>, max_workgroups: u32) -> impl Iterator<Item = Span> {
    let most = max_workgroups.saturating_mul(WORKGROUP).max(1);
    let starts = range.clone().step_by(most as usize);
    starts.map(move |first| Span { first, count: most.min(range.end - first) })
}

/// A compiled kernel.
#[derive(Debug)]
pub(super) struct Pipeline {
    groups: wgpu::BindGroupLayout,
    compute: wgpu::ComputePipeline,
}

/// A kernel bound to its buffers and ready to run as often as wanted.
pub struct Launch {
    pipeline: Arc<Pipeline>,
    dispatches: Vec<(wgpu::BindGroup, u32)>,
}

impl GpuDevice {
    /// Binds `kernel` to `buffers` for the elements in `range`; `params` makes the uniform of each dispatch.
    pub fn launch<P: Pod>(
        &self,
        kernel: &'static Kernel,
        range: Range<u32>,
        params: impl Fn(Span) -> P,
        buffers: &[&dyn Bindable],
    ) -> Launch {
        let pipeline = self.pipeline(kernel);
        let dispatches = spans(range, self.limits.max_compute_workgroups_per_dimension)
            .map(|span| {
                let uniform = self.uniform(&params(span));
                let group = self.bind(kernel.name, &pipeline, &uniform, buffers);
                (group, span.count.div_ceil(WORKGROUP))
            })
            .collect();
        Launch { pipeline, dispatches }
    }

    fn bind(
        &self,
        name: &str,
        pipeline: &Pipeline,
        uniform: &wgpu::Buffer,
        buffers: &[&dyn Bindable],
    ) -> wgpu::BindGroup {
        let bound = std::iter::once(uniform).chain(buffers.iter().map(|buffer| buffer.raw()));
        let entries: Vec<_> = bound
            .enumerate()
            .map(|(i, buffer)| wgpu::BindGroupEntry { binding: i as u32, resource: buffer.as_entire_binding() })
            .collect();
        let descriptor = wgpu::BindGroupDescriptor { label: Some(name), layout: &pipeline.groups, entries: &entries };
        self.device.create_bind_group(&descriptor)
    }

    /// Elements of type `T` that one storage buffer can hold, and few enough that one dispatch covers them: the piece
    /// in which to send long lists through a kernel.
    pub fn stream_len<T>(&self) -> usize {
        let most = u64::from(self.limits.max_compute_workgroups_per_dimension) * u64::from(WORKGROUP);
        let bytes = self.limits.max_storage_buffer_binding_size.min(self.limits.max_buffer_size);
        (bytes / size_of::<T>() as u64).min(most) as usize
    }

    /// Runs launches one after the other, each seeing what those before it wrote, without waiting for the last.
    pub fn submit<'a>(&self, launches: impl IntoIterator<Item = &'a Launch>) -> Result<()> {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for launch in launches {
            pass.set_pipeline(&launch.pipeline.compute);
            for (group, workgroups) in &launch.dispatches {
                pass.set_bind_group(0, group, &[]);
                pass.dispatch_workgroups(*workgroups, 1, 1);
            }
        }
        drop(pass);
        self.queue.submit([encoder.finish()]);
        self.check()
    }

    /// The compiled kernel, from the cache after the first time.
    fn pipeline(&self, kernel: &'static Kernel) -> Arc<Pipeline> {
        let mut cache: MutexGuard<'_, HashMap<_, _>> =
            self.pipelines.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        cache.entry(kernel.name).or_insert_with(|| Arc::new(self.compile(kernel))).clone()
    }

    /// The layout is explicit: an automatic one would drop bindings the kernel happens not to use.
    fn compile(&self, kernel: &Kernel) -> Pipeline {
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(kernel.name),
            source: wgpu::ShaderSource::Wgsl(kernel.module().into()),
        });
        let storage = kernel.buffers.iter().map(|access| match access {
            Access::Read => wgpu::BufferBindingType::Storage { read_only: true },
            Access::ReadWrite => wgpu::BufferBindingType::Storage { read_only: false },
        });
        let types = std::iter::once(wgpu::BufferBindingType::Uniform).chain(storage);
        let entries: Vec<_> = types.enumerate().map(|(i, ty)| binding(i as u32, ty)).collect();
        let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(kernel.name), entries: &entries };
        let groups = self.device.create_bind_group_layout(&descriptor);
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(kernel.name),
            bind_group_layouts: &[Some(&groups)],
            immediate_size: 0,
        });
        let compute = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(kernel.name),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(kernel.name),
            compilation_options: Default::default(),
            cache: None,
        });
        Pipeline { groups, compute }
    }
}

fn binding(binding: u32, ty: wgpu::BufferBindingType) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}

/// A buffer of any element type, as [`GpuDevice::launch`] binds it.
pub trait Bindable: sealed::Raw {}

impl<T> Bindable for GpuBuffer<T> {}

mod sealed {
    use super::GpuBuffer;

    /// Keeps wgpu's type out of the public interface.
    pub trait Raw {
        #[doc(hidden)]
        fn raw(&self) -> &wgpu::Buffer;
    }

    impl<T> Raw for GpuBuffer<T> {
        fn raw(&self) -> &wgpu::Buffer {
            &self.raw
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_cover_the_range_once_and_stay_within_the_limit() {
        for (range, workgroups) in [(0..0, 3), (0..1, 3), (5..197, 3), (0..192, 3), (7..1_000_003, 100)] {
            let mut next = range.start;
            for span in spans(range.clone(), workgroups) {
                assert_eq!(span.first, next);
                assert!((1..=workgroups * WORKGROUP).contains(&span.count), "{span:?}");
                next += span.count;
            }
            assert_eq!(next, range.end);
        }
    }
}
