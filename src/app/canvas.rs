//! An image over a mesh's texture coordinates: which triangle every texel shows, in bands of rows from the top.
//!
//! Texel (i, j) has its centre at u = (i + 0.5) / width, v = 1 - (j + 0.5) / height. Texels that no triangle covers show
//! the nearest one that is covered, as far as the padding goes. Only one band is held at a time, and beside it for every
//! column the places where it enters the covered part, so that images may be larger than the memory.

use super::gutter::Gutter;
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::kernel::{FlatTriangle, NO_TRIANGLE, Texel, texels};
use crate::stage::exr::BLOCK_ROWS;
use glam::{DMat2, DVec2};
use rayon::prelude::*;

/// The largest side of an image, in texels.
pub const LARGEST: usize = 16384;
/// Rows of a band: whole blocks of EXR files, enough of them to keep the cores busy.
const BAND: usize = 4 * BLOCK_ROWS;
/// Windows in which triangles are drawn at once: small enough for the cache and for f32, large enough for few triangles to
/// lie in several.
const WINDOW: [usize; 2] = [1024, BLOCK_ROWS];

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
pub struct Canvas {
    width: usize,
    height: usize,
    /// Corners in texels, y downwards.
    triangles: Vec<[DVec2; 3]>,
    /// For every window of the image, row by row, the triangles whose bounding box meets it, in order.
    windows: Vec<Vec<u32>>,
}

impl Canvas {
    /// Prepares an image of `width` x `height` texels over triangles of texture coordinates in the unit square, v up. Triangles
    /// without area, or with a coordinate that is not finite, cover nothing.
    pub fn new(width: usize, height: usize, uv: &[[DVec2; 3]]) -> Canvas {
        let size = DVec2::new(width as f64, height as f64);
        let place = |p: DVec2| DVec2::new(p.x, 1.0 - p.y) * size;
        let triangles: Vec<[DVec2; 3]> = uv.iter().map(|t| t.map(place)).collect();
        let mut canvas = Canvas { width, height, triangles, windows: Vec::new() };
        canvas.windows = canvas.bins();
        canvas
    }

    /// The derivative of the weights of a triangle's second and third corner by steps of a texel to the right and down.
    pub fn weights_by_texel(&self, triangle: u32) -> DMat2 {
        let [a, b, c] = self.triangles[triangle as usize];
        DMat2::from_cols(b - a, c - a).inverse()
    }

    fn columns(&self) -> usize {
        self.width.div_ceil(WINDOW[0])
    }

    fn bins(&self) -> Vec<Vec<u32>> {
        let (columns, rows) = (self.columns(), self.height.div_ceil(WINDOW[1]));
        let mut windows = vec![Vec::new(); columns * rows];
        for (t, corners) in (0u32..).zip(&self.triangles) {
            let low = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
            let high = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
            let is_drawn = corners.iter().all(|p| p.is_finite()) && double_area(*corners) != 0.0;
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
    pub fn bands(&self, compute: &Compute, padding: Padding, mut visit: impl FnMut(Band) -> Result<()>) -> Result<()> {
        let mut gutter = match padding {
            Padding::Texels(0) => None,
            _ => Some(Gutter::new(self.width, padding.limit(), self.drawn(compute))?),
        };
        for band in self.drawn(compute) {
            let mut band = band?;
            if let Some(gutter) = &mut gutter {
                gutter.fill(&mut band);
            }
            visit(band)?;
        }
        Ok(())
    }

    /// All bands without gutters.
    fn drawn(&self, compute: &Compute) -> impl Iterator<Item = Result<Band>> {
        (0..self.height).step_by(BAND).map(|first_row| self.draw(compute, first_row))
    }

    /// Draws the triangles in a band.
    fn draw(&self, compute: &Compute, first_row: usize) -> Result<Band> {
        let rows = BAND.min(self.height - first_row);
        let columns = self.columns();
        let places: Vec<[usize; 2]> = (first_row..first_row + rows)
            .step_by(WINDOW[1])
            .flat_map(|y| (0..columns).map(move |c| [c * WINDOW[0], y]))
            .collect();
        let drawn: Vec<Vec<Texel>> =
            places.par_iter().map(|&[x, y]| self.draw_window(compute, x, y)).collect::<Result<_>>()?;
        let mut texels = vec![Texel::EMPTY; self.width * rows];
        for (&[x, y], window) in places.iter().zip(&drawn) {
            let width = WINDOW[0].min(self.width - x);
            for (row, line) in window.chunks(width).enumerate() {
                let at = (y - first_row + row) * self.width + x;
                texels[at..at + width].copy_from_slice(line);
            }
        }
        Ok(Band { first_row, rows, texels })
    }

    fn draw_window(&self, compute: &Compute, x: usize, y: usize) -> Result<Vec<Texel>> {
        let list = &self.windows[y / WINDOW[1] * self.columns() + x / WINDOW[0]];
        let origin = DVec2::new(x as f64, y as f64);
        let mut turned = Vec::with_capacity(list.len());
        let flat = |&t: &u32| {
            let mut corners = self.triangles[t as usize];
            let is_turned = double_area(corners) < 0.0;
            if is_turned {
                corners.swap(1, 2);
            }
            turned.push(is_turned);
            let [a, b, c] = corners.map(|p| (p - origin).as_vec2());
            FlatTriangle { ax: a.x, ay: a.y, bx: b.x, by: b.y, cx: c.x, cy: c.y }
        };
        let triangles: Vec<FlatTriangle> = list.iter().map(flat).collect();
        let (width, height) = (WINDOW[0].min(self.width - x), WINDOW[1].min(self.height - y));
        let mut window = texels(compute, width as u32, height as u32, &triangles)?;
        for texel in window.iter_mut().filter(|texel| texel.triangle != NO_TRIANGLE) {
            let local = texel.triangle as usize;
            texel.triangle = list[local];
            if turned[local] {
                std::mem::swap(&mut texel.w1, &mut texel.w2);
            }
        }
        Ok(window)
    }
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
