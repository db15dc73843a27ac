//! Random hard constraints on generated discs, for the tests and the bench.

use glam::DVec2;
use homeo::app::constrained::sheet::Feature;
use homeo::mesh::{TriMesh, VertexId};
use homeo::shape::fixture::disc;
use homeo::shape::{SplitMix, random_landmarks};

/// A disc with hills, of `6 rings^2` triangles.
pub fn hilly(rings: u32, seed: u64) -> TriMesh {
    let mut random = SplitMix::new(seed);
    let waves: Vec<[f64; 4]> = (0..4).map(|_| [0; 4].map(|_: i32| random.unit())).collect();
    let mut mesh = disc(rings);
    for p in &mut mesh.positions.raw {
        let height = |w: &[f64; 4]| 0.12 * (7.0 * (w[0] * p.x + w[1] * p.y) + 6.0 * w[2]).sin() * w[3];
        p.z = waves.iter().map(height).sum();
    }
    mesh
}

/// How features are to be displaced.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// By up to about the distance of neighbours.
    Displaced,
    /// About the middle of the image, all by one angle.
    Rotated,
    /// Every fourth exchanged with its nearest.
    MirroredInPairs,
    /// Two pairs exchanged, however far apart.
    Swapped,
    /// To places of the image that have nothing to do with where they are.
    Anywhere,
}

/// All of them.
pub const KINDS: [Kind; 5] = [Kind::Displaced, Kind::Rotated, Kind::MirroredInPairs, Kind::Swapped, Kind::Anywhere];

fn places(mesh: &TriMesh, vertices: &[VertexId], kind: Kind, random: &mut SplitMix) -> Vec<DVec2> {
    let at = |v: &VertexId| mesh.positions[*v].truncate();
    let in_square = |p: DVec2| (p * 0.42 + 0.5).clamp(DVec2::splat(0.01), DVec2::splat(0.99));
    let turn = DVec2::from_angle(std::f64::consts::PI * (2.0 * random.unit() - 1.0));
    let mut places: Vec<DVec2> = vertices.iter().map(|v| in_square(at(v))).collect();
    let n = places.len();
    // About the distance of neighbours.
    let reach = 0.75 / (n as f64).sqrt();
    match kind {
        Kind::Displaced => places.iter_mut().for_each(|p| {
            let by = DVec2::new(random.unit(), random.unit()) * 2.0 - 1.0;
            *p = (*p + by * reach).clamp(DVec2::splat(0.01), DVec2::splat(0.99));
        }),
        Kind::Rotated => places = vertices.iter().map(|v| in_square(turn.rotate(at(v)))).collect(),
        Kind::MirroredInPairs => {
            for i in (0..n).step_by(4) {
                let nearest = (0..n)
                    .filter(|&j| j != i)
                    .min_by(|&j, &k| places[i].distance(places[j]).total_cmp(&places[i].distance(places[k])));
                nearest.into_iter().for_each(|j| places.swap(i, j));
            }
        }
        Kind::Swapped => (0..2).for_each(|_| places.swap(random.below(n), random.below(n))),
        Kind::Anywhere => places.iter_mut().for_each(|p| {
            *p = DVec2::new(random.unit(), random.unit()) * 0.96 + 0.02;
        }),
    }
    places
}

/// A disc of `6 rings^2` triangles and `count` vertices of it with places.
pub fn random_set(rings: u32, count: usize, kind: Kind, seed: u64) -> (TriMesh, Vec<Feature>) {
    let mesh = hilly(rings, seed);
    let vertices = random_landmarks(&mesh, count, seed);
    let places = places(&mesh, &vertices, kind, &mut SplitMix::new(seed));
    let features = vertices.iter().zip(places).map(|(v, place)| Feature { vertex: v.0, place }).collect();
    (mesh, features)
}
