//! Embeds a disc from coarse to fine, where one linear solve would shrink a long limb to nothing.
//!
//! A convex combination embedding shrinks a limb by a constant factor per girth, so that its tip soon falls below the
//! resolution of floating point. Here the disc is first coarsened, an independent set of vertices at a time, by merging
//! each with a neighbour; what is left is embedded at once; then the vertices come back in reverse order, each at the
//! centre of the kernel of its ring, and every level is smoothed before the next.
//!
//! Sources: Kirkpatrick, "Optimal search in planar subdivisions", 1983 (the hierarchy); Shen, Jiang, Zorin, Panozzo,
//! "Progressive embedding", 2019 (embedding by re-inserting collapsed vertices).

use super::orientation::orientation;
use super::patch_disc::PatchDisc;
use super::rings;
use super::stretch::{Frame, l2_sq};
use super::visible::kernel;
use crate::mesh::metric;
use glam::{DVec2, DVec3};

/// Vertices of higher degree wait until a later level: merging them would make neighbours of high degree.
const HIGHEST_DEGREE: usize = 9;
/// Smoothing sweeps after each level; the levels below need room, not a minimum.
const SWEEPS: usize = 4;
/// Rounds of putting the coarsest level's vertices at the mean of their rings; a handful of vertices needs a few.
const SETTLING: usize = 1000;
/// Shares of the way to a better place that smoothing tries, the longest first.
const STRIDES: [f64; 3] = [1.0, 0.5, 0.2];

/// A vertex that was merged with the first vertex of its ring.
struct Merged {
    vertex: u32,
    ring: Vec<u32>,
}

/// The disc at one level.
struct Coarse<'a> {
    /// The neighbours of every vertex in use, counter-clockwise; closed around free vertices, open on the boundary.
    rings: Vec<Vec<u32>>,
    /// The sides of the reference triangle a vertex lies on, one bit each.
    sides: Vec<u8>,
    positions: Vec<DVec2>,
    points: &'a [DVec3],
    frame: &'a Frame,
}

/// Positions for all vertices so that every triangle is positively oriented; boundary vertices stay.
///
/// `rings` are those of the free vertices. None if rounding gets in the way after all.
pub fn embed_progressively(
    disc: &PatchDisc,
    rings: &[Vec<u32>],
    points: &[DVec3],
    frame: &Frame,
) -> Option<Vec<DVec2>> {
    let positions = disc.positions.clone();
    let mut coarse = Coarse { rings: all_rings(disc, rings), sides: sides(disc), positions, points, frame };
    let mut free: Vec<u32> = (disc.boundary as u32..disc.vertices.len() as u32).collect();
    let mut levels = Vec::new();
    while !free.is_empty() {
        let level = coarse.coarsen(&mut free);
        if level.is_empty() {
            break;
        }
        levels.push(level);
    }
    coarse.settle(&free)?;
    for level in levels.into_iter().rev() {
        for merged in level.into_iter().rev() {
            free.push(merged.vertex);
            coarse.bring_back(merged)?;
        }
        for _ in 0..SWEEPS {
            free.iter().for_each(|&v| coarse.smooth(v));
        }
    }
    Some(coarse.positions)
}

/// One bit for each side a boundary vertex lies on.
fn sides(disc: &PatchDisc) -> Vec<u8> {
    let mut sides = vec![0; disc.vertices.len()];
    for k in 0..3 {
        let end = if k == 2 { disc.boundary } else { disc.corners[k + 1] as usize };
        (disc.corners[k] as usize..=end).for_each(|i| sides[i % disc.boundary] |= 1 << k);
    }
    sides
}

/// The rings of the free vertices, completed by the open ones of the boundary.
fn all_rings(disc: &PatchDisc, rings: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut rings = rings.to_vec();
    let n = disc.boundary as u32;
    let mut after = std::collections::HashMap::new();
    for &[a, b, c] in &disc.triangles {
        for (v, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
            if v < n {
                after.insert((v, from), to);
            }
        }
    }
    for v in 0..n {
        let mut at = Some((v + 1) % n);
        while let Some(w) = at {
            rings[v as usize].push(w);
            at = after.get(&(v, w)).copied();
        }
    }
    rings
}

impl Coarse<'_> {
    /// Merges an independent set of free vertices with neighbours and takes them off `free`.
    fn coarsen(&mut self, free: &mut Vec<u32>) -> Vec<Merged> {
        let mut order = free.clone();
        order.sort_by_key(|&v| (self.rings[v as usize].len(), v));
        let lowest = order.first().map_or(0, |&v| self.rings[v as usize].len());
        let mut touched = vec![false; self.rings.len()];
        let mut level = Vec::new();
        for v in order {
            let ring = &self.rings[v as usize];
            if ring.len() > HIGHEST_DEGREE.max(lowest) || touched[v as usize] {
                continue;
            }
            if let Some(start) = self.merge_partner(v) {
                ring.iter().for_each(|&w| touched[w as usize] = true);
                touched[v as usize] = true;
                level.push(self.merge(v, start));
            }
        }
        free.retain(|&v| !self.rings[v as usize].is_empty());
        level
    }

    /// The place in the ring of `v` of the nearest neighbour it can be merged with.
    fn merge_partner(&self, v: u32) -> Option<usize> {
        let ring = &self.rings[v as usize];
        let distance = |i: usize| self.points[ring[i] as usize].distance_squared(self.points[v as usize]);
        (0..ring.len()).filter(|&i| self.can_merge(ring, i)).min_by(|&i, &j| distance(i).total_cmp(&distance(j)))
    }

    /// True if the new edges from place `i` of a ring are new to the mesh and none of them runs along a side.
    fn can_merge(&self, ring: &[u32], i: usize) -> bool {
        let (n, u) = (ring.len(), ring[i] as usize);
        (2..n - 1)
            .map(|k| ring[(i + k) % n])
            .all(|x| self.sides[u] & self.sides[x as usize] == 0 && !self.rings[u].contains(&x))
    }

    fn merge(&mut self, v: u32, start: usize) -> Merged {
        let ring = rings::merge(&mut self.rings, v, start);
        Merged { vertex: v, ring }
    }

    /// Embeds what cannot be coarsened any more: every free vertex at the mean of its ring (Tutte), as nearly as needed.
    fn settle(&mut self, free: &[u32]) -> Option<()> {
        for &v in free {
            self.positions[v as usize] = DVec2::splat(1.0 / 3.0);
        }
        for _ in 0..SETTLING {
            if free.iter().all(|&v| is_inside(self.positions[v as usize], &self.polygon(v))) {
                return Some(());
            }
            for &v in free {
                let polygon = self.polygon(v);
                self.positions[v as usize] = polygon.iter().sum::<DVec2>() / polygon.len() as f64;
            }
        }
        None
    }

    /// The positions of the ring of a free vertex.
    fn polygon(&self, v: u32) -> Vec<DVec2> {
        self.rings[v as usize].iter().map(|&w| self.positions[w as usize]).collect()
    }

    /// Undoes a merge and puts the vertex inside its ring.
    fn bring_back(&mut self, Merged { vertex: v, ring }: Merged) -> Option<()> {
        let polygon: Vec<DVec2> = ring.iter().map(|&w| self.positions[w as usize]).collect();
        let room = kernel(&polygon);
        let place = [room.centre(), room.mean()].into_iter().find(|&p| is_inside(p, &polygon))?;
        self.positions[v as usize] = place;
        rings::bring_back(&mut self.rings, v, ring);
        Some(())
    }

    /// Moves a free vertex towards the centre of its kernel or the mean of its ring where that lowers the stretch.
    fn smooth(&mut self, v: u32) {
        let polygon = self.polygon(v);
        let mean = polygon.iter().sum::<DVec2>() / polygon.len() as f64;
        let here = self.positions[v as usize];
        let mut best = (self.energy(v, here, &polygon), here);
        for goal in [kernel(&polygon).centre(), mean] {
            for place in STRIDES.map(|s| here.lerp(goal, s)) {
                let energy = self.energy(v, place, &polygon);
                if energy < best.0 && is_inside(place, &polygon) {
                    best = (energy, place);
                }
            }
        }
        self.positions[v as usize] = best.1;
    }

    /// Squared stretch of the ring's triangles, weighted by their area on the surface, if `v` were at `p`.
    fn energy(&self, v: u32, p: DVec2, polygon: &[DVec2]) -> f64 {
        let ring = &self.rings[v as usize];
        let n = ring.len();
        let one = |i: usize| {
            let plane = [p, polygon[i], polygon[(i + 1) % n]].map(|q| self.frame.place(q));
            let surface = [v, ring[i], ring[(i + 1) % n]].map(|w| self.points[w as usize]);
            l2_sq(plane, surface) * metric::area(surface)
        };
        (0..n).map(one).sum()
    }
}

/// True if `p` sees every edge of the polygon from its left, exactly.
fn is_inside(p: DVec2, polygon: &[DVec2]) -> bool {
    let n = polygon.len();
    (0..n).all(|i| orientation(p, polygon[i], polygon[(i + 1) % n]) > 0.0)
}
