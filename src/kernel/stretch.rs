//! Stretch of every triangle under a piecewise affine map.
//!
//! Sander, Snyder, Gortler, Hoppe: Texture Mapping Progressive Meshes (2001), section 3: singular values of the map of
//! one triangle and its L2 stretch. The f64 twin for single triangles is [`crate::mesh::metric::singular_values`].

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec4};
use rayon::prelude::*;

use crate::error::{Error, Result};
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
    let check = || check_indices("triangle corner", triangles.as_flattened(), source.len());
    match compute {
        // The twin finds out by itself; who it was is looked for then.
        Compute::Cpu => match reference(triangles, source, image) {
            Some(stretches) => Ok(stretches),
            None => check().and(Err(Error::bug("the stretch of triangles whose corners all exist"))),
        },
        Compute::Gpu(gpu) => check().and_then(|()| on_device(gpu, triangles, source, image)),
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

/// Triangles that go together: what they need lies in the innermost cache.
const BLOCK: usize = 64;

/// A number for every triangle of a block.
type Column = [f32; BLOCK];
/// A vector for every triangle of a block, by coordinate.
type Columns = [Column; 3];

/// What is told of a block of triangles, one number after the other, so that loops over it take as many triangles at once as
/// the processor can.
struct Block {
    /// The edges from the first corner to the second and to the third, before the map and after it.
    edges: [[Columns; 2]; 2],
    /// The members of [`Stretch`].
    members: [Column; 4],
}

/// The CPU twin; `None` if a triangle has a corner without a position.
pub fn reference(triangles: &[[u32; 3]], source: &[Lanes], image: &[Lanes]) -> Option<Vec<Stretch>> {
    let mut stretches = bytemuck::zeroed_vec(triangles.len());
    let arch = pulp::Arch::new();
    let pieces = triangles.par_chunks(GRAIN).zip(stretches.par_chunks_mut(GRAIN));
    let of_piece = |(triangles, stretches)| arch.dispatch(Piece { triangles, positions: [source, image], stretches });
    pieces.map(of_piece).collect::<Option<()>>()?;
    Some(stretches)
}

/// Triangles that one thread goes through.
struct Piece<'a> {
    triangles: &'a [[u32; 3]],
    /// Before the map and after it.
    positions: [&'a [Lanes]; 2],
    stretches: &'a mut [Stretch],
}

impl pulp::NullaryFnOnce for Piece<'_> {
    type Output = Option<()>;

    /// `None` if a corner has no position.
    #[inline(always)]
    fn call(self) -> Option<()> {
        let mut block = Block { edges: [[[[0.0; BLOCK]; 3]; 2]; 2], members: [[0.0; BLOCK]; 4] };
        let (whole, rest) = self.triangles.as_chunks();
        let (whole_out, rest_out) = self.stretches.as_chunks_mut();
        for (triangles, stretches) in whole.iter().zip(whole_out) {
            block.stretch(triangles, self.positions, stretches)?;
        }
        if let Some(&last) = rest.last() {
            let mut filled = [last; BLOCK];
            filled[..rest.len()].copy_from_slice(rest);
            let mut stretches = [Stretch::default(); BLOCK];
            block.stretch(&filled, self.positions, &mut stretches)?;
            rest_out.copy_from_slice(&stretches[..rest.len()]);
        }
        Some(())
    }
}

impl Block {
    #[inline(always)]
    fn stretch(
        &mut self,
        triangles: &[[u32; 3]; BLOCK],
        positions: [&[Lanes]; 2],
        stretches: &mut [Stretch; BLOCK],
    ) -> Option<()> {
        gather(triangles, positions, &mut self.edges)?;
        let [[u, w], [p, q]] = &self.edges;
        for i in 0..BLOCK {
            let at = |vectors: &Columns| [vectors[0][i], vectors[1][i], vectors[2][i]];
            let stretch = of_triangle(at(u), at(w), at(p), at(q));
            self.members[0][i] = stretch.large;
            self.members[1][i] = stretch.small;
            self.members[2][i] = stretch.area_from;
            self.members[3][i] = stretch.area_to;
        }
        for (k, stretches) in stretches.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let [a, b, c, d] = self.members.each_ref().map(|member| Vec4::from_array(member.as_chunks().0[k]));
            *stretches = bytemuck::cast(Mat4::from_cols(a, b, c, d).transpose().to_cols_array());
        }
        Some(())
    }
}

/// The edges from the first corner of triangles to the second and to the third, before the map and after it.
#[inline(always)]
fn gather(triangles: &[[u32; 3]; BLOCK], [source, image]: [&[Lanes]; 2], edges: &mut [[Columns; 2]; 2]) -> Option<()> {
    // Equally long, so that a corner is looked for once.
    let image = image.get(..source.len())?;
    let at = |v: u32| {
        let v = v as usize;
        (v < source.len()).then(|| [Vec4::from_array(source[v]), Vec4::from_array(image[v])])
    };
    for (k, triangles) in triangles.as_chunks::<4>().0.iter().enumerate() {
        let mut of_four = [[[Vec4::ZERO; 4]; 2]; 2];
        for (i, &[a, b, c]) in triangles.iter().enumerate() {
            let (origin, second, third) = (at(a)?, at(b)?, at(c)?);
            for m in 0..2 {
                of_four[m][0][i] = second[m] - origin[m];
                of_four[m][1][i] = third[m] - origin[m];
            }
        }
        for (columns, [a, b, c, d]) in edges.as_flattened_mut().iter_mut().zip(of_four.as_flattened()) {
            let by_coordinate = Mat4::from_cols(*a, *b, *c, *d).transpose();
            columns[0].as_chunks_mut().0[k] = by_coordinate.x_axis.to_array();
            columns[1].as_chunks_mut().0[k] = by_coordinate.y_axis.to_array();
            columns[2].as_chunks_mut().0[k] = by_coordinate.z_axis.to_array();
        }
    }
    Some(())
}

/// The stretch of a triangle with edges `u` and `w` before the map, and `p` and `q` after it. Nothing is left out by a
/// branch: what has no meaning is computed and dropped, so that many triangles go together.
#[inline(always)]
fn of_triangle(u: Vec3, w: Vec3, p: Vec3, q: Vec3) -> Stretch {
    let unit = longest(u, w);
    let image_unit = longest(p, q);
    let (u, w) = (times(u, 1.0 / unit), times(w, 1.0 / unit));
    let twice = double_area(u, w);
    let (p, q) = (times(p, 1.0 / image_unit), times(q, 1.0 / image_unit));
    let image_twice = double_area(p, q);
    // Positively phrased: NaN fails, and leaves all zero.
    let usable = (MIN_LENGTH..=MAX_LENGTH).contains(&unit) & (image_unit <= MAX_LENGTH);
    let has_image = usable & (image_unit >= MIN_LENGTH);
    let has_area = usable & (twice >= MIN_DOUBLE_AREA);
    let [large, small] = singular_values(u, w, twice, p, q, image_twice);
    let ratio = image_unit / unit;
    let or_zero = |condition: bool, value: f32| if condition { value } else { 0.0 };
    Stretch {
        large: or_zero(has_image & has_area, large * ratio),
        small: or_zero(has_image & has_area, small * ratio),
        area_from: or_zero(has_area, 0.5 * twice * unit * unit),
        area_to: or_zero(has_image, 0.5 * image_twice * image_unit * image_unit),
    }
}

/// Singular values of the map that takes edges `u`, `w` (spanning `twice` the triangle's area) to edges `p`, `q`.
#[inline(always)]
fn singular_values(u: Vec3, w: Vec3, twice: f32, p: Vec3, q: Vec3, image_twice: f32) -> [f32; 2] {
    let width = dot3(u, u).sqrt();
    let per_width = 1.0 / width;
    let per_area = 1.0 / twice;
    let x = times(p, per_width);
    let shear = dot3(u, w) * per_width;
    let y = times([0, 1, 2].map(|i| q[i] - x[i] * shear), width * per_area);
    let (a, b, c) = (dot3(x, x), dot3(x, y), dot3(y, y));
    let large = ((a + c + ((a - c) * (a - c) + 4.0 * (b * b)).sqrt()) * 0.5).sqrt();
    let small = smaller(image_twice * per_area / large, large);
    // NaN is not positive.
    let if_positive = |x: f32| if large > 0.0 { x } else { 0.0 };
    [if_positive(large), if_positive(small)]
}

type Vec3 = [f32; 3];

#[inline(always)]
fn times(a: Vec3, factor: f32) -> Vec3 {
    a.map(|x| x * factor)
}

#[inline(always)]
fn dot3(a: Vec3, b: Vec3) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn double_area(u: Vec3, w: Vec3) -> f32 {
    let n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
    let square = dot3(n, n);
    let length = square.sqrt();
    if square >= MIN_SQUARE { length } else { 0.0 }
}

#[inline(always)]
fn longest(u: Vec3, w: Vec3) -> f32 {
    let m = [0, 1, 2].map(|i| larger(u[i].abs(), w[i].abs()));
    larger(larger(m[0], m[1]), m[2])
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
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
