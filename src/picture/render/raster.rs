//! The z-buffer: which triangle is nearest at every sample.

use super::camera::Projected;
use crate::mesh::{Id, VertexId};
use glam::DVec2;

/// What a sample shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// The nearest triangle.
    pub triangle: Option<u32>,
    /// How near it is there.
    pub nearness: f64,
}

/// Triangles in the picture, listed by the bands that they meet.
pub(super) struct Raster {
    corners: Vec<[Projected; 3]>,
    bands: Vec<Vec<u32>>,
    size: [usize; 2],
    /// Rows of samples in a band.
    rows: usize,
}

impl Raster {
    /// Prepares the bands of a picture of `size` samples. Of faces at the same depth the first one shows.
    pub fn new(triangles: &[[VertexId; 3]], points: &[Projected], size: [usize; 2], rows: usize) -> Self {
        let corners: Vec<[Projected; 3]> = triangles.iter().map(|t| t.map(|v| points[v.index()])).collect();
        let mut bands = vec![Vec::new(); size[1].div_ceil(rows)];
        for (t, corners) in (0u32..).zip(&corners) {
            let ys = corners.map(|c| c.at.y);
            let (low, high) = (ys[0].min(ys[1]).min(ys[2]), ys[0].max(ys[1]).max(ys[2]));
            if low < size[1] as f64 && high > 0.0 {
                let last = (high as usize / rows).min(bands.len() - 1);
                (low as usize / rows..=last).for_each(|band| bands[band].push(t)); // casts clamp at zero
            }
        }
        Raster { corners, bands, size, rows }
    }

    /// The first row of samples of a band.
    pub fn first_row(&self, band: usize) -> usize {
        band * self.rows
    }

    /// The centre of sample number `i` of a band.
    pub fn place(&self, band: usize, i: usize) -> DVec2 {
        let (x, y) = (i % self.size[0], self.first_row(band) + i / self.size[0]);
        DVec2::new(x as f64 + 0.5, y as f64 + 0.5)
    }

    /// The samples of a band, row by row.
    pub fn band(&self, band: usize) -> Vec<Hit> {
        let first = self.first_row(band);
        let rows = self.rows.min(self.size[1] - first);
        let mut hits = vec![Hit { triangle: None, nearness: f64::NEG_INFINITY }; rows * self.size[0]];
        for &t in &self.bands[band] {
            self.draw(t, first, rows, &mut hits);
        }
        hits
    }

    fn draw(&self, t: u32, first: usize, rows: usize, hits: &mut [Hit]) {
        let corners = &self.corners[t as usize];
        let low = corners[0].at.min(corners[1].at).min(corners[2].at);
        let high = corners[0].at.max(corners[1].at).max(corners[2].at);
        let end = |x: f64, most: usize| ((x + 0.5).floor().max(0.0) as usize).min(most);
        let (x0, x1) = (end(low.x, self.size[0]), end(high.x, self.size[0]));
        let (y0, y1) = (end(low.y - first as f64, rows), end(high.y - first as f64, rows));
        for y in y0..y1 {
            for x in x0..x1 {
                let p = DVec2::new(x as f64 + 0.5, (first + y) as f64 + 0.5);
                let Some(w) = weights(corners, p) else { continue };
                let nearness = (0..3).map(|k| w[k] * corners[k].nearness).sum::<f64>();
                let hit = &mut hits[y * self.size[0] + x];
                if nearness > hit.nearness {
                    *hit = Hit { triangle: Some(t), nearness };
                }
            }
        }
    }
}

/// The weights of a triangle's corners at a point of the picture; none outside, or if it has no area there.
pub(super) fn weights(corners: &[Projected; 3], p: DVec2) -> Option<[f64; 3]> {
    let [a, b, c] = corners.map(|corner| corner.at);
    let areas = [(b - p).perp_dot(c - p), (c - p).perp_dot(a - p), (a - p).perp_dot(b - p)];
    let sum: f64 = areas.iter().sum();
    let shares = areas.map(|x| x / sum);
    shares.iter().all(|&w| w >= 0.0).then_some(shares)
}
