//! Pictures of meshes for previews: a z-buffer on the CPU that needs neither a compute device nor a display.
//!
//! ```text
//! Scene   surface with paint, lines, dots     scene
//!   | camera      where it is seen from        camera
//!   | raster      the nearest face per sample  raster
//!   | shade       paint, light                 shade
//!   | overlay     lines and dots               overlay
//!   v mean of SAMPLES x SAMPLES samples
//! Picture --- contact_sheet                    sheet
//! ```
//!
//! Bands of rows are drawn on their own, every one with all its triangles in order, so that the bytes do not depend on the
//! number of threads. Colours are linear light; [`Picture::write`] encodes them.

mod camera;
mod overlay;
mod raster;
mod scene;
mod shade;
mod sheet;

pub use camera::{Camera, Lens, View};
pub use scene::{Color, Dot, Line, Paint, Scene, color};
pub use sheet::contact_sheet;

use super::file::{Depth, Picture};
use camera::Projected;
use overlay::Overlay;
use raster::{Hit, Raster};
use rayon::prelude::*;
use scene::BACKGROUND;
use shade::Shader;

/// Samples along a pixel's side; fewer leave stairs at the outline, more cost time by their square.
const SAMPLES: usize = 3;
/// Rows of pixels in a band: enough to share triangles, few enough to occupy all threads.
const BAND: usize = 16;

/// Draws a scene, `size` pixels wide and high, before a light grey background.
pub fn render(scene: &Scene, camera: &Camera, size: [usize; 2]) -> Picture {
    let [width, height] = size;
    let fine = [width * SAMPLES, height * SAMPLES];
    let corners: Vec<Projected> = camera.project(scene.positions, fine);
    let raster = Raster::new(scene.triangles, &corners, fine, BAND * SAMPLES);
    let shader = Shader::new(scene, camera, &corners);
    let overlay = Overlay::new(scene, camera, fine, SAMPLES as f64);
    let bands: Vec<usize> = (0..height.div_ceil(BAND)).collect();
    let draw = |&band: &usize| {
        let hits = raster.band(band);
        let mut samples: Vec<Color> = (0..).zip(&hits).map(|(i, hit)| sample(&raster, &shader, band, i, hit)).collect();
        overlay.draw(raster.first_row(band), fine[0], &hits, &mut samples);
        mean_of_blocks(&samples, fine[0])
    };
    let pixels = bands.par_iter().flat_map_iter(draw).collect();
    Picture { width, height, channels: 3, depth: Depth::Byte, pixels }
}

/// The colour of sample number `i` of a band.
fn sample(raster: &Raster, shader: &Shader, band: usize, i: usize, hit: &Hit) -> Color {
    match hit.triangle {
        Some(t) => shader.color(t, raster.place(band, i)),
        None => BACKGROUND,
    }
}

/// Pixels, row by row, as means of their samples.
fn mean_of_blocks(samples: &[Color], width: usize) -> Vec<[f32; 4]> {
    let share = 1.0 / (SAMPLES * SAMPLES) as f32;
    let pixel = |y: usize, x: usize| {
        let mut sum = [0.0f32; 3];
        for i in 0..SAMPLES * SAMPLES {
            let at = samples[(y * SAMPLES + i / SAMPLES) * width + x * SAMPLES + i % SAMPLES];
            (0..3).for_each(|k| sum[k] += at[k]);
        }
        [sum[0] * share, sum[1] * share, sum[2] * share, 1.0]
    };
    let (rows, columns) = (samples.len() / width / SAMPLES, width / SAMPLES);
    (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))).map(|(y, x)| pixel(y, x)).collect()
}
