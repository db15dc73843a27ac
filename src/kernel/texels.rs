//! Texel ownership: the triangle that covers the centre of every texel of a window, and the texel's weights in it.
//!
//! A centre on an edge belongs to one of the triangles beside it: areas are evaluated along an edge from its lower end
//! to its higher one (by x, then y), so both triangles see the same number, and ties go to the side where the edge
//! ascends. So triangles that share edges leave no gap between them and share no texel, on every device. Where triangles
//! overlap the first owns the texel.

use bytemuck::{Pod, Zeroable};

use crate::error::{Error, Result};
use crate::gpu::{Access, Compute, GpuDevice, Kernel};

use super::resample::{Query, resample};
use super::rings::Lists;
use super::texel_rows::{Edges, NARROW};
use super::{GRAIN, Lanes, check_len};
use glam::Vec4;
use rayon::prelude::*;
use std::ops::Range;

/// `kernels/texels.wgsl`.
pub const KERNEL: Kernel = Kernel {
    name: "texels",
    source: include_str!("../../kernels/texels.wgsl"),
    buffers: &[Access::Read, Access::Read, Access::Read, Access::ReadWrite],
};

/// Stands for the triangle of a texel that none covers.
pub const NO_TRIANGLE: u32 = u32::MAX;
/// Cells, for which candidate triangles are listed, have this many texels along a side: larger ones cost more tests,
/// smaller ones longer lists.
pub const CELL: u32 = 8;

/// Parameters of one dispatch.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TexelParams {
    /// The first texel.
    pub first: u32,
    /// Number of texels.
    pub count: u32,
    /// Texels in a row.
    pub width: u32,
    /// Padding.
    pub unused: u32,
}

/// A triangle in the plane: corners in texels from the window's upper left corner, y downwards, with a positive area,
/// so that a texel's centre is at whole numbers and a half.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct FlatTriangle {
    /// First corner, x.
    pub ax: f32,
    /// First corner, y.
    pub ay: f32,
    /// Second corner, x.
    pub bx: f32,
    /// Second corner, y.
    pub by: f32,
    /// Third corner, x.
    pub cx: f32,
    /// Third corner, y.
    pub cy: f32,
}

/// What a texel shows.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Texel {
    /// The first triangle that covers its centre, or [`NO_TRIANGLE`].
    pub triangle: u32,
    /// How many triangles do.
    pub covers: u32,
    /// Weight of the triangle's second corner.
    pub w1: f32,
    /// Weight of the third; that of the first is what is left of one.
    pub w2: f32,
}

impl Texel {
    /// A texel that no triangle covers.
    pub const EMPTY: Texel = Texel { triangle: NO_TRIANGLE, covers: 0, w1: 0.0, w2: 0.0 };

    /// The barycentric weights of the triangle's corners.
    pub fn weights(&self) -> [f32; 3] {
        [1.0 - self.w1 - self.w2, self.w1, self.w2]
    }
}

/// The texels of a window of `width` x `height`, row by row from the top.
///
/// Fails on a device error, or if the window has more texels than 32 bits can number.
pub fn texels(compute: &Compute, width: u32, height: u32, triangles: &[FlatTriangle]) -> Result<Vec<Texel>> {
    let count = width.checked_mul(height);
    let count = count.ok_or_else(|| Error::bug(format!("a window of {width} x {height} texels is too large")))?;
    let mut all = vec![Texel::EMPTY; count as usize];
    let numbers: Vec<u32> = (0u32..).take(triangles.len()).collect();
    draw(compute, &mut all.chunks_mut(width.max(1) as usize).collect::<Vec<_>>(), triangles, &numbers)?;
    Ok(all)
}

/// The same into the rows of a window, which are equally long; whatever was in them is gone. Texels call the triangles by
/// `numbers`.
///
/// Fails on a device error, or without a number for every triangle.
pub fn draw(compute: &Compute, lines: &mut [&mut [Texel]], triangles: &[FlatTriangle], numbers: &[u32]) -> Result<()> {
    check_len("numbers of triangles", numbers.len(), triangles.len())?;
    let Compute::Gpu(gpu) = compute else {
        reference(lines, triangles, numbers);
        return Ok(());
    };
    let width = lines.first().map_or(0, |line| line.len());
    let all = on_device(gpu, width as u32, lines.len() as u32, triangles)?;
    let named = |texel: &Texel| match texel.triangle {
        NO_TRIANGLE => Texel::EMPTY,
        t => Texel { triangle: numbers[t as usize], ..*texel },
    };
    let texels = lines.iter_mut().flat_map(|line| line.iter_mut());
    texels.zip(&all).for_each(|(texel, drawn)| *texel = named(drawn));
    Ok(())
}

/// What texels show of values at the corners of triangles, three for every triangle; zero for texels that show none. `shown`
/// holds nothing else then.
///
/// Fails when a texel shows a triangle that has no values, or on a device error.
pub fn texel_values(compute: &Compute, texels: &[Texel], values: &[[Lanes; 3]], shown: &mut Vec<Lanes>) -> Result<()> {
    if let Compute::Gpu(_) = compute {
        let queries: Vec<Query> = texels.par_iter().map(query).collect();
        *shown = resample(compute, &queries, values.as_flattened())?;
        return Ok(());
    }
    let is_missing = |t: &Texel| t.triangle != NO_TRIANGLE && t.triangle as usize >= values.len();
    if texels.par_iter().with_min_len(GRAIN).any(is_missing) {
        return Err(Error::bug("a texel of a triangle without values"));
    }
    texels.par_iter().with_min_len(GRAIN).map(|texel| self::shown(texel, values)).collect_into_vec(shown);
    Ok(())
}

/// The CPU twin of it for a texel whose triangle has values.
#[inline]
pub fn shown(texel: &Texel, values: &[[Lanes; 3]]) -> Lanes {
    match texel.triangle {
        NO_TRIANGLE => [0.0; 4],
        t => interpolate(&values[t as usize], texel.weights()),
    }
}

/// A texel as a question to [`resample()`].
fn query(texel: &Texel) -> Query {
    let (first, [w0, w1, w2]) = match texel.triangle {
        NO_TRIANGLE => (0, [0.0; 3]),
        t => (3 * t, texel.weights()),
    };
    Query { i0: first, i1: first + 1, i2: first + 2, w0, w1, w2 }
}

/// What [`resample()`] answers to it.
#[inline]
fn interpolate(corners: &[Lanes; 3], [w0, w1, w2]: [f32; 3]) -> Lanes {
    let [a, b, c] = corners.map(Vec4::from_array);
    (a * w0 + b * w1 + c * w2).to_array()
}

fn on_device(gpu: &GpuDevice, width: u32, height: u32, triangles: &[FlatTriangle]) -> Result<Vec<Texel>> {
    if triangles.is_empty() {
        // A binding holds one element at least.
        return Ok(vec![Texel::EMPTY; (width * height) as usize]);
    }
    let lists = candidates(width, height, triangles);
    let (starts, items) = (gpu.upload("starts", &lists.starts)?, gpu.upload("candidates", &lists.items)?);
    let triangles = gpu.upload("triangles", triangles)?;
    let texels = gpu.allocate::<Texel>("texels", (width * height) as usize)?;
    let params = |span: crate::gpu::Span| TexelParams { first: span.first, count: span.count, width, unused: 0 };
    gpu.submit([&gpu.launch(&KERNEL, 0..width * height, params, &[&triangles, &starts, &items, &texels])])?;
    gpu.download(&texels)
}

/// For every cell of a window the triangles whose bounding box meets it, in order.
fn candidates(width: u32, height: u32, triangles: &[FlatTriangle]) -> Lists {
    let (columns, rows) = (width.div_ceil(CELL), height.div_ceil(CELL));
    let mut lists = vec![Vec::new(); (columns * rows) as usize];
    for (t, triangle) in (0u32..).zip(triangles) {
        let Some(Box2 { x, y }) = covered(width, height, triangle) else { continue };
        for row in y.start / CELL..y.end.div_ceil(CELL) {
            for column in x.start / CELL..x.end.div_ceil(CELL) {
                lists[(row * columns + column) as usize].push(t);
            }
        }
    }
    Lists::new(&lists)
}

/// The columns and rows of texels whose centres a triangle's bounding box holds.
struct Box2 {
    x: Range<u32>,
    y: Range<u32>,
}

fn covered(width: u32, height: u32, t: &FlatTriangle) -> Option<Box2> {
    let span = |a: f32, b: f32, c: f32, size: u32| {
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        // A float that is negative or too large is clamped by the cast.
        let (first, last) = ((low - 0.5), (high - 0.5));
        // Up to the next whole number, and down to one: the functions for it are calls on older processors.
        let whole = first as u32;
        let first = whole.saturating_add(u32::from((whole as f32) < first));
        let end = if last >= 0.0 { (last as u32).saturating_add(1) } else { 0 };
        first..end.min(size)
    };
    let (x, y) = (span(t.ax, t.bx, t.cx, width), span(t.ay, t.by, t.cy, height));
    (!x.is_empty() && !y.is_empty()).then_some(Box2 { x, y })
}

/// The CPU twin: triangles one after the other, and of every row only the columns that lie inside.
fn reference(lines: &mut [&mut [Texel]], triangles: &[FlatTriangle], numbers: &[u32]) {
    let (width, height) = (lines.first().map_or(0, |line| line.len() as u32), lines.len() as u32);
    lines.iter_mut().for_each(|line| line.fill(Texel::EMPTY));
    for (triangle, &t) in triangles.iter().zip(numbers) {
        let Some(Box2 { x, y }) = covered(width, height, triangle) else { continue };
        let edges = Edges::of(triangle);
        for row in y {
            let edges = edges.along(row);
            let line = &mut lines[row as usize];
            if x.len() <= NARROW {
                edges.cover_narrow(&mut line[x.start as usize..x.end as usize], x.start, t);
                continue;
            }
            let inside = edges.inside(x.clone());
            if !inside.is_empty() {
                edges.cover(&mut line[inside.start as usize..inside.end as usize], inside.start, t);
            }
        }
    }
}
