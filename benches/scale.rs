//! How the time of a whole map grows with the meshes at equal landmarks: `cargo bench --bench scale -- 500000`.
//!
//! Pairs of quadrupeds of different build, from 5,000 triangles of the source by half decades up to as many as asked for
//! (50,000 unless said otherwise), each mapped once with the default options on all threads. Printed: seconds, and the
//! exponent from each size to the next and over all.

use homeo::gpu::{Device, DeviceChoice};
use homeo::mesh::VertexId;
use homeo::pipeline::{MapOptions, Mapped, Silent, map_pairs};
use homeo::shape::{DEMO_PAIRS, Shape};
use homeo::stage::load::Loaded;
use std::time::Instant;

/// Triangles of the smallest source.
const SMALLEST: f64 = 5_000.0;
/// From size to size.
const STEP: f64 = 3.162_277_660_168_379_5;
/// Triangles of the largest source unless said otherwise.
const LARGEST: f64 = 50_000.0;

fn map(source: &Shape, target: &Shape) -> Mapped {
    let landmarks: [Vec<VertexId>; 2] = [source, target].map(|shape| shape.landmarks.iter().map(|&(_, v)| v).collect());
    let pair = Loaded::of([&source.mesh, &target.mesh], [&landmarks[0], &landmarks[1]]);
    let device = Device::open(&DeviceChoice::Cpu).expect("the CPU is there");
    let mut mapped = None;
    map_pairs(std::iter::once(pair), &MapOptions::default(), &device, &Silent, |outcome| mapped = Some(outcome.value));
    mapped.expect("one pair has one outcome").expect("quadrupeds are mapped")
}

fn exponent((size, seconds): (f64, f64), (larger, longer): (f64, f64)) -> f64 {
    (longer / seconds).ln() / (larger / size).ln()
}

fn main() {
    let asked = std::env::args().skip(1).find_map(|arg| arg.parse::<f64>().ok());
    let quadrupeds = DEMO_PAIRS.iter().find(|pair| pair.genus == 0).expect("the demo maps a pair of genus 0");
    let mut rows: Vec<(f64, f64)> = Vec::new();
    let mut size = SMALLEST;
    println!("triangles  seconds  energy  exponent");
    while size <= asked.unwrap_or(LARGEST) * 1.01 {
        let (source, target) = (quadrupeds.generate)((0.5 * size) as usize);
        let triangles = source.mesh.conn.face_count() as f64;
        let start = Instant::now();
        let mapped = map(&source, &target);
        rows.push((triangles, start.elapsed().as_secs_f64()));
        let energy = mapped.relaxation.polish.last().copied().unwrap_or(f64::NAN);
        let since =
            rows.len().checked_sub(2).map_or(String::new(), |k| format!("{:8.2}", exponent(rows[k], rows[k + 1])));
        println!("{triangles:9.0}  {:7.1}  {energy:6.3}  {since}", rows[rows.len() - 1].1);
        size *= STEP;
    }
    if let [first, .., last] = rows[..] {
        println!("exponent over all: {:.2}", exponent(first, last));
    }
}
