//! The four fronts of the diffusion parametrization: `cargo bench --bench diffusion`.
//!
//! DIFFUSION 3 took 224 ms for a human of 11k vertices and 68 ms for a cow of 3.1k. Here both are generated: a piece of a
//! rippled surface whose fronts start from its four sides, on one thread. `graph` is what all fronts share.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use homeo::path::side_front::{FrontGraph, Travel};
use homeo::shape::fixture;
use std::hint::black_box;

/// Squares along the sides: 11,024 and 3,135 vertices.
const SIZES: [[u32; 2]; 2] = [[103, 105], [54, 56]];

/// A piece of a surface and its four sides.
struct Piece {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    sides: [Vec<u32>; 4],
}

fn piece([n, m]: [u32; 2]) -> Piece {
    let mesh = fixture::plane(n, m);
    let on = |x: f64, y: f64| {
        let vertices = (0u32..).zip(mesh.positions.iter());
        vertices.filter(|(_, p)| p.x == x || p.y == y).map(|(v, _)| v).collect::<Vec<u32>>()
    };
    let sides = [on(0.0, -1.0), on(f64::from(n), -1.0), on(-1.0, 0.0), on(-1.0, f64::from(m))];
    let ripple = |p: &DVec3| {
        let shift = DVec3::new((p.y * 1.3).sin(), (p.x * 1.7).sin(), 0.0) * 0.2;
        *p + shift + DVec3::Z * (8.0 * (p.x * 0.07).sin() * (p.y * 0.09).cos())
    };
    let points = mesh.positions.iter().map(ripple).collect();
    Piece { points, triangles: mesh.faces().iter().map(|t| t.map(|v| v.0)).collect(), sides }
}

fn fronts(c: &mut Criterion) {
    let mut group = c.benchmark_group("diffusion");
    for size in SIZES {
        let Piece { points, triangles, sides } = piece(size);
        let name = |what: &str| BenchmarkId::new(what, points.len());
        group.bench_function(name("graph"), |b| b.iter(|| FrontGraph::new(black_box(&points), &triangles)));
        let graph = FrontGraph::new(&points, &triangles);
        for (what, travel) in [("four_fronts_face", Travel::Faces), ("four_fronts_edge", Travel::Edges)] {
            group.bench_function(name(what), |b| {
                b.iter(|| sides.iter().map(|side| graph.distances(black_box(side), travel)).collect::<Vec<_>>());
            });
        }
    }
    group.finish();
}

criterion_group!(benches, fronts);
criterion_main!(benches);
