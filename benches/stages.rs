//! One bench per stage of the main job, over a ladder of mesh sizes: `cargo bench --bench stages -- layout/2000`.
//!
//! The pair is generated: two quadrupeds of different build, the target with four fifths of the source's vertices.

use criterion::{BatchSize, BenchmarkId, Criterion, criterion_group, criterion_main};
use homeo::gpu::Compute;
use homeo::mesh::{TriMesh, VertexId};
use homeo::path::front::front;
use homeo::shape::fixture::icosphere;
use homeo::shape::{DEMO_PAIRS, random_landmarks};
use homeo::stage::check::Guides;
use homeo::stage::cluster::BaseVertices;
use homeo::stage::relax::{RelaxOptions, relax_arcs};
use homeo::stage::{cluster, compose, embed, layout, stretch, trace};
use std::hint::black_box;
use std::time::Duration;

/// Vertices of the source.
const LADDER: [usize; 2] = [1_000, 4_000];
/// Least number of nodes on an edge that arcs may cross it at, as in the main job.
const EDGE_NODES: u32 = 3;

/// Sources of a front.
const SITES: usize = 100;

/// Meshes and landmarks.
struct Pair {
    meshes: [TriMesh; 2],
    landmarks: [Vec<VertexId>; 2],
}

fn pair(size: usize) -> Pair {
    let quadrupeds = DEMO_PAIRS.iter().find(|pair| pair.genus == 0).expect("the demo maps a pair of genus 0");
    let (source, target) = (quadrupeds.generate)(size);
    let landmarks = [&source, &target].map(|shape| shape.landmarks.iter().map(|&(_, v)| v).collect());
    Pair { meshes: [source.mesh, target.mesh], landmarks }
}

/// Fronts from a hundred sites over spheres of 20,480 to 1,310,720 triangles.
fn fronts(c: &mut Criterion) {
    for subdivisions in [5, 6, 7, 8] {
        let mesh = icosphere(subdivisions);
        let sites = random_landmarks(&mesh, SITES, 1);
        let mut group = c.benchmark_group("front");
        let id = BenchmarkId::from_parameter(mesh.conn.face_count());
        group.bench_function(id, |b| b.iter(|| black_box(front(&mesh, &sites))));
    }
}

fn stages(c: &mut Criterion) {
    for size in LADDER {
        let Pair { meshes, landmarks } = pair(size);
        let meshes = meshes.each_ref();
        let landmarks = [&landmarks[0][..], &landmarks[1][..]];
        let mut bench = |name: &str, run: &mut dyn FnMut()| {
            let mut group = c.benchmark_group(name);
            group.bench_function(BenchmarkId::from_parameter(size), |b| b.iter(&mut *run));
        };
        bench("cluster", &mut || drop(black_box(cluster::cluster(meshes, landmarks, &Guides::default()))));
        let sets = cluster::cluster(meshes, landmarks, &Guides::default());
        let BaseVertices { vertices, clusters, given, .. } = &sets[0];
        let traced =
            || trace::trace(meshes[0], &vertices[0], &given[0], &clusters[0], EDGE_NODES).expect("arcs are traced");
        bench("trace", &mut || drop(black_box(traced())));
        let laid_out = || {
            let layouts = layout::layouts(meshes, &sets, EDGE_NODES, 1);
            layouts.expect("a pair of genus 0 has a layout").swap_remove(0)
        };
        bench("layout", &mut || drop(black_box(laid_out())));
        let layout = laid_out();
        let embedding = || embed::embed(meshes, layout.clone()).expect("patches embed").0;
        bench("embed", &mut || drop(black_box(embedding())));
        relaxations(c, size, meshes, &embedding());
    }
}

/// The stages that change an embedding in place, and the map at the end.
fn relaxations(c: &mut Criterion, size: usize, meshes: [&TriMesh; 2], start: &homeo::map::embedding::Embedding) {
    let once = RelaxOptions { coarse_rounds: 1, fine_rounds: 0, ..RelaxOptions::default() };
    let id = || BenchmarkId::from_parameter(size);
    c.benchmark_group("stretch").bench_function(id(), |b| {
        let run = |mut e| stretch::stretch(&Compute::Cpu, &mut e).expect("the CPU is always there");
        b.iter_batched(|| start.clone(), run, BatchSize::LargeInput);
    });
    c.benchmark_group("relax, one round").bench_function(id(), |b| {
        let run = |mut e| relax_arcs(&Compute::Cpu, meshes, &mut e, &once).expect("arcs relax");
        b.iter_batched(|| start.clone(), run, BatchSize::LargeInput);
    });
    c.benchmark_group("compose").bench_function(id(), |b| {
        let run = |e| compose::compose(meshes, e).expect("embeddings compose");
        b.iter_batched(|| start.clone(), run, BatchSize::LargeInput);
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1));
    targets = fronts, stages
}
criterion_main!(benches);
