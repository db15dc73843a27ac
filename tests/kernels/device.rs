//! The door to the device: what it opens, what it refuses, and that nothing behind it panics.

use homeo::ErrorKind;
use homeo::gpu::{Access, Compute, Device, DeviceChoice, Kernel, Span, adapters};

use crate::support::device;

#[test]
fn the_cpu_is_always_there() {
    let device = Device::open(&DeviceChoice::Cpu).unwrap();
    assert!(matches!(device.compute, Compute::Cpu) && device.note.is_none());
    assert!(device.description.starts_with("CPU ("), "{}", device.description);
}

#[test]
fn an_adapter_opens_by_its_name_and_a_wrong_name_is_a_device_error() {
    let error = Device::open(&DeviceChoice::Named("no such adapter".into())).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Device);
    for adapter in adapters() {
        let opened = Device::open(&DeviceChoice::Named(adapter.name.to_uppercase())).unwrap();
        assert!(opened.description.contains(&adapter.name), "{}", opened.description);
    }
}

#[test]
fn auto_never_takes_a_software_adapter() {
    let hardware = adapters().iter().any(|adapter| !adapter.kind.is_software());
    let required = std::env::var(homeo::gpu::REQUIRE_GPU).is_ok_and(|v| v == "1");
    match Device::open(&DeviceChoice::Auto) {
        Ok(device) => match device.compute {
            Compute::Gpu(gpu) => assert!(!gpu.info().kind.is_software()),
            Compute::Cpu => assert!(!hardware && device.note.is_some()),
        },
        Err(error) => assert!(required && error.kind == ErrorKind::Device, "{error}"),
    }
}

#[test]
fn buffers_come_back_as_they_went_whatever_their_length() {
    let Some((Compute::Gpu(gpu), _)) = device() else { return };
    for len in [0, 1, 2, 3, 4, 5, 63, 1001] {
        let data: Vec<[u32; 3]> = (0..len).map(|i| [i, 2 * i, !i]).collect();
        let buffer = gpu.upload("data", &data).unwrap();
        assert!(buffer.size().is_multiple_of(16) && buffer.size() >= 16 && buffer.len() == data.len());
        assert_eq!(gpu.download(&buffer).unwrap(), data);
        assert_eq!(gpu.download(&gpu.allocate::<f32>("zeros", data.len()).unwrap()).unwrap(), vec![0.0; data.len()]);
    }
    let buffer = gpu.upload("data", &[1u32, 2, 3]).unwrap();
    assert_eq!(gpu.write(&buffer, &[1, 2]).unwrap_err().kind, ErrorKind::Bug);
}

#[test]
fn too_much_for_the_device_is_a_device_error() {
    let Some((Compute::Gpu(gpu), _)) = device() else { return };
    let Err(error) = gpu.allocate::<[f32; 4]>("everything", 1 << 50) else { panic!("2^54 bytes were granted") };
    assert_eq!(error.kind, ErrorKind::Device);
    assert!(error.what.contains("everything") && error.remedy.contains("cpu"), "{error}");
}

#[test]
fn what_the_driver_objects_to_comes_back_as_an_error() {
    const BROKEN: Kernel = Kernel { name: "broken", source: "fn broken( {", buffers: &[Access::ReadWrite] };
    const UNBOUND: Kernel = Kernel {
        name: "unbound",
        source: "@group(0) @binding(7) var<storage, read_write> nothing: array<u32>;
                 @compute @workgroup_size(64) fn unbound() { nothing[0] = 1u; }",
        buffers: &[Access::ReadWrite],
    };
    let Some((Compute::Gpu(gpu), _)) = device() else { return };
    let buffer = gpu.upload("data", &[1u32]).unwrap();
    for kernel in [&BROKEN, &UNBOUND] {
        let launch = gpu.launch(kernel, 0..1, |span: Span| span, &[&buffer]);
        let error = gpu.submit([&launch]).unwrap_err();
        assert!(error.kind == ErrorKind::Bug && error.what.contains(kernel.name), "{error}");
    }
    assert_eq!(gpu.download(&buffer).unwrap(), [1], "the device works on after an error");
}
