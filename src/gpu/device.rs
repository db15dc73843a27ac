//! Opening an adapter, and the errors it reports behind our back.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex};

use crate::error::{Error, Result};

use super::choice::{AdapterInfo, AdapterKind, DeviceChoice, Pick, REQUIRE_GPU, select};
use super::dispatch::Pipeline;
use super::gather::Gather;

/// Where kernels run.
#[derive(Debug)]
pub enum Compute {
    /// The CPU twins.
    Cpu,
    /// An adapter behind wgpu.
    Gpu(Box<GpuDevice>),
}

/// An opened device and what the report says about it.
#[derive(Debug)]
pub struct Device {
    /// Where kernels run.
    pub compute: Compute,
    /// One line: the adapter, or the CPU.
    pub description: String,
    /// Why the CPU twins run although an adapter might have been expected.
    pub note: Option<String>,
}

impl Device {
    /// Opens what `choice` asks for; see [`select`] for the rule.
    ///
    /// Fails with a device error (exit code 5) when an adapter is asked for, or required by `HOMEO_REQUIRE_GPU=1`, and
    /// cannot be had.
    pub fn open(choice: &DeviceChoice) -> Result<Device> {
        if *choice == DeviceChoice::Cpu {
            return Ok(Device::cpu(None));
        }
        let required = std::env::var(REQUIRE_GPU).is_ok_and(|value| value == "1");
        if *choice == DeviceChoice::Auto && !required && !hardware_is_possible() {
            return Ok(Device::cpu(Some("no graphics hardware found: computed on the CPU".to_owned())));
        }
        let adapters = enumerate();
        let infos: Vec<AdapterInfo> = adapters.iter().map(describe).collect();
        let i = match select(choice, &infos, required)? {
            Pick::Cpu(note) => return Ok(Device::cpu(note)),
            Pick::Adapter(i) => i,
        };
        match GpuDevice::open(&adapters[i], infos[i].clone()) {
            Ok(gpu) => {
                Ok(Device { description: infos[i].to_string(), compute: Compute::Gpu(Box::new(gpu)), note: None })
            }
            Err(error) if *choice == DeviceChoice::Auto && !required => {
                Ok(Device::cpu(Some(format!("{}: computed on the CPU", error.what))))
            }
            Err(error) => Err(error),
        }
    }

    fn cpu(note: Option<String>) -> Device {
        let description = format!("CPU ({} threads)", rayon::current_num_threads());
        Device { compute: Compute::Cpu, description, note }
    }
}

/// All adapters of the primary interfaces (Vulkan, Metal, DirectX 12), in the drivers' order; empty without a driver.
pub fn adapters() -> Vec<AdapterInfo> {
    enumerate().iter().map(describe).collect()
}

/// OpenGL is left out: its software drivers pose as adapters and lack what the kernels need.
fn enumerate() -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY;
    pollster::block_on(wgpu::Instance::new(descriptor).enumerate_adapters(wgpu::Backends::PRIMARY))
}

fn describe(adapter: &wgpu::Adapter) -> AdapterInfo {
    let info = adapter.get_info();
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
        wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
        wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
        wgpu::DeviceType::Other => AdapterKind::Unknown,
        wgpu::DeviceType::Cpu => AdapterKind::Software,
    };
    let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
    AdapterInfo { name: info.name, kind, backend: info.backend.to_string(), driver }
}

/// Beginnings of the names under which Linux shows hardware that Vulkan can drive, beside the render nodes in `dri`.
const HARDWARE: [&str; 7] = ["nvidia", "nvhost", "nvgpu", "dxg", "kgsl", "mali", "pvr"];

/// False where no driver needs to be asked: asking costs time, and software drivers print to stderr.
fn hardware_is_possible() -> bool {
    let names = |folder: &str| -> Option<Vec<String>> {
        let entries = std::fs::read_dir(folder).ok()?;
        Some(entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
    };
    let Some(devices) = names("/dev").filter(|_| cfg!(target_os = "linux")) else { return true };
    let has_node = devices.iter().any(|name| HARDWARE.iter().any(|start| name.starts_with(start)));
    has_node || names("/dev/dri").is_some_and(|nodes| nodes.iter().any(|name| name.starts_with("renderD")))
}

/// An opened adapter with its queue, its compiled kernels and the errors it has recorded.
pub struct GpuDevice {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) limits: wgpu::Limits,
    pub(super) pipelines: Mutex<HashMap<&'static str, Arc<Pipeline>>>,
    gathers: Mutex<HashMap<TypeId, Arc<dyn Any + Send + Sync>>>,
    info: AdapterInfo,
    faults: Arc<Mutex<Vec<Error>>>,
}

impl fmt::Debug for GpuDevice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GpuDevice").field("info", &self.info).finish_non_exhaustive()
    }
}

impl GpuDevice {
    fn open(adapter: &wgpu::Adapter, info: AdapterInfo) -> Result<GpuDevice> {
        let offered = adapter.limits();
        let limits = wgpu::Limits {
            max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
            max_buffer_size: offered.max_buffer_size,
            ..wgpu::Limits::default()
        };
        let descriptor =
            wgpu::DeviceDescriptor { label: Some("homeo"), required_limits: limits.clone(), ..Default::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
            Error::device(format!("{} cannot be opened: {error}", info.name)).remedy("run with --device cpu")
        })?;
        let faults = Arc::new(Mutex::new(Vec::new()));
        record_faults(&device, &faults);
        let (pipelines, gathers) = (Mutex::default(), Mutex::default());
        Ok(GpuDevice { device, queue, limits, pipelines, gathers, info, faults })
    }

    /// The adapter behind this device.
    pub fn info(&self) -> &AdapterInfo {
        &self.info
    }

    /// Where those meet on this device who bring in work of type `T`.
    pub fn gather<T: Send + 'static>(&self) -> Arc<Gather<T>> {
        let mut gathers = self.gathers.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let gather = gathers.entry(TypeId::of::<T>()).or_insert_with(|| Arc::new(Gather::<T>::default())).clone();
        gather.downcast().expect("it was made for this type just above")
    }

    /// The first error recorded since the last call, if any; later ones are usually its consequences.
    pub(super) fn check(&self) -> Result<()> {
        let recorded = std::mem::take(&mut *self.faults.lock().unwrap_or_else(|poisoned| poisoned.into_inner()));
        recorded.into_iter().next().map_or(Ok(()), Err)
    }
}

/// Keeps wgpu's own handlers, which panic, out of the way.
fn record_faults(device: &wgpu::Device, faults: &Arc<Mutex<Vec<Error>>>) {
    let push = |faults: &Mutex<Vec<Error>>, error| {
        faults.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push(error);
    };
    let (uncaptured, lost) = (faults.clone(), faults.clone());
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        let fault = match error {
            wgpu::Error::OutOfMemory { .. } => Error::device("the compute device is out of memory")
                .remedy("run with --device cpu, or on smaller meshes"),
            wgpu::Error::Validation { description, .. } => Error::bug(one_line(&description)),
            wgpu::Error::Internal { description, .. } => {
                Error::device(one_line(&description)).remedy("run with --device cpu")
            }
        };
        push(&uncaptured, fault);
    }));
    device.set_device_lost_callback(move |reason, message| {
        if reason != wgpu::DeviceLostReason::Destroyed {
            let what = format!("the compute device was lost: {}", one_line(&message));
            push(&lost, Error::device(what).remedy("run with --device cpu"));
        }
    });
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
