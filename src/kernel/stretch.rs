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

/// The longest component of a triangle's edges must lie in `MIN_LENGTH..=MAX_LENGTH`: beyond it, areas leave the range of
/// f32. Edges are measured in units of the largest power of two not above it, which is exact.
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
    let mut stretches = bytemuck::zeroed_vec(triangles.len());
    stretch_into(compute, triangles, source, image, &mut stretches)?;
    Ok(stretches)
}

/// [`stretch`] into memory that is there already, one entry for every triangle; after an error it holds anything.
pub fn stretch_into(
    compute: &Compute,
    triangles: &[[u32; 3]],
    source: &[Lanes],
    image: &[Lanes],
    stretches: &mut [Stretch],
) -> Result<()> {
    check_len("image positions", image.len(), source.len())?;
    check_len("stretches", stretches.len(), triangles.len())?;
    let check = || check_indices("triangle corner", triangles.as_flattened(), source.len());
    match compute {
        // The twin finds out by itself; who it was is looked for then.
        Compute::Cpu => match reference(triangles, source, image, stretches) {
            Some(()) => Ok(()),
            None => check().and(Err(Error::bug("the stretch of triangles whose corners all exist"))),
        },
        Compute::Gpu(gpu) => check().and_then(|()| on_device(gpu, triangles, source, image, stretches)),
    }
}

/// Triangles go through in pieces a device can bind at once, vertices stay.
fn on_device(
    gpu: &GpuDevice,
    triangles: &[[u32; 3]],
    source: &[Lanes],
    image: &[Lanes],
    result: &mut [Stretch],
) -> Result<()> {
    let source = gpu.upload("source", source)?;
    let image = gpu.upload("image", image)?;
    let len = gpu.stream_len::<Stretch>();
    for (piece, result) in triangles.chunks(len).zip(result.chunks_mut(len)) {
        let triangles = gpu.upload("triangles", piece)?;
        let stretches = gpu.allocate("stretches", piece.len())?;
        gpu.submit([&launch(gpu, &triangles, &source, &image, &stretches)])?;
        result.copy_from_slice(&gpu.download(&stretches)?);
    }
    Ok(())
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
    maps: Maps,
    /// The members of [`Stretch`].
    members: [Column; 4],
}

/// What the members of a block's [`Stretch`] follow from.
struct Maps {
    /// The mean of the squared singular values.
    mean: Column,
    /// The square of how far they are from it.
    spread: Column,
    /// The squares of twice the areas before the map and after it.
    squares: [Column; 2],
    /// The units of length before the map and after it; 0 where there is no area, and no image.
    units: [Column; 2],
}

/// The CPU twin; `None` if a triangle has a corner without a position.
pub fn reference(triangles: &[[u32; 3]], source: &[Lanes], image: &[Lanes], stretches: &mut [Stretch]) -> Option<()> {
    let arch = pulp::Arch::new();
    let pieces = triangles.par_chunks(GRAIN).zip(stretches.par_chunks_mut(GRAIN));
    let of_piece = |(triangles, stretches)| arch.dispatch(Piece { triangles, positions: [source, image], stretches });
    pieces.map(of_piece).collect()
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
        let column = [0.0; BLOCK];
        let maps = Maps { mean: column, spread: column, squares: [column; 2], units: [column; 2] };
        let mut block = Block { edges: [[[column; 3]; 2]; 2], maps, members: [column; 4] };
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
        let Block { edges: [[u, w], [p, q]], maps, members } = self;
        // Two short loops: in one long loop a processor would see no next triangles to go on with while it waits for roots.
        for i in 0..BLOCK {
            let at = |vectors: &Columns| [vectors[0][i], vectors[1][i], vectors[2][i]];
            let Map { mean, spread, squares, units } = Map::new(at(u), at(w), at(p), at(q));
            (maps.mean[i], maps.spread[i]) = (mean, spread);
            (maps.squares[0][i], maps.squares[1][i]) = (squares[0], squares[1]);
            (maps.units[0][i], maps.units[1][i]) = (units[0], units[1]);
        }
        for i in 0..BLOCK {
            let [squares, units] = [&maps.squares, &maps.units].map(|[before, after]| [before[i], after[i]]);
            let stretch = Map { mean: maps.mean[i], spread: maps.spread[i], squares, units }.stretch();
            members[0][i] = stretch.large;
            members[1][i] = stretch.small;
            members[2][i] = stretch.area_from;
            members[3][i] = stretch.area_to;
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

/// The entry of one triangle in [`Maps`].
struct Map {
    mean: f32,
    spread: f32,
    squares: [f32; 2],
    units: [f32; 2],
}

impl Map {
    /// That of a triangle with edges `u` and `w` before the map, and `p` and `q` after it. Nothing is left out by a branch:
    /// what has no meaning is computed and dropped, so that many triangles go together.
    #[inline(always)]
    fn new(u: Vec3, w: Vec3, p: Vec3, q: Vec3) -> Self {
        let length = longest(u, w);
        let image_length = longest(p, q);
        let (unit, per_unit) = power_of_two(length);
        let (image_unit, per_image_unit) = power_of_two(image_length);
        let (u, w) = (times(u, per_unit), times(w, per_unit));
        let (p, q) = (times(p, per_image_unit), times(q, per_image_unit));
        let squares = [double_area_squared(u, w), double_area_squared(p, q)];
        // Positively phrased: NaN fails, and leaves all zero.
        let usable = (MIN_LENGTH..=MAX_LENGTH).contains(&length) & (image_length <= MAX_LENGTH);
        let has_image = usable & (image_length >= MIN_LENGTH);
        let has_area = usable & (squares[0] >= MIN_DOUBLE_AREA * MIN_DOUBLE_AREA);
        // The map's columns in the orthonormal frame along `u` have the products `a`, `c` and, but for the triangle's area, `b`.
        // One division for two.
        let width = dot3(u, u);
        let both = 1.0 / (width * squares[0]);
        let (per_width, per_square) = (both * squares[0], both * width);
        let shear = dot3(u, w) * per_width;
        let y = [0, 1, 2].map(|i| q[i] - p[i] * shear);
        let a = dot3(p, p) * per_width;
        let b = dot3(p, y);
        let c = dot3(y, y) * (width * per_square);
        let half = 0.5 * (a - c);
        Map {
            mean: 0.5 * (a + c),
            spread: half * half + b * (b * per_square),
            squares,
            units: [or_zero(has_area, unit), or_zero(has_image, image_unit)],
        }
    }

    #[inline(always)]
    fn stretch(self) -> Stretch {
        let [unit, image_unit] = self.units;
        let [twice, image_twice] = self.squares.map(f32::sqrt);
        let large = (self.mean + self.spread.sqrt()).sqrt();
        let small = smaller(image_twice / (twice * large), large);
        let ratio = image_unit * power_of_two(unit).1;
        // NaN is not positive.
        let has_stretch = (unit > 0.0) & (image_unit > 0.0) & (large > 0.0);
        Stretch {
            large: or_zero(has_stretch, large * ratio),
            small: or_zero(has_stretch, small * ratio),
            area_from: or_zero(unit > 0.0, 0.5 * twice * unit * unit),
            area_to: or_zero(image_unit > 0.0, 0.5 * image_twice * image_unit * image_unit),
        }
    }
}

#[inline(always)]
fn or_zero(condition: bool, value: f32) -> f32 {
    if condition { value } else { 0.0 }
}

/// The largest power of two not above a positive normal number, and one divided by it; both finite whatever the number.
#[inline(always)]
fn power_of_two(x: f32) -> (f32, f32) {
    let exponent = x.to_bits() & 0x7f80_0000;
    // A power of two has the exponent 127 + n there, its inverse 127 - n: the sum of both is always 254.
    (f32::from_bits(exponent), f32::from_bits(0x7f00_0000_u32.wrapping_sub(exponent)))
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
fn double_area_squared(u: Vec3, w: Vec3) -> f32 {
    let n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
    let square = dot3(n, n);
    or_zero(square >= MIN_SQUARE, square)
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
