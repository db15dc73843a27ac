//! Compute devices: the only door to wgpu.
//!
//! ```text
//! DeviceChoice --select--> adapter --open--> Device { compute, description, note }
//!                                               |
//!                        Compute::Cpu  (the CPU twins)   Compute::Gpu(GpuDevice)
//!                                                           | upload, launch, submit, download
//! ```
//!
//! Nothing here panics: without a driver the list of adapters is empty, and whatever the driver objects to later is
//! recorded and comes back as an [`Error`](crate::Error) from the next [`GpuDevice::submit`] or
//! [`GpuDevice::download`].

mod buffer;
mod choice;
mod device;
mod dispatch;
mod gather;

pub use buffer::{GpuBuffer, padded_size};
pub use choice::{AdapterInfo, AdapterKind, DeviceChoice, Pick, REQUIRE_GPU, select};
pub use device::{Compute, Device, GpuDevice, adapters};
pub use dispatch::{Access, Bindable, Kernel, Launch, Span, WORKGROUP, spans};
pub use gather::Gather;
