//! Reproducible random numbers and well-spread random landmarks.

use crate::mesh::{IdVec, TriMesh, VertexId};

/// Candidates per landmark; more spread the landmarks more evenly and less randomly.
const CANDIDATES: usize = 12;

/// The SplitMix64 generator (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014).
#[derive(Clone, Debug)]
pub struct SplitMix {
    state: u64,
}

impl SplitMix {
    /// A generator; equal seeds give equal sequences on every platform.
    pub fn new(seed: u64) -> Self {
        SplitMix { state: seed }
    }

    /// The next 64 random bits.
    pub fn next_bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next_bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number below `n`, which is not zero.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.next_bits()) * n as u128) >> 64) as usize
    }
}

/// `n` different vertices of the mesh, spread out: each is the farthest from the earlier ones among a few candidates.
///
/// Fewer than `n` are returned only if the mesh has fewer referenced vertices. Source of the idea: Mitchell, "Spectrally
/// optimal sampling for distribution ray tracing", 1991.
pub fn random_landmarks(mesh: &TriMesh, n: usize, seed: u64) -> Vec<VertexId> {
    let mut random = SplitMix::new(seed);
    let mut free: Vec<VertexId> = mesh.conn.vertices().filter(|&v| mesh.conn.leaving(v).is_some()).collect();
    let mut gap = IdVec::<VertexId, f64>::filled(f64::INFINITY, mesh.positions.len());
    let mut chosen = Vec::new();
    while chosen.len() < n && !free.is_empty() {
        let mut best = random.below(free.len());
        for _ in 1..CANDIDATES {
            let other = random.below(free.len());
            if gap[free[other]] > gap[free[best]] {
                best = other;
            }
        }
        let v = free.swap_remove(best);
        chosen.push(v);
        for &w in &free {
            gap[w] = gap[w].min(mesh.positions[w].distance_squared(mesh.positions[v]));
        }
    }
    chosen
}

/// Moves every landmark to a neighbouring vertex drawn by chance; it stays where that is a landmark already.
pub fn nudge_landmarks(mesh: &TriMesh, landmarks: &mut [VertexId], random: &mut SplitMix) {
    for i in 0..landmarks.len() {
        let around: Vec<VertexId> = mesh.conn.outgoing(landmarks[i]).map(|h| mesh.conn.to(h)).collect();
        let chosen = around[random.below(around.len())];
        if !landmarks.contains(&chosen) {
            landmarks[i] = chosen;
        }
    }
}
