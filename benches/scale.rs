//! How the time of a whole map grows with the meshes at equal landmarks: `cargo bench --bench scale -- 500000 [--shuffled]`.
//!
//! Pairs of quadrupeds of different build, from 10,000 triangles of the source by half decades up to as many as asked for
//! (100,000 unless said otherwise), each mapped once with the default options on all threads. Printed: the seconds of every
//! stage and of all, the energy, the exponent from each size to the next and over all, the most memory that the process has
//! held so far. `--shuffled` maps every pair once more, its vertices and faces in a random order.

use homeo::gpu::{Device, DeviceChoice};
use homeo::mesh::{Id, TriMesh, VertexId};
use homeo::pipeline::{MapOptions, Silent, map_pairs};
use homeo::shape::{DEMO_PAIRS, Shape, SplitMix};
use homeo::stage::load::Loaded;
use std::collections::BTreeMap;

/// Triangles of the smallest source.
const SMALLEST: f64 = 10_000.0;
/// From size to size.
const STEP: f64 = 3.162_277_660_168_379_5;
/// Triangles of the largest source unless said otherwise.
const LARGEST: f64 = 100_000.0;

/// A mesh and its landmarks.
struct Side {
    mesh: TriMesh,
    landmarks: Vec<VertexId>,
}

impl Side {
    fn of(shape: Shape) -> Side {
        Side { mesh: shape.mesh, landmarks: shape.landmarks.iter().map(|&(_, v)| v).collect() }
    }

    /// The same surface with vertices, and faces, in a random order.
    fn shuffled(&self, seed: u64) -> Side {
        let order = permutation(self.mesh.positions.len(), seed);
        let mut numbers = vec![VertexId(0); order.len()];
        order.iter().enumerate().for_each(|(new, &old)| numbers[old] = VertexId::new(new));
        let faces = self.mesh.faces();
        let renamed = |f: usize| faces[f].map(|v| numbers[v.index()]);
        let faces: Vec<[VertexId; 3]> = permutation(faces.len(), seed + 1).into_iter().map(renamed).collect();
        let positions = order.iter().map(|&old| self.mesh.positions.raw[old]).collect();
        Side {
            mesh: TriMesh::new(positions, &faces).expect("the same surface"),
            landmarks: self.landmarks.iter().map(|v| numbers[v.index()]).collect(),
        }
    }
}

/// Fisher and Yates.
fn permutation(n: usize, seed: u64) -> Vec<usize> {
    let (mut random, mut order) = (SplitMix::new(seed), (0..n).collect::<Vec<usize>>());
    (1..n).rev().for_each(|i| order.swap(i, random.below(i + 1)));
    order
}

/// The seconds of all stages and `total`, and the map's energy.
fn map([source, target]: &[Side; 2]) -> (BTreeMap<&'static str, f64>, f64) {
    let pair = Loaded::of([&source.mesh, &target.mesh], [&source.landmarks, &target.landmarks]);
    let device = Device::open(&DeviceChoice::Cpu).expect("the CPU is there");
    let mut result = None;
    map_pairs(std::iter::once(pair), &MapOptions::default(), &device, &Silent, |outcome| {
        let mapped = outcome.value.expect("quadrupeds are mapped");
        result = Some((outcome.seconds, mapped.relaxation.polish.last().copied().unwrap_or(f64::NAN)));
    });
    result.expect("one pair has one outcome")
}

fn exponent((size, seconds): (f64, f64), (larger, longer): (f64, f64)) -> f64 {
    (longer / seconds).ln() / (larger / size).ln()
}

/// The most memory held so far, where the system tells.
fn peak() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kilobytes =
        status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse().ok());
    kilobytes.map_or(String::new(), |k: f64| format!("{:6.0} MiB", k / 1024.0))
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let asked = arguments.iter().find_map(|arg| arg.parse::<f64>().ok()).unwrap_or(LARGEST);
    let with_shuffled = arguments.iter().any(|arg| arg == "--shuffled");
    let quadrupeds = DEMO_PAIRS.iter().find(|pair| pair.genus == 0).expect("the demo maps a pair of genus 0");
    let mut rows: Vec<(f64, f64)> = Vec::new();
    let mut size = SMALLEST;
    while size <= asked * 1.01 {
        let (source, target) = (quadrupeds.generate)((0.5 * size) as usize);
        let pair = [Side::of(source), Side::of(target)];
        let triangles = pair[0].mesh.conn.face_count() as f64;
        let (mut seconds, energy) = map(&pair);
        let total = seconds.remove("total").unwrap_or(f64::NAN);
        rows.push((triangles, total));
        let since = rows
            .len()
            .checked_sub(2)
            .map_or(String::new(), |k| format!("  exponent {:.2}", exponent(rows[k], rows[k + 1])));
        println!("{triangles:9.0} triangles {total:7.2} s  energy {energy:.3}  {}{since}", peak());
        let stages: Vec<String> =
            seconds.iter().filter(|(_, s)| **s >= 0.005).map(|(stage, s)| format!("{stage} {s:.2}")).collect();
        println!("          {}", stages.join("  "));
        if with_shuffled {
            let (seconds, energy) = map(&[pair[0].shuffled(1), pair[1].shuffled(3)]);
            println!(
                "          shuffled {:.2} s, {:.2} times that; energy {energy:.3}",
                seconds["total"],
                seconds["total"] / total
            );
        }
        size *= STEP;
    }
    if let [first, .., last] = rows[..] {
        println!("exponent over all: {:.2}", exponent(first, last));
    }
}
