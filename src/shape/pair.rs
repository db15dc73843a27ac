//! Random pairs of any genus and number of boundary loops, for sweeps, property tests and fuzzing.
//!
//! Both meshes come from one solid, polygonised at two resolutions, bent and stretched in two ways, and pierced at the
//! same places; so corresponding landmarks are known, and a natural map exists.

use super::fixture::{genus, limb};
use super::random::{SplitMix, random_landmarks};
use crate::mesh::{FaceId, IdVec, TriMesh, VertexId, corner, face_of};
use glam::{DQuat, DVec3};

/// Waves added to the coordinates by a [`Bend`].
const WAVES: usize = 3;
/// Sum of all waves' slopes; below 1 nothing folds in space.
const SLOPE: f64 = 0.6;
/// Shortest and longest stretch along an axis.
const STRETCH: (f64, f64) = (0.6, 1.6);
/// Radius of the holes in the solid, whose tubes have radius 0.25.
const HOLE: f64 = 0.12;

/// Length of the limb that every other solid of genus 0 has.
const LIMB: f64 = 1.5;

/// What a random pair is to be like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PairOptions {
    /// Number of handles.
    pub genus: usize,
    /// Number of boundary loops.
    pub loops: usize,
    /// Number of landmarks.
    pub landmarks: usize,
    /// About so many vertices in the source and the target.
    pub vertices: [usize; 2],
    /// True for landmarks at corresponding places; otherwise they are drawn independently on both meshes.
    pub related: bool,
}

/// Two meshes and their landmarks, which run in parallel.
#[derive(Clone, Debug)]
pub struct RandomPair {
    /// The source and the target.
    pub meshes: [TriMesh; 2],
    /// Vertices of the source and of the target.
    pub landmarks: [Vec<VertexId>; 2],
}

/// Generates a pair; equal arguments give equal pairs.
///
/// There are fewer loops or landmarks than wished only if the meshes are too coarse for them.
pub fn random_pair(options: &PairOptions, seed: u64) -> RandomPair {
    let mut random = SplitMix::new(seed);
    let has_limb = options.genus == 0 && random.unit() < 0.5;
    let solid = |n| if has_limb { limb(LIMB, n) } else { genus(options.genus, n) };
    let [source, target] = options.vertices.map(solid);
    let centres = random_landmarks(&source, options.loops, random.next_bits());
    let centres: Vec<DVec3> = centres.into_iter().map(|v| source.positions[v]).collect();
    let mut meshes = pierce_both([source, target], &centres);
    let chosen = inner_landmarks(&meshes[0], options.landmarks, random.next_bits());
    let images = match options.related {
        true => nearest_each(&meshes[1], chosen.iter().map(|&v| meshes[0].positions[v])),
        false => inner_landmarks(&meshes[1], chosen.len(), random.next_bits()),
    };
    for mesh in &mut meshes {
        let bend = Bend::random(&mut random);
        mesh.positions.raw.iter_mut().for_each(|p| *p = bend.apply(*p));
    }
    let chosen = chosen[..images.len()].to_vec();
    RandomPair { meshes, landmarks: [chosen, images] }
}

/// A smooth deformation of space that folds nothing.
struct Bend {
    stretch: DVec3,
    turn: DQuat,
    waves: [(DVec3, DVec3, f64); WAVES],
}

impl Bend {
    fn random(random: &mut SplitMix) -> Self {
        let mut direction = |length: f64| {
            let p = DVec3::from_array(std::array::from_fn(|_| 2.0 * random.unit() - 1.0));
            p.normalize_or(DVec3::Z) * length
        };
        let waves = std::array::from_fn(|k| {
            let frequency = 2.0 + k as f64;
            (direction(frequency), direction(SLOPE / (WAVES as f64 * frequency)))
        });
        let axis = direction(1.0);
        let (low, high) = STRETCH;
        let mut unit = || random.unit();
        Bend {
            waves: waves.map(|(frequency, height)| (frequency, height, std::f64::consts::TAU * unit())),
            stretch: DVec3::from_array(std::array::from_fn(|_| low * (high / low).powf(unit()))),
            turn: DQuat::from_axis_angle(axis, std::f64::consts::TAU * unit()),
        }
    }

    fn apply(&self, p: DVec3) -> DVec3 {
        let wave = |&(frequency, height, phase): &(DVec3, DVec3, f64)| height * (frequency.dot(p) + phase).sin();
        self.turn * ((p + self.waves.iter().map(wave).sum::<DVec3>()) * self.stretch)
    }
}

/// Cuts a hole around each centre into both meshes, as far as it fits on both.
fn pierce_both(meshes: [TriMesh; 2], centres: &[DVec3]) -> [TriMesh; 2] {
    let mut holes = [0, 1].map(|k| Holes::new(&meshes[k]));
    for &centre in centres {
        let seeds = [0, 1].map(|k| holes[k].seed(centre));
        if let [Some(a), Some(b)] = seeds {
            holes[0].cut(a, centre);
            holes[1].cut(b, centre);
        }
    }
    holes.map(Holes::finish)
}

/// Discs being cut out of a mesh.
struct Holes<'a> {
    mesh: &'a TriMesh,
    removed: IdVec<FaceId, bool>,
    /// Vertices of removed faces, which no other hole may touch.
    taken: IdVec<VertexId, bool>,
}

impl<'a> Holes<'a> {
    fn new(mesh: &'a TriMesh) -> Self {
        let (faces, vertices) = (mesh.conn.face_count(), mesh.conn.vertex_count());
        Holes { mesh, removed: IdVec::filled(false, faces), taken: IdVec::filled(false, vertices) }
    }

    /// The vertex nearest to `centre` whose star touches no hole.
    fn seed(&self, centre: DVec3) -> Option<VertexId> {
        let mesh = self.mesh;
        let free = |&v: &VertexId| {
            mesh.conn.leaving(v).is_some()
                && !self.taken[v]
                && mesh.conn.outgoing(v).all(|h| !self.taken[mesh.conn.to(h)])
        };
        mesh.conn.vertices().filter(free).min_by(|&a, &b| {
            let distance = |v: VertexId| mesh.positions[v].distance_squared(centre);
            distance(a).total_cmp(&distance(b))
        })
    }

    /// Removes the star of `seed` and more faces within the radius, one by one, such that they stay a closed disc.
    fn cut(&mut self, seed: VertexId, centre: DVec3) {
        let mesh = self.mesh;
        let mut inside = IdVec::filled(false, mesh.conn.vertex_count());
        let mut rim: Vec<FaceId> = mesh.conn.outgoing(seed).map(face_of).collect();
        let star = rim.len();
        let mut at = 0;
        while let Some(&f) = rim.get(at) {
            at += 1;
            if self.removed[f] || (at > star && !self.extends_disc(f, &inside, centre)) {
                continue;
            }
            self.removed[f] = true;
            mesh.face(f).into_iter().for_each(|v| inside[v] = true);
            rim.extend((0..3).filter_map(|i| mesh.conn.twin(corner(f, i))).map(face_of));
        }
        inside.iter_ids().filter(|(_, inside)| **inside).for_each(|(v, _)| self.taken[v] = true);
    }

    /// True if a face near the centre meets the disc in one edge and a new vertex.
    fn extends_disc(&self, f: FaceId, inside: &IdVec<VertexId, bool>, centre: DVec3) -> bool {
        let mesh = self.mesh;
        let corners = mesh.face(f);
        let near = corners.iter().all(|&v| mesh.positions[v].distance(centre) < HOLE);
        let untouched =
            |v: VertexId| !inside[v] && !self.taken[v] && mesh.conn.outgoing(v).all(|h| !self.taken[mesh.conn.to(h)]);
        near && corners.iter().filter(|&&v| untouched(v)).count() == 1
            && corners.iter().filter(|&&v| inside[v]).count() == 2
    }

    fn finish(self) -> TriMesh {
        let kept = self.mesh.conn.faces().filter(|&f| !self.removed[f]).map(|f| self.mesh.face(f));
        let faces: Vec<_> = kept.collect();
        // Closed discs that do not touch leave a manifold.
        TriMesh::new(self.mesh.positions.raw.clone(), &faces).expect("a manifold with discs cut out is a manifold")
    }
}

/// `n` well-spread vertices off the boundary: one on it would have to correspond to one on the other mesh's boundary.
fn inner_landmarks(mesh: &TriMesh, n: usize, seed: u64) -> Vec<VertexId> {
    let on_boundary = mesh.conn.vertices().filter(|&v| mesh.conn.is_on_boundary(v)).count();
    let all = random_landmarks(mesh, n + on_boundary, seed);
    all.into_iter().filter(|&v| !mesh.conn.is_on_boundary(v)).take(n).collect()
}

/// For every point the nearest vertex that faces use, off the boundary, and no earlier point took.
fn nearest_each(mesh: &TriMesh, points: impl Iterator<Item = DVec3>) -> Vec<VertexId> {
    let is_inner = |v: &VertexId| mesh.conn.leaving(*v).is_some() && !mesh.conn.is_on_boundary(*v);
    let mut free: Vec<VertexId> = mesh.conn.vertices().filter(is_inner).collect();
    let nearest = |p: DVec3| {
        let distance = |&i: &usize| mesh.positions[free[i]].distance_squared(p);
        let best = (0..free.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        Some(free.swap_remove(best))
    };
    points.map_while(nearest).collect()
}
