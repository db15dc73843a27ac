//! Structs and constants shared with WGSL: what naga makes of the kernels must be what Rust has.

use std::mem::offset_of;

use homeo::gpu::{Kernel, Span};
use homeo::kernel::relax::RelaxParams;
use homeo::kernel::sweep::SweepParams;
use homeo::kernel::texels::TexelParams;
use homeo::kernel::vertex_stretch::VertexStretchParams;
use homeo::kernel::{
    ALL, FlatTriangle, Query, Sight, Stretch, Texel, relax, resample, stretch, sweep, texels, vertex_stretch,
};

fn parse(kernel: &Kernel) -> naga::Module {
    naga::front::wgsl::parse_str(&kernel.module()).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&kernel.module())))
}

/// Name and offset of every member, and the size, of a struct in the kernel's module.
fn in_wgsl(kernel: &Kernel, name: &str) -> (Vec<(String, usize)>, usize) {
    let module = parse(kernel);
    let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
    let (_, ty) = found.unwrap_or_else(|| panic!("{} has no struct {name}", kernel.name));
    let naga::TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is not a struct") };
    (members.iter().map(|m| (m.name.clone().unwrap(), m.offset as usize)).collect(), *span as usize)
}

macro_rules! assert_layout {
    ($kernel:expr, $name:ident { $($member:ident),* }) => {
        let members = vec![$((stringify!($member).to_owned(), offset_of!($name, $member))),*];
        assert_eq!(in_wgsl(&$kernel, stringify!($name)), (members, size_of::<$name>()));
    };
}

#[test]
fn structs_have_the_same_layout() {
    for kernel in ALL {
        assert_layout!(kernel, Span { first, count });
        assert_layout!(kernel, Stretch { large, small, area_from, area_to });
        let corners = ["a", "b", "c"].iter().enumerate().map(|(i, name)| ((*name).to_owned(), i * size_of::<u32>()));
        assert_eq!(in_wgsl(kernel, "Triangle"), (corners.collect(), size_of::<[u32; 3]>()));
    }
    assert_layout!(relax::KERNEL, RelaxParams { first, count, step, unused });
    assert_layout!(vertex_stretch::KERNEL, VertexStretchParams { first, count, power, unused });
    assert_layout!(sweep::KERNEL, SweepParams { first, count });
    assert_layout!(sweep::KERNEL, Sight { rest, sum, inverse });
    assert_layout!(texels::KERNEL, TexelParams { first, count, width, unused });
    assert_layout!(texels::KERNEL, FlatTriangle { ax, ay, bx, by, cx, cy });
    assert_layout!(texels::KERNEL, Texel { triangle, covers, w1, w2 });
    assert_layout!(resample::KERNEL, Query { i0, i1, i2, w0, w1, w2 });
}

/// The constant's value as f64, whatever its type.
fn constant(kernel: &Kernel, name: &str) -> f64 {
    let module = parse(kernel);
    let found = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name));
    let (_, constant) = found.unwrap_or_else(|| panic!("{} has no constant {name}", kernel.name));
    match module.global_expressions[constant.init] {
        naga::Expression::Literal(naga::Literal::F32(value)) => value.into(),
        naga::Expression::Literal(naga::Literal::U32(value)) => value.into(),
        ref other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn constants_have_the_same_value() {
    assert_eq!(constant(&stretch::KERNEL, "MIN_LENGTH"), f64::from(stretch::MIN_LENGTH));
    assert_eq!(constant(&stretch::KERNEL, "MAX_LENGTH"), f64::from(stretch::MAX_LENGTH));
    assert_eq!(constant(&stretch::KERNEL, "MIN_DOUBLE_AREA"), f64::from(stretch::MIN_DOUBLE_AREA));
    assert_eq!(constant(&stretch::KERNEL, "MIN_SQUARE"), f64::from(stretch::MIN_SQUARE));
    assert_eq!(constant(&vertex_stretch::KERNEL, "MIN_MEAN"), f64::from(vertex_stretch::MIN_MEAN));
    assert_eq!(constant(&vertex_stretch::KERNEL, "MAX_MEAN"), f64::from(vertex_stretch::MAX_MEAN));
    assert_eq!(constant(&relax::KERNEL, "TRIES"), f64::from(relax::TRIES));
    assert_eq!(constant(&relax::KERNEL, "MIN_SHARE"), f64::from(relax::MIN_SHARE));
    assert_eq!(constant(&relax::KERNEL, "AREA_ERROR"), f64::from(relax::AREA_ERROR));
    assert_eq!(constant(&relax::KERNEL, "AREA_UNDERFLOW"), f64::from(relax::AREA_UNDERFLOW));
    assert_eq!(constant(&sweep::KERNEL, "SAFE_SHARE"), f64::from(sweep::SAFE_SHARE));
    assert_eq!(constant(&sweep::KERNEL, "TRIES"), f64::from(sweep::TRIES));
    assert_eq!(constant(&sweep::KERNEL, "FOLDED"), f64::from(sweep::FOLDED));
    assert_eq!(constant(&texels::KERNEL, "CELL"), f64::from(texels::CELL));
    assert_eq!(constant(&texels::KERNEL, "NO_TRIANGLE"), f64::from(texels::NO_TRIANGLE));
}
