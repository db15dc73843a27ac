//! Every kernel is valid WGSL and binds what its launch provides.

use homeo::gpu::{Access, Kernel, WORKGROUP};
use homeo::kernel::ALL;

/// Every file in `kernels/` is a kernel of the list, or the structs put before each.
#[test]
fn no_kernel_is_left_out() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels");
    let mut files: Vec<String> =
        folder.read_dir().unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    files.sort();
    let mut expected: Vec<String> = ALL.iter().map(|kernel| format!("{}.wgsl", kernel.name)).collect();
    expected.push("structs.wgsl".to_owned());
    expected.sort();
    assert_eq!(files, expected);
}

#[test]
fn kernels_are_valid_and_bind_what_they_declare() {
    for kernel in ALL {
        let source = kernel.module();
        let module = naga::front::wgsl::parse_str(&source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&source)));
        // No optional capability: that is what wgpu grants a device opened without features.
        let capabilities = naga::valid::Capabilities::empty();
        let mut validator = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities);
        validator.validate(&module).unwrap_or_else(|e| panic!("{}: {}", kernel.name, e.emit_to_string(&source)));
        assert_eq!(module.entry_points.len(), 1, "{}", kernel.name);
        assert_eq!(module.entry_points[0].name, kernel.name);
        assert_eq!(module.entry_points[0].workgroup_size, [WORKGROUP, 1, 1], "{}", kernel.name);
        assert_eq!(bindings(&module), expected_bindings(kernel), "{}", kernel.name);
    }
}

fn bindings(module: &naga::Module) -> Vec<(u32, Option<Access>)> {
    let globals = module.global_variables.iter().filter_map(|(_, g)| Some((g.binding?.binding, g.space)));
    let access = |space| match space {
        naga::AddressSpace::Uniform => None,
        naga::AddressSpace::Storage { access } if access.contains(naga::StorageAccess::STORE) => {
            Some(Access::ReadWrite)
        }
        naga::AddressSpace::Storage { .. } => Some(Access::Read),
        other => panic!("{other:?} has no place in a kernel"),
    };
    let mut bindings: Vec<_> = globals.map(|(binding, space)| (binding, access(space))).collect();
    bindings.sort_by_key(|&(binding, _)| binding);
    bindings
}

fn expected_bindings(kernel: &Kernel) -> Vec<(u32, Option<Access>)> {
    let storage = kernel.buffers.iter().map(|&access| Some(access));
    std::iter::once(None).chain(storage).enumerate().map(|(i, access)| (i as u32, access)).collect()
}
