//! Texel ownership and interpolation as `homeo bake` does them, beside a plain loop over triangles and their scanlines:
//! `cargo bench --bench texels`.
//!
//! Both draw the positions of a wavy sheet into its texture coordinates, from those coordinates on, into 32-bit floats, on all
//! threads. The plain loop knows neither whose a texel on an edge is, nor overlaps, nor gutters. Both make what they draw into:
//! the plain loop the whole image, the twin a band that it hands over again and again, which is what goes into the file.
//! "plain, again" draws into an image that is there already, and warm, which no job that makes one has.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, Vec2, Vec4};
use homeo::app::canvas::{Canvas, Padding};
use homeo::gpu::Compute;
use homeo::kernel::{Lanes, Texel};
use rayon::prelude::*;
use std::hint::black_box;
use std::time::Duration;

/// Quads along a side of the sheets: 10082, 100352 and 500000 triangles.
const LADDER: [usize; 3] = [71, 224, 500];
/// Texels along a side.
const SIZES: [usize; 2] = [1024, 4096];
/// The sheet keeps this far from the border of texture space.
const MARGIN: f64 = 0.02;

/// Texture coordinates, v up, and positions by triangle.
struct Sheet {
    uv: Vec<[DVec2; 3]>,
    values: Vec<[Lanes; 3]>,
}

/// A sheet of `n` x `n` quads whose inner vertices are off the grid, so that no edge runs along a row of texels.
fn sheet(n: usize) -> Sheet {
    let off = |i: usize, k: usize| {
        let inner = !i.is_multiple_of(n);
        let noise = ((i * 7919 + k * 104_729) % 1009) as f64 / 1009.0 - 0.5;
        if inner { 0.4 * noise } else { 0.0 }
    };
    let point = |i: usize, j: usize| DVec2::new(i as f64 + off(i, j), j as f64 + off(j, i + 31)) / n as f64;
    let quad = |q: usize| {
        let (i, j) = (q % n, q / n);
        let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles: Vec<[DVec2; 3]> = (0..n * n).flat_map(quad).collect();
    let position = |p: &DVec2| [p.x as f32, p.y as f32, 0.1 * ((9.0 * p.x).sin() * (7.0 * p.y).sin()) as f32, 0.0];
    let place = |p: DVec2| DVec2::splat(MARGIN) + p * (1.0 - 2.0 * MARGIN);
    Sheet {
        values: triangles.iter().map(|t| t.each_ref().map(position)).collect(),
        uv: triangles.iter().map(|t| t.map(place)).collect(),
    }
}

/// What `bake` does for a position map without gutters; the texels tell the mask.
fn twin(sheet: &Sheet, size: usize, mut look: impl FnMut(&[Texel])) {
    let canvas = Canvas::new(size, size, &sheet.uv);
    let bands = canvas.bands(&Compute::Cpu, Padding::Texels(0), Some(&sheet.values), |band| {
        black_box(&band.pixels);
        look(&band.texels);
        Ok(())
    });
    bands.expect("the CPU works");
}

/// The plain loop: a share of the rows of an empty image for every thread, which goes through all triangles.
fn plain(sheet: &Sheet, size: usize, image: &mut [Lanes]) -> usize {
    let rows = size.div_ceil(rayon::current_num_threads());
    let shares = image.par_chunks_mut(rows * size).enumerate();
    shares.map(|(share, pixels)| scan(sheet, size, share * rows, pixels)).sum()
}

/// Draws all triangles into some rows from `first` on: values by barycentric weights, 1 in the last lane where there are any.
fn scan(sheet: &Sheet, size: usize, first: usize, pixels: &mut [Lanes]) -> usize {
    let last = (pixels.len() / size) as f32 - 1.0;
    let mut covered = 0;
    for (uv, values) in sheet.uv.iter().zip(&sheet.values) {
        let offset = DVec2::new(0.5, first as f64 + 0.5);
        let [a, b, c] = uv.map(|p| (DVec2::new(p.x, 1.0 - p.y) * size as f64 - offset).as_vec2());
        let (top, bottom) = (a.y.min(b.y).min(c.y).ceil().max(0.0), a.y.max(b.y).max(c.y).floor().min(last));
        if top > bottom {
            continue;
        }
        let [p, q, r] = values.map(Vec4::from_array);
        let area = (b - a).perp_dot(c - a);
        let (by_x, by_y) = (Vec2::new(c.y - a.y, a.y - b.y) / area, Vec2::new(a.x - c.x, b.x - a.x) / area);
        for row in top as usize..=bottom as usize {
            let [low, high] = span([a, b, c], row as f32);
            let (start, end) = (low.ceil().max(0.0), high.floor().min(size as f32 - 1.0));
            if start > end {
                continue;
            }
            let line = &mut pixels[row * size..][start as usize..=end as usize];
            covered += line.len();
            let mut weights = by_x * (start - a.x) + by_y * (row as f32 - a.y);
            for pixel in line {
                let value = p * (1.0 - weights.x - weights.y) + q * weights.x + r * weights.y;
                *pixel = value.with_w(1.0).to_array();
                weights += by_x;
            }
        }
    }
    covered
}

/// Where a horizontal line enters and leaves a triangle.
fn span([a, b, c]: [Vec2; 3], y: f32) -> [f32; 2] {
    let mut reach = [f32::INFINITY, f32::NEG_INFINITY];
    for [p, q] in [[a, b], [b, c], [c, a]] {
        if (p.y <= y) != (q.y <= y) {
            let x = p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
            reach = [reach[0].min(x), reach[1].max(x)];
        }
    }
    reach
}

fn texels(c: &mut Criterion) {
    for size in SIZES {
        let mut group = c.benchmark_group(format!("position map {size} x {size}"));
        group.throughput(Throughput::Elements((size * size) as u64));
        for n in LADDER {
            let sheet = sheet(n);
            let mut image = vec![[0.0; 4]; size * size];
            let mut ours = 0;
            twin(&sheet, size, |texels| ours += texels.iter().filter(|t| t.covers > 0).count());
            let theirs = plain(&sheet, size, &mut image);
            assert!(ours.abs_diff(theirs) < ours / 50, "{ours} texels of the twin, {theirs} of the plain loop");
            group.bench_function(BenchmarkId::new("twin", sheet.uv.len()), |b| {
                b.iter(|| twin(&sheet, size, |texels| _ = black_box(texels.len())))
            });
            group.bench_function(BenchmarkId::new("plain", sheet.uv.len()), |b| {
                b.iter(|| plain(&sheet, size, black_box(&mut vec![[0.0; 4]; size * size])))
            });
            group.bench_function(BenchmarkId::new("plain, again", sheet.uv.len()), |b| {
                b.iter(|| {
                    image.fill([0.0; 4]);
                    plain(&sheet, size, black_box(&mut image))
                });
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    targets = texels
}
criterion_main!(benches);
