//! Stretch of every triangle under a piecewise affine map.
//!
//! Sander, Snyder, Gortler, Hoppe: Texture Mapping Progressive Meshes (2001), section 3: singular values of the map of
//! one triangle and its L2 stretch. The f64 twin for single triangles is [`crate::mesh::metric::singular_values`].

use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

use crate::error::Result;
use crate::gpu::{Access, Compute, GpuBuffer, GpuDevice, Kernel, Launch};

use super::{GRAIN, Lanes, check_indices, check_len};

/// `kernels/stretch.wgsl`.
pub const KERNEL: Kernel = Kernel {
    name: "stretch",
    source: include_str!("../../kernels/stretch.wgsl"),
    buffers: &[Access::Read, Access::Read, Access::Read, Access::ReadWrite],
};

/// Edges are measured in units of their triangle's longest component, and that unit must lie in
/// `MIN_LENGTH..=MAX_LENGTH`: beyond it, areas leave the range of f32.
pub const MIN_LENGTH: f32 = 1e-12;
/// See [`MIN_LENGTH`].
pub const MAX_LENGTH: f32 = 1e12;
/// Twice the area, in those units, below which a triangle has no height: coordinates of order one in f32 say nothing
/// about shorter heights, and squares of what is divided by it would leave the range of f32.
pub const MIN_DOUBLE_AREA: f32 = 1e-8;
/// Squares below this count as zero, so that devices which flush denormal numbers agree with those which do not.
pub const MIN_SQUARE: f32 = 1e-24;

/// How an affine map stretches one triangle.
///
/// `area_from = 0` marks a triangle without a usable area before; then `large = small = 0` as well. No member is ever
/// NaN or infinite as long as the positions are finite.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Stretch {
    /// The larger singular value.
    pub large: f32,
    /// The smaller singular value, not negative.
    pub small: f32,
    /// The triangle's area before the map.
    pub area_from: f32,
    /// The triangle's area after it.
    pub area_to: f32,
}

/// Stretch of the map that takes vertex `i` from `source[i]` to `image[i]` and is affine on each triangle.
///
/// Fails when a triangle has a corner that does not exist, or on a device error.
pub fn stretch(compute: &Compute, triangles: &[[u32; 3]], source: &[Lanes], image: &[Lanes]) -> Result<Vec<Stretch>> {
    check_len("image positions", image.len(), source.len())?;
    check_indices("triangle corner", triangles.as_flattened(), source.len())?;
    match compute {
        Compute::Cpu => Ok(reference(triangles, source, image)),
        Compute::Gpu(gpu) => on_device(gpu, triangles, source, image),
    }
}

/// Triangles go through in pieces a device can bind at once, vertices stay.
fn on_device(gpu: &GpuDevice, triangles: &[[u32; 3]], source: &[Lanes], image: &[Lanes]) -> Result<Vec<Stretch>> {
    let source = gpu.upload("source", source)?;
    let image = gpu.upload("image", image)?;
    let mut result = Vec::with_capacity(triangles.len());
    for piece in triangles.chunks(gpu.stream_len::<Stretch>()) {
        let triangles = gpu.upload("triangles", piece)?;
        let stretches = gpu.allocate("stretches", piece.len())?;
        gpu.submit([&launch(gpu, &triangles, &source, &image, &stretches)])?;
        result.extend(gpu.download(&stretches)?);
    }
    Ok(result)
}

/// Binds the kernel to its buffers.
pub(super) fn launch(
    gpu: &GpuDevice,
    triangles: &GpuBuffer<[u32; 3]>,
    source: &GpuBuffer<Lanes>,
    image: &GpuBuffer<Lanes>,
    stretches: &GpuBuffer<Stretch>,
) -> Launch {
    gpu.launch(&KERNEL, 0..triangles.len() as u32, |span| span, &[triangles, source, image, stretches])
}

/// The CPU twin: `source` and `image` hold every corner of `triangles`.
pub fn reference(triangles: &[[u32; 3]], source: &[Lanes], image: &[Lanes]) -> Vec<Stretch> {
    let corners = |positions: &[Lanes], t: &[u32; 3]| t.map(|v| positions[v as usize]);
    triangles.par_iter().with_min_len(GRAIN).map(|t| of_triangle(corners(source, t), corners(image, t))).collect()
}

fn of_triangle(source: [Lanes; 3], image: [Lanes; 3]) -> Stretch {
    let (u, w) = (edge(source[0], source[1]), edge(source[0], source[2]));
    let (p, q) = (edge(image[0], image[1]), edge(image[0], image[2]));
    let unit = longest(u, w);
    let image_unit = longest(p, q);
    let mut result = Stretch::default();
    // Positively phrased: NaN fails, and leaves all zero.
    if !((MIN_LENGTH..=MAX_LENGTH).contains(&unit) && image_unit <= MAX_LENGTH) {
        return result;
    }
    let per_unit = 1.0 / unit;
    let (u, w) = (times(u, per_unit), times(w, per_unit));
    let twice = double_area(u, w);
    if twice >= MIN_DOUBLE_AREA {
        result.area_from = 0.5 * twice * unit * unit;
    }
    if image_unit >= MIN_LENGTH {
        let per_unit = 1.0 / image_unit;
        let (p, q) = (times(p, per_unit), times(q, per_unit));
        let image_twice = double_area(p, q);
        result.area_to = 0.5 * image_twice * image_unit * image_unit;
        if twice >= MIN_DOUBLE_AREA {
            let (large, small) = singular_values(u, w, twice, p, q, image_twice);
            let ratio = image_unit / unit;
            result.large = large * ratio;
            result.small = small * ratio;
        }
    }
    result
}

/// Singular values of the map that takes edges `u`, `w` (spanning `twice` the triangle's area) to edges `p`, `q`.
fn singular_values(u: Vec3, w: Vec3, twice: f32, p: Vec3, q: Vec3, image_twice: f32) -> (f32, f32) {
    let width = dot3(u, u).sqrt();
    let per_width = 1.0 / width;
    let per_area = 1.0 / twice;
    let x = times(p, per_width);
    let shear = dot3(u, w) * per_width;
    let y = times([0, 1, 2].map(|i| q[i] - x[i] * shear), width * per_area);
    let (a, b, c) = (dot3(x, x), dot3(x, y), dot3(y, y));
    let large = ((a + c + ((a - c) * (a - c) + 4.0 * (b * b)).sqrt()) * 0.5).sqrt();
    // Also false for NaN.
    if large > 0.0 { (large, (image_twice * per_area / large).min(large)) } else { (0.0, 0.0) }
}

type Vec3 = [f32; 3];

fn edge(a: Lanes, b: Lanes) -> Vec3 {
    [0, 1, 2].map(|i| b[i] - a[i])
}

fn times(a: Vec3, factor: f32) -> Vec3 {
    a.map(|x| x * factor)
}

fn dot3(a: Vec3, b: Vec3) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn double_area(u: Vec3, w: Vec3) -> f32 {
    let n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
    let square = dot3(n, n);
    if square >= MIN_SQUARE { square.sqrt() } else { 0.0 }
}

fn longest(u: Vec3, w: Vec3) -> f32 {
    let m = [0, 1, 2].map(|i| u[i].abs().max(w[i].abs()));
    m[0].max(m[1]).max(m[2])
}

/// L2 stretch of the map the rows belong to, `sqrt(sum A' L2^2 / sum A') sqrt(sum A / sum A')`, at least 1.
///
/// Infinite when a triangle has lost its area before the map but not after it; 1 for no area at all.
pub fn energy(stretches: &[Stretch]) -> f64 {
    let (mut from, mut to, mut stretched) = (0.0, 0.0, 0.0);
    for s in stretches {
        let (large, small) = (f64::from(s.large), f64::from(s.small));
        if s.area_from == 0.0 && s.area_to > 0.0 {
            return f64::INFINITY;
        }
        from += f64::from(s.area_from);
        to += f64::from(s.area_to);
        stretched += f64::from(s.area_to) * 0.5 * (large * large + small * small);
    }
    if to > 0.0 { (stretched * from).sqrt() / to } else { 1.0 }
}
