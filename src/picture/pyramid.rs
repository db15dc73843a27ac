//! Trilinear sampling: an image and its halvings (L. Williams, "Pyramidal parametrics", SIGGRAPH 1983).

use super::file::Picture;
use glam::{DVec2, Vec4};
use rayon::prelude::*;

/// An image at every resolution.
#[derive(Clone, Debug)]
pub struct Pyramid {
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    width: usize,
    height: usize,
    pixels: Vec<Vec4>,
}

impl Pyramid {
    /// All halvings of an image.
    pub fn new(picture: &Picture) -> Pyramid {
        let pixels = picture.pixels.iter().map(|&p| Vec4::from_array(p)).collect();
        let mut levels = vec![Level { width: picture.width, height: picture.height, pixels }];
        while let Some(half) = levels.last().and_then(Level::half) {
            levels.push(half);
        }
        Pyramid { levels }
    }

    /// Size of the image.
    pub fn size(&self) -> DVec2 {
        DVec2::new(self.levels[0].width as f64, self.levels[0].height as f64)
    }

    /// The image at texture coordinates, v up, repeated beyond the unit square; averaged over about `footprint` pixels.
    pub fn sample(&self, uv: DVec2, footprint: f64) -> [f32; 4] {
        let last = self.levels.len() - 1;
        // Phrased so that a footprint that is not a number takes the image itself.
        let level = if footprint > 1.0 { footprint.log2().min(last as f64) } else { 0.0 };
        let (fine, share) = (level.floor() as usize, level.fract() as f32);
        let near = self.levels[fine].sample(uv);
        if share == 0.0 {
            return near.to_array();
        }
        near.lerp(self.levels[fine + 1].sample(uv), share).to_array()
    }
}

impl Level {
    /// Half as wide and high, at least one pixel; none of a single pixel.
    fn half(&self) -> Option<Level> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        // Where a side is odd, or one, pixels of the finer level are shared.
        let range = |i: usize, fine: usize, coarse: usize| i * fine / coarse..((i + 1) * fine).div_ceil(coarse);
        let mean = |i: usize| {
            let (xs, ys) = (range(i % width, self.width, width), range(i / width, self.height, height));
            let count = (xs.len() * ys.len()) as f32;
            let sum: Vec4 = ys.flat_map(|y| xs.clone().map(move |x| self.pixels[y * self.width + x])).sum();
            sum / count
        };
        Some(Level { width, height, pixels: (0..width * height).into_par_iter().map(mean).collect() })
    }

    /// Bilinear between pixel centres.
    fn sample(&self, uv: DVec2) -> Vec4 {
        let at = |x: f64, size: usize| {
            let x = x.rem_euclid(1.0) * size as f64 - 0.5;
            let first = x.floor();
            let wrap = |i: f64| (i.rem_euclid(size as f64) as usize).min(size - 1);
            (wrap(first), wrap(first + 1.0), (x - first) as f32)
        };
        let (x0, x1, s) = at(uv.x, self.width);
        let (y0, y1, t) = at(1.0 - uv.y, self.height);
        let pixel = |x: usize, y: usize| self.pixels[y * self.width + x];
        pixel(x0, y0).lerp(pixel(x1, y0), s).lerp(pixel(x0, y1).lerp(pixel(x1, y1), s), t)
    }
}
