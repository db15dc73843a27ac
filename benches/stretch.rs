//! What the CPU twin of the stretch kernel reaches on one thread: `cargo bench --bench stretch`.
//!
//! Beside it a plain loop over triangles, both in the order of the mesh and with triangles and vertices shuffled, and a copy of
//! as many bytes as the kernel has to read and write, which is the least that a memory of this speed allows.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use homeo::gpu::Compute;
use homeo::kernel::{Lanes, Stretch, stretch_into};
use rayon::ThreadPoolBuilder;
use std::hint::black_box;
use std::time::Duration;

/// Quads along a side of the grids: 20,000 and 999,698 triangles.
const LADDER: [usize; 2] = [100, 707];

/// A square grid over a hill.
struct Grid {
    triangles: Vec<[u32; 3]>,
    plane: Vec<Lanes>,
    surface: Vec<Lanes>,
}

fn grid(n: usize) -> Grid {
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let plane = |k: usize| {
        let (i, j) = (k / (n + 1), k % (n + 1));
        [i as f32 / n as f32, j as f32 / n as f32, 0.0, 0.0]
    };
    let hill = |&[x, y, ..]: &Lanes| [x, y, (-16.0 * ((x - 0.5).powi(2) + (y - 0.5).powi(2))).exp(), 0.0];
    let halves = |q: usize| {
        let (i, j) = (q / n, q % n);
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    };
    let plane: Vec<Lanes> = (0..(n + 1) * (n + 1)).map(plane).collect();
    Grid { triangles: (0..n * n).flat_map(halves).collect(), surface: plane.iter().map(hill).collect(), plane }
}

/// The same with vertices and triangles in a random order.
fn shuffled(grid: &Grid) -> Grid {
    let order = permutation(grid.plane.len());
    let mut numbers = vec![0; order.len()];
    (0..).zip(&order).for_each(|(new, &old)| numbers[old] = new);
    let moved = |points: &[Lanes]| order.iter().map(|&old| points[old]).collect();
    let renamed = |t: usize| grid.triangles[t].map(|v| numbers[v as usize]);
    Grid {
        triangles: permutation(grid.triangles.len()).into_iter().map(renamed).collect(),
        plane: moved(&grid.plane),
        surface: moved(&grid.surface),
    }
}

/// Fisher and Yates with a congruential generator.
fn permutation(n: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    let mut state = 1u64;
    for i in (1..n).rev() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        order.swap(i, (state >> 33) as usize % (i + 1));
    }
    order
}

/// The plain loop: one triangle after the other, into memory that is there already.
fn plain(grid: &Grid, stretches: &mut [Stretch]) {
    let point = |p: &Lanes| Vec3::new(p[0], p[1], p[2]);
    for (t, stretch) in grid.triangles.iter().zip(stretches) {
        let [a, b, c] = t.map(|v| point(&grid.plane[v as usize]));
        let [d, e, f] = t.map(|v| point(&grid.surface[v as usize]));
        let (u, w, p, q) = (b - a, c - a, e - d, f - d);
        let (twice, image_twice) = (u.cross(w).length(), p.cross(q).length());
        let width = u.length();
        let x = p / width;
        let y = (q - x * (u.dot(w) / width)) * (width / twice);
        let (a, b, c) = (x.dot(x), x.dot(y), y.dot(y));
        let large = (0.5 * (a + c + ((a - c) * (a - c) + 4.0 * b * b).sqrt())).sqrt();
        let small = image_twice / twice / large;
        *stretch = Stretch { large, small, area_from: 0.5 * twice, area_to: 0.5 * image_twice };
    }
}

fn stretches(c: &mut Criterion) {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    for n in LADDER {
        let ordered = grid(n);
        let shuffled = shuffled(&ordered);
        let count = ordered.triangles.len();
        let mut group = c.benchmark_group(format!("stretch of {count} triangles, one thread"));
        group.throughput(Throughput::Elements(count as u64));
        let mut out = vec![Stretch::default(); count];
        for (order, grid) in [("in order", &ordered), ("shuffled", &shuffled)] {
            let Grid { triangles, plane, surface } = grid;
            let mut kernel = || {
                stretch_into(&Compute::Cpu, triangles, plane, surface, black_box(&mut out)).expect("the corners exist");
            };
            group.bench_function(BenchmarkId::new("kernel", order), |b| pool.install(|| b.iter(&mut kernel)));
            group
                .bench_function(BenchmarkId::new("plain loop", order), |b| b.iter(|| plain(grid, black_box(&mut out))));
        }
        let moved = size_of_val(&ordered.triangles[..]) + 2 * size_of_val(&ordered.plane[..]) + size_of_val(&out[..]);
        let from = vec![1u8; moved / 2];
        let mut to = from.clone();
        let name = BenchmarkId::new("copy", format!("{moved} bytes read and written"));
        group.bench_function(name, |b| b.iter(|| black_box(&mut to).copy_from_slice(black_box(&from))));
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(2));
    targets = stretches
}
criterion_main!(benches);
