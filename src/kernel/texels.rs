//! Texel ownership: the triangle that covers the centre of every texel of a window, and the texel's weights in it.
//!
//! A centre on an edge belongs to one of the triangles beside it: areas are evaluated along an edge from its lower end
//! to its higher one (by x, then y), so both triangles see the same number, and ties go to the side where the edge
//! ascends. So triangles that share edges leave no gap between them and share no texel, on every device. Where triangles
//! overlap the first owns the texel.

use bytemuck::{Pod, Zeroable};

use crate::error::{Error, Result};
use crate::gpu::{Access, Compute, GpuDevice, Kernel};

use super::rings::Lists;

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
    if width.checked_mul(height).is_none() {
        return Err(Error::bug(format!("a window of {width} x {height} texels is too large")));
    }
    match compute {
        Compute::Cpu => Ok(reference(width, height, triangles)),
        Compute::Gpu(gpu) => on_device(gpu, width, height, triangles),
    }
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
    x: std::ops::Range<u32>,
    y: std::ops::Range<u32>,
}

fn covered(width: u32, height: u32, t: &FlatTriangle) -> Option<Box2> {
    let span = |a: f32, b: f32, c: f32, size: u32| {
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        // A float that is negative or too large is clamped by the cast.
        let (first, end) = ((low - 0.5).ceil() as u32, ((high - 0.5).floor() + 1.0) as u32);
        first..end.min(size)
    };
    let (x, y) = (span(t.ax, t.bx, t.cx, width), span(t.ay, t.by, t.cy, height));
    (!x.is_empty() && !y.is_empty()).then_some(Box2 { x, y })
}

/// The CPU twin: triangles one after the other.
pub fn reference(width: u32, height: u32, triangles: &[FlatTriangle]) -> Vec<Texel> {
    let mut texels = vec![Texel::EMPTY; (width * height) as usize];
    for (t, triangle) in (0u32..).zip(triangles) {
        let Some(Box2 { x, y }) = covered(width, height, triangle) else { continue };
        let FlatTriangle { ax, ay, bx, by, cx, cy } = *triangle;
        let (ab, bc, ca) =
            (Edge::new([ax, ay], [bx, by]), Edge::new([bx, by], [cx, cy]), Edge::new([cx, cy], [ax, ay]));
        for row in y {
            let v = row as f32 + 0.5;
            let line = &mut texels[(row * width) as usize..][..width as usize];
            for column in x.clone() {
                let u = column as f32 + 0.5;
                let (at_a, at_b, at_c) = (bc.beside(u, v), ca.beside(u, v), ab.beside(u, v));
                let sum = at_a + at_b + at_c;
                if bc.holds(at_a) && ca.holds(at_b) && ab.holds(at_c) && sum > 0.0 {
                    let texel = &mut line[column as usize];
                    if texel.covers == 0 {
                        *texel = Texel { triangle: t, covers: 0, w1: at_b / sum, w2: at_c / sum };
                    }
                    texel.covers += 1;
                }
            }
        }
    }
    texels
}

/// An edge, told from its lower end.
struct Edge {
    x: f32,
    y: f32,
    dx: f32,
    dy: f32,
    ascends: bool,
}

impl Edge {
    fn new(p: [f32; 2], q: [f32; 2]) -> Edge {
        let ascends = p[0] < q[0] || (p[0] == q[0] && p[1] < q[1]);
        let ([x, y], [to_x, to_y]) = if ascends { (p, q) } else { (q, p) };
        Edge { x, y, dx: to_x - x, dy: to_y - y, ascends }
    }

    /// Twice the area that a point spans with the edge, positive at its left.
    fn beside(&self, u: f32, v: f32) -> f32 {
        let area = self.dx * (v - self.y) - self.dy * (u - self.x);
        if self.ascends { area } else { -area }
    }

    fn holds(&self, area: f32) -> bool {
        area > 0.0 || (area == 0.0 && self.ascends)
    }
}
