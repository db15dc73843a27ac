//! An image over a mesh's texture coordinates: which triangle every texel shows, in bands of rows from the top.
//!
//! Texel (i, j) has its centre at u = (i + 0.5) / width, v = 1 - (j + 0.5) / height. Texels that no triangle covers show
//! the nearest one that is covered, as far as the padding goes. Only one band is held at a time, and beside it for every
//! column the places where it enters the covered part, so that images may be larger than the memory. What the texels show
//! is interpolated while they are still in the cache.

use super::gutter::Gutter;
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::kernel::texels::{draw, shown};
use crate::kernel::{FlatTriangle, Lanes, NO_TRIANGLE, Texel, texel_values};
use crate::stage::exr::BLOCK_ROWS;
use glam::{DMat2, DVec2};
use rayon::prelude::*;
use std::ops::Range;

/// The largest side of an image, in texels.
pub const LARGEST: usize = 16384;
/// Rows of a band at least: whole blocks of EXR files, enough of them to keep the cores busy.
const BAND: usize = 2 * BLOCK_ROWS;
/// Texels of a band at least: with fewer, handing out the work would show.
const BAND_TEXELS: usize = 1 << 16;
/// Windows in which triangles are drawn at once: small enough for the cache and for f32, large enough for few triangles to
/// lie in several.
const WINDOW: [usize; 2] = [512, 16];
/// Coordinates in a window are off by less than this, in texels, when they are rounded to f32.
const ROUNDING: f64 = 1e-4;

/// How far the gutters are filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Padding {
    /// So many texels around the covered part; 0 for none.
    Texels(u32),
    /// Everything.
    Infinite,
}

impl Padding {
    /// The farthest that a texel may take what another shows.
    fn limit(self) -> u32 {
        match self {
            Padding::Texels(n) => n,
            Padding::Infinite => u32::MAX,
        }
    }
}

/// A band of rows.
pub struct Band {
    /// The first row.
    pub first_row: usize,
    /// Number of rows.
    pub rows: usize,
    /// The texels, row by row; those in filled gutters show a triangle and have no covers.
    pub texels: Vec<Texel>,
    /// What they show of the values at the triangles' corners; none without such values, zero for texels without triangle.
    pub pixels: Vec<Lanes>,
}

/// Values at the corners of all triangles.
type Values<'a> = Option<&'a [[Lanes; 3]]>;

/// Some triangles that may cover texels of a window.
#[derive(Default)]
struct Bin {
    /// In coordinates of the window, from its lower left corner, y upwards, so that triangles have a positive area unless they
    /// are turned over in texture space; those are turned back.
    triangles: Vec<FlatTriangle>,
    numbers: Vec<u32>,
    /// Whether any was turned back.
    turned: bool,
}

/// The rows of a window.
#[derive(Default)]
struct Window<'a> {
    texels: Vec<&'a mut [Texel]>,
    /// Rows of no length without values.
    pixels: Vec<&'a mut [Lanes]>,
}

/// Triangles over an image.
pub struct Canvas<'a> {
    width: usize,
    height: usize,
    /// Texture coordinates of the corners.
    uv: &'a [[DVec2; 3]],
    /// For shares of the triangles, in order, and every window of the image, row by row: those that may cover texels of it.
    windows: Vec<Vec<Bin>>,
}

impl<'a> Canvas<'a> {
    /// Prepares an image of `width` x `height` texels over triangles of texture coordinates in the unit square, v up. Triangles
    /// without area, or with a coordinate that is not finite, cover nothing.
    pub fn new(width: usize, height: usize, uv: &'a [[DVec2; 3]]) -> Canvas<'a> {
        let mut canvas = Canvas { width, height, uv, windows: Vec::new() };
        let share = uv.len().div_ceil(rayon::current_num_threads()).max(1);
        let starts = (0..uv.len()).into_par_iter().step_by(share);
        canvas.windows = starts.map(|first| canvas.bins(first..uv.len().min(first + share))).collect();
        canvas
    }

    /// A triangle's corners in texels, y downwards.
    #[inline]
    fn corners(&self, triangle: u32) -> [DVec2; 3] {
        let size = DVec2::new(self.width as f64, self.height as f64);
        self.uv[triangle as usize].map(|p| DVec2::new(p.x, 1.0 - p.y) * size)
    }

    /// The derivative of the weights of a triangle's second and third corner by steps of a texel to the right and down.
    pub fn weights_by_texel(&self, triangle: u32) -> DMat2 {
        let [a, b, c] = self.corners(triangle);
        DMat2::from_cols(b - a, c - a).inverse()
    }

    fn columns(&self) -> usize {
        self.width.div_ceil(WINDOW[0])
    }

    /// For every window those of some triangles that may cover texels of it.
    fn bins(&self, triangles: Range<usize>) -> Vec<Bin> {
        let (columns, rows) = (self.columns(), self.height.div_ceil(WINDOW[1]));
        let mut windows: Vec<Bin> = Vec::new();
        windows.resize_with(columns * rows, Bin::default);
        for t in triangles.start as u32..triangles.end as u32 {
            let mut corners = self.corners(t);
            let area = double_area(corners);
            if !area.is_finite() || area == 0.0 {
                continue;
            }
            // Of its bounding box the centres of texels; a coordinate left of the image, or beyond it, is clamped by the cast.
            let [a, b, c] = corners;
            let first = a.min(b).min(c) - (0.5 + ROUNDING);
            let last = a.max(b).max(c) - (0.5 - ROUNDING);
            let texels = |first: f64, last: f64, size: usize| {
                let low = first as usize + usize::from(first > (first as usize) as f64);
                low..if last < 0.0 { 0 } else { (last as usize + 1).min(size) }
            };
            let (x, y) = (texels(first.x, last.x, self.width), texels(first.y, last.y, self.height));
            if x.is_empty() || y.is_empty() {
                continue;
            }
            let turned = area > 0.0;
            if turned {
                corners.swap(1, 2);
            }
            for row in y.start / WINDOW[1]..=(y.end - 1) / WINDOW[1] {
                let bottom = self.height.min((row + 1) * WINDOW[1]) as f64;
                for column in x.start / WINDOW[0]..=(x.end - 1) / WINDOW[0] {
                    let left = (column * WINDOW[0]) as f64;
                    let [a, b, c] = corners.map(|p| DVec2::new(p.x - left, bottom - p.y).as_vec2());
                    let bin = &mut windows[row * columns + column];
                    bin.triangles.push(FlatTriangle { ax: a.x, ay: a.y, bx: b.x, by: b.y, cx: c.x, cy: c.y });
                    bin.numbers.push(t);
                    bin.turned |= turned;
                }
            }
        }
        windows
    }

    /// Goes through the image from the top, with what its texels show of `values` if there are any.
    ///
    /// # Errors
    /// Those of `visit`; a device error; bug, for fewer values than triangles.
    pub fn bands(
        &self,
        compute: &Compute,
        padding: Padding,
        values: Option<&[[Lanes; 3]]>,
        mut visit: impl FnMut(&Band) -> Result<()>,
    ) -> Result<()> {
        if let Some(values) = values
            && values.len() < self.uv.len()
        {
            return Err(Error::bug(format!("{} values for {} triangles", values.len(), self.uv.len())));
        }
        let mut gutter = None;
        if padding != Padding::Texels(0) {
            let gutter = gutter.insert(Gutter::new(self.width, padding.limit()));
            self.drawn(compute, None, |band| {
                gutter.look(band);
                Ok(())
            })?;
        }
        self.drawn(compute, values, |band| {
            if let Some(gutter) = &mut gutter {
                gutter.fill(band);
                if let Some(values) = values {
                    fill(&band.texels, values, &mut band.pixels);
                }
            }
            visit(band)
        })
    }

    /// All bands without gutters, one after the other in the same memory.
    fn drawn(&self, compute: &Compute, values: Values, mut visit: impl FnMut(&mut Band) -> Result<()>) -> Result<()> {
        let mut band = Band { first_row: 0, rows: 0, texels: Vec::new(), pixels: Vec::new() };
        let rows = BAND_TEXELS.div_ceil(self.width).next_multiple_of(BLOCK_ROWS).max(BAND);
        for first_row in (0..self.height).step_by(rows) {
            band.first_row = first_row;
            band.rows = rows.min(self.height - first_row);
            let count = self.width * band.rows;
            band.texels.resize(count, Texel::EMPTY);
            band.pixels.resize(values.map_or(0, |_| count), [0.0; 4]);
            self.draw(compute, values, &mut band)?;
            visit(&mut band)?;
        }
        Ok(())
    }

    /// Draws the triangles in a band.
    fn draw(&self, compute: &Compute, values: Values, band: &mut Band) -> Result<()> {
        let columns = self.columns();
        let mut windows: Vec<Window> = Vec::new();
        windows.resize_with(columns * band.rows.div_ceil(WINDOW[1]), Window::default);
        let at = |row: usize, column: usize| row / WINDOW[1] * columns + column;
        for (row, line) in band.texels.chunks_mut(self.width).enumerate() {
            line.chunks_mut(WINDOW[0])
                .enumerate()
                .for_each(|(column, piece)| windows[at(row, column)].texels.push(piece));
        }
        for (row, line) in band.pixels.chunks_mut(self.width).enumerate() {
            line.chunks_mut(WINDOW[0])
                .enumerate()
                .for_each(|(column, piece)| windows[at(row, column)].pixels.push(piece));
        }
        let first = band.first_row / WINDOW[1] * columns;
        let drawn =
            windows.into_par_iter().enumerate().map(|(i, window)| self.draw_window(compute, values, first + i, window));
        drawn.collect::<Result<()>>()?;
        // A device takes a whole band at once.
        if let (Compute::Gpu(_), Some(values)) = (compute, values) {
            texel_values(compute, &band.texels, values, &mut band.pixels)?;
        }
        Ok(())
    }

    /// Draws the triangles in a window.
    fn draw_window(&self, compute: &Compute, values: Values, number: usize, window: Window) -> Result<()> {
        let Window { mut texels, pixels } = window;
        texels.reverse(); // from the bottom up, as the triangles are told
        let (mut triangles, mut numbers) = (Vec::new(), Vec::new());
        for share in &self.windows {
            triangles.extend_from_slice(&share[number].triangles);
            numbers.extend_from_slice(&share[number].numbers);
        }
        draw(compute, &mut texels, &triangles, &numbers)?;
        if self.windows.iter().any(|share| share[number].turned) {
            let texels = texels.iter_mut().flat_map(|line| line.iter_mut()).filter(|t| t.triangle != NO_TRIANGLE);
            let texels = texels.filter(|texel| is_turned(self.corners(texel.triangle)));
            texels.for_each(|texel| std::mem::swap(&mut texel.w1, &mut texel.w2));
        }
        if let (Compute::Cpu, Some(values)) = (compute, values) {
            for (texels, pixels) in texels.iter().rev().zip(pixels) {
                texels.iter().zip(pixels).for_each(|(texel, pixel)| *pixel = shown(texel, values));
            }
        }
        Ok(())
    }
}

/// Interpolates at texels in filled gutters; what others show stands.
fn fill(texels: &[Texel], values: &[[Lanes; 3]], pixels: &mut [Lanes]) {
    let gutters = texels.par_iter().zip(pixels).with_min_len(WINDOW[0]).filter(|(texel, _)| texel.covers == 0);
    gutters.for_each(|(texel, pixel)| *pixel = shown(texel, values));
}

/// True for corners that are turned over in texture space; here y is downwards.
fn is_turned(corners: [DVec2; 3]) -> bool {
    double_area(corners) > 0.0
}

fn double_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Refuses a side that is zero or larger than [`LARGEST`].
pub(super) fn check_size(size: usize) -> Result<()> {
    if (1..=LARGEST).contains(&size) {
        return Ok(());
    }
    Err(Error::usage(format!("an image of {size} x {size} texels")).remedy(format!("use a size from 1 to {LARGEST}")))
}
