//! Every kernel on its CPU twin and, where there is one, on the best adapter: `cargo bench --bench kernels`.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
use homeo::gpu::{Compute, Device, DeviceChoice};
use homeo::kernel::vertex_stretch::vertex_stretch;
use homeo::kernel::{self, Lanes, Lists, Piece, Query, RelaxInput, RelaxOptions, RelaxSession, Rings, Sight};
use homeo::mesh::metric;
use homeo::solve::dirichlet::{Metrics, Rest};
use std::hint::black_box;
use std::time::Duration;

/// Quads along a side of the grids.
const LADDER: [usize; 2] = [64, 512];

/// A square grid over a hill: two triangles a quad, the border fixed.
struct Grid {
    triangles: Vec<[u32; 3]>,
    free: Vec<bool>,
    plane: Vec<DVec2>,
    surface: Vec<DVec3>,
}

fn grid(n: usize) -> Grid {
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let points: Vec<(usize, usize)> = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))).collect();
    let plane: Vec<DVec2> = points.iter().map(|&(i, j)| DVec2::new(i as f64, j as f64) / n as f64).collect();
    let inner = |k: usize| 0 < k && k < n;
    let hill = |p: &DVec2| p.extend((-16.0 * p.distance_squared(DVec2::splat(0.5))).exp());
    let quads = points.iter().filter(|&&(i, j)| i < n && j < n);
    let halves = |&(i, j): &(usize, usize)| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    };
    Grid {
        triangles: quads.flat_map(halves).collect(),
        free: points.iter().map(|&(i, j)| inner(i) && inner(j)).collect(),
        surface: plane.iter().map(hill).collect(),
        plane,
    }
}

/// The CPU, and an adapter if there is one; says which.
fn devices() -> Vec<(&'static str, Compute)> {
    let adapter = Device::open(&DeviceChoice::Gpu).ok().map(|device| {
        eprintln!("adapter: {}", device.description);
        ("adapter", device.compute)
    });
    [("CPU", Compute::Cpu)].into_iter().chain(adapter).collect()
}

fn kernels(c: &mut Criterion) {
    let devices = devices();
    for n in LADDER {
        let grid = grid(n);
        let lanes = |p: DVec3| -> Lanes { p.as_vec3().extend(0.0).to_array() };
        let plane: Vec<Lanes> = grid.plane.iter().map(|p| lanes(p.extend(0.0))).collect();
        let surface: Vec<Lanes> = grid.surface.iter().map(|&p| lanes(p)).collect();
        let incident = Lists::incident(plane.len(), &grid.triangles).expect("a grid's corners exist");
        let third = 1.0 / 3.0;
        let query = |&[i0, i1, i2]: &[u32; 3]| Query { i0, i1, i2, w0: third, w1: third, w2: third };
        let queries: Vec<Query> = grid.triangles.iter().map(query).collect();
        for (name, compute) in &devices {
            let mut bench = |kernel: &str, run: &mut dyn FnMut()| {
                let mut group = c.benchmark_group(kernel);
                group.throughput(Throughput::Elements(grid.triangles.len() as u64));
                group.bench_function(BenchmarkId::new(*name, grid.triangles.len()), |b| b.iter(&mut *run));
            };
            let stretch = || kernel::stretch(compute, &grid.triangles, &plane, &surface).expect("the device works");
            bench("stretch", &mut || drop(black_box(stretch())));
            let stretches = stretch();
            let old = vec![1.0; plane.len()];
            bench("vertex stretch", &mut || {
                black_box(vertex_stretch(compute, &incident, &stretches, &old, 1).expect("the device works"));
            });
            bench("resample", &mut || {
                black_box(kernel::resample(compute, &queries, &surface).expect("the device works"));
            });
            let mut session = relaxation(compute, &grid);
            let sweep = RelaxOptions { sweeps: 1, ..RelaxOptions::default() };
            bench("relaxation sweep", &mut || {
                session.run(&sweep).expect("the device works");
                black_box(session.read().expect("the device works"));
            });
            let mut pieces = [moving(&grid)];
            bench("composed sweep", &mut || kernel::sweep_all(compute, &mut pieces, 1).expect("the device works"));
        }
    }
}

fn relaxation<'d>(compute: &'d Compute, grid: &Grid) -> RelaxSession<'d> {
    let rings = Rings::build(&grid.triangles, &grid.free).expect("a grid is a disc");
    let weights = vec![1.0; rings.lists().items.len()];
    let Grid { triangles, plane, surface, .. } = grid;
    let input = RelaxInput { triangles, rings: &rings, weights: &weights, surface, plane };
    RelaxSession::new(compute, &input).expect("the device works")
}

/// Jobs in flight at once.
const JOBS: usize = 8;

/// Sweeps of several jobs: one after the other, and from as many threads, when those that wait go together.
fn jobs(c: &mut Criterion) {
    for n in [8, 16, 64] {
        let grid = grid(n);
        for (name, compute) in &devices() {
            let mut pieces = vec![moving(&grid); JOBS];
            let sweep = |piece: &mut Piece| {
                kernel::sweep_all(compute, std::slice::from_mut(piece), 2).expect("the device works");
            };
            let mut group = c.benchmark_group(format!("{JOBS} jobs of {} triangles", grid.triangles.len()));
            group.bench_function(BenchmarkId::new(*name, "in turn"), |b| b.iter(|| pieces.iter_mut().for_each(sweep)));
            let together = |pieces: &mut [Piece]| {
                std::thread::scope(|scope| {
                    pieces.iter_mut().for_each(|piece| drop(scope.spawn(|| sweep(piece))));
                });
            };
            group.bench_function(BenchmarkId::new(*name, "at once"), |b| b.iter(|| together(&mut pieces)));
        }
    }
}

/// The hill as a mesh that moves over the plane.
fn moving(grid: &Grid) -> Piece {
    let sight = |t: &[u32; 3]| {
        let points = t.map(|v| grid.surface[v as usize]);
        let rest = Rest::new(metric::flatten(points));
        Sight::new(&rest, &Metrics::identity(metric::area(points)), t.map(|v| grid.plane[v as usize]))
    };
    let sights = grid.triangles.iter().map(sight).collect();
    Piece::new(&grid.triangles, sights, &grid.plane, &grid.free).expect("a grid fits together")
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1));
    targets = kernels, jobs
}
criterion_main!(benches);
