//! An image over a mesh's texture coordinates: which triangle every texel shows, in bands of rows from the top.
//!
//! Texel (i, j) has its centre at u = (i + 0.5) / width, v = 1 - (j + 0.5) / height. Texels that no triangle covers show
//! the nearest one that is covered, as far as the padding goes. Only one band is held at a time, and beside it for every
//! column the places where it enters the covered part, so that images may be larger than the memory.

use super::gutter::Gutter;
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::kernel::texels::draw;
use crate::kernel::{FlatTriangle, NO_TRIANGLE, Texel};
use crate::stage::exr::BLOCK_ROWS;
use glam::{DMat2, DVec2};
use rayon::prelude::*;
use std::ops::Range;

/// The largest side of an image, in texels.
pub const LARGEST: usize = 16384;
/// Rows of a band at least: whole blocks of EXR files, enough of them to keep the cores busy.
const BAND: usize = 2 * BLOCK_ROWS;
/// Texels of a band at least: with fewer, handing out the work would show.
const BAND_TEXELS: usize = 1 << 18;
/// Windows in which triangles are drawn at once: small enough for the cache and for f32, large enough for few triangles to
/// lie in several.
const WINDOW: [usize; 2] = [512, 16];

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
}

/// Triangles over an image.
pub struct Canvas<'a> {
    width: usize,
    height: usize,
    /// Texture coordinates of the corners.
    uv: &'a [[DVec2; 3]],
    /// For shares of the triangles, in order, and every window of the image, row by row: those whose bounding box meets it.
    windows: Vec<Vec<Vec<u32>>>,
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

    /// For every window those of some triangles whose bounding box meets it.
    fn bins(&self, triangles: Range<usize>) -> Vec<Vec<u32>> {
        let (columns, rows) = (self.columns(), self.height.div_ceil(WINDOW[1]));
        let mut windows = vec![Vec::new(); columns * rows];
        for t in triangles.start as u32..triangles.end as u32 {
            let corners = self.corners(t);
            let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
            let high = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
            let is_drawn = corners.iter().all(|p| p.is_finite()) && double_area(corners) != 0.0;
            let is_inside = low.x < self.width as f64 && low.y < self.height as f64 && high.min_element() > 0.0;
            if !is_drawn || !is_inside {
                continue;
            }
            // Coordinates left of the image, or beyond it, are clamped by the casts and the bounds.
            let cells = |axis: usize, most: usize| {
                let cell = |x: f64| (x as usize / WINDOW[axis]).min(most - 1);
                cell(low[axis])..=cell(high[axis])
            };
            for row in cells(1, rows) {
                for column in cells(0, columns) {
                    windows[row * columns + column].push(t);
                }
            }
        }
        windows
    }

    /// Goes through the image from the top. Fails as `visit` does, or on a device error.
    pub fn bands(&self, compute: &Compute, padding: Padding, mut visit: impl FnMut(&Band) -> Result<()>) -> Result<()> {
        let mut gutter = None;
        if padding != Padding::Texels(0) {
            let gutter = gutter.insert(Gutter::new(self.width, padding.limit()));
            self.drawn(compute, |band| {
                gutter.look(band);
                Ok(())
            })?;
        }
        self.drawn(compute, |band| {
            if let Some(gutter) = &mut gutter {
                gutter.fill(band);
            }
            visit(band)
        })
    }

    /// All bands without gutters, one after the other in the same memory.
    fn drawn(&self, compute: &Compute, mut visit: impl FnMut(&mut Band) -> Result<()>) -> Result<()> {
        let mut band = Band { first_row: 0, rows: 0, texels: Vec::new() };
        let rows = BAND_TEXELS.div_ceil(self.width).next_multiple_of(BLOCK_ROWS).max(BAND);
        for first_row in (0..self.height).step_by(rows) {
            band.first_row = first_row;
            band.rows = rows.min(self.height - first_row);
            band.texels.resize(self.width * band.rows, Texel::EMPTY);
            self.draw(compute, &mut band)?;
            visit(&mut band)?;
        }
        Ok(())
    }

    /// Draws the triangles in a band.
    fn draw(&self, compute: &Compute, band: &mut Band) -> Result<()> {
        let columns = self.columns();
        let mut windows: Vec<Vec<&mut [Texel]>> = Vec::new();
        windows.resize_with(columns * band.rows.div_ceil(WINDOW[1]), Vec::new);
        for (row, line) in band.texels.chunks_mut(self.width).enumerate() {
            for (column, piece) in line.chunks_mut(WINDOW[0]).enumerate() {
                windows[row / WINDOW[1] * columns + column].push(piece);
            }
        }
        let first = band.first_row / WINDOW[1] * columns;
        let windows = windows.into_par_iter().enumerate();
        windows.try_for_each(|(i, lines)| self.draw_window(compute, first + i, lines))
    }

    /// Draws the triangles in a window with these rows.
    fn draw_window(&self, compute: &Compute, window: usize, mut lines: Vec<&mut [Texel]>) -> Result<()> {
        let columns = self.columns();
        let left = (window % columns * WINDOW[0]) as f64;
        let bottom = (window / columns * WINDOW[1] + lines.len()) as f64;
        // From the bottom up, so that triangles have a positive area unless they are turned over in texture space.
        lines.reverse();
        let numbers: Vec<u32> = self.windows.iter().flat_map(|share| &share[window]).copied().collect();
        let mut turned = false;
        let flat = |&t: &u32| {
            let mut corners = self.corners(t);
            if is_turned(corners) {
                corners.swap(1, 2);
                turned = true;
            }
            let [a, b, c] = corners.map(|p| DVec2::new(p.x - left, bottom - p.y).as_vec2());
            FlatTriangle { ax: a.x, ay: a.y, bx: b.x, by: b.y, cx: c.x, cy: c.y }
        };
        let triangles: Vec<FlatTriangle> = numbers.iter().map(flat).collect();
        draw(compute, &mut lines, &triangles, &numbers)?;
        if turned {
            let texels = lines.iter_mut().flat_map(|line| line.iter_mut()).filter(|t| t.triangle != NO_TRIANGLE);
            let texels = texels.filter(|texel| is_turned(self.corners(texel.triangle)));
            texels.for_each(|texel| std::mem::swap(&mut texel.w1, &mut texel.w2));
        }
        Ok(())
    }
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
