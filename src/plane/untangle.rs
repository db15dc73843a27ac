//! Triangles of a compatible mesh turned right side out.
//!
//! A compatible mesh samples the map at the vertices alone. Where a triangle spans a fold of the other surface its image
//! may be turned over although the map is not. Moving its vertices within the domain, and so their images on the other
//! surface, often turns it back; the map stays a homeomorphism.

use super::domain::{Domain, Fans};
use super::smooth::{Model, Smoother};
use super::walk::walk;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Directions in which new places are tried.
const DIRECTIONS: usize = 12;
/// How far, in mean distances to the neighbours.
const REACHES: [f64; 5] = [0.05, 0.15, 0.35, 0.7, 1.2];
/// Triangles of the ring keep this share of their area.
const KEEP_AREA: f64 = 0.02;
/// A move raises the energy of the ring at most by this factor.
const MOST_RISE: f64 = 4.0;
/// Visits of all vertices concerned.
const SWEEPS: usize = 3;

/// Where a vertex lies on the other surface.
#[derive(Clone, Copy)]
struct Image {
    triangle: u32,
    point: DVec3,
    normal: DVec3,
}

struct Untangler<'a> {
    smoother: Smoother<'a>,
    fixed: &'a Domain,
    fans: Fans,
    faces: &'a [[u32; 3]],
    /// The faces around every vertex.
    around: Vec<Vec<u32>>,
    images: Vec<Option<Image>>,
}

/// Moves free vertices of `moving` so that fewer of its sampled `faces` are turned over on `fixed`; returns how many fewer.
pub fn untangle(moving: &mut Domain, fixed: &Domain, faces: &[[u32; 3]]) -> usize {
    let mut around = vec![Vec::new(); moving.vertices.len()];
    for (f, corners) in (0u32..).zip(faces) {
        corners.iter().for_each(|&v| around[v as usize].push(f));
    }
    let images = vec![None; moving.vertices.len()];
    let fans = moving.fans();
    let smoother = Smoother::new(moving, fixed, Model::Held);
    let mut untangler = Untangler { smoother, fixed, fans, faces, around, images };
    let before = untangler.count_all();
    let mut left = before;
    for _ in 0..SWEEPS {
        if left == 0 {
            break;
        }
        untangler.sweep();
        left = untangler.count_all();
    }
    before.saturating_sub(left)
}

impl Untangler<'_> {
    fn count_all(&mut self) -> usize {
        (0..self.faces.len()).filter(|&f| self.is_turned(f)).count()
    }

    fn sweep(&mut self) {
        for f in 0..self.faces.len() {
            for v in self.faces[f].map(|v| v as usize) {
                if self.smoother.moving.free[v] && self.is_turned(f) {
                    self.improve(v);
                }
            }
        }
    }

    /// Looks for the place of `v` with the fewest turned faces around, then with the least energy.
    fn improve(&mut self, v: usize) {
        let (from, image) = (self.smoother.moving.positions[v], self.images[v]);
        let ring: Vec<[DVec2; 2]> = self.fans.around(v).iter().map(|&(t, i)| self.opposite(t, i)).collect();
        let reach = ring.iter().map(|[a, _]| a.distance(from)).sum::<f64>() / ring.len() as f64;
        let keeps =
            |p: DVec2| ring.iter().all(|&[a, b]| (a - p).perp_dot(b - p) > KEEP_AREA * (a - from).perp_dot(b - from));
        let mut best = (self.turned_around(v), self.ring_energy(v));
        let highest = MOST_RISE * best.1;
        let mut place = (from, image);
        for k in 0..DIRECTIONS * REACHES.len() {
            let turn = DVec2::from_angle(TAU * (k % DIRECTIONS) as f64 / DIRECTIONS as f64);
            let p = from + turn * (reach * REACHES[k / DIRECTIONS]);
            if !keeps(p) {
                continue;
            }
            self.smoother.moving.positions[v] = p;
            self.images[v] = None;
            let turned = self.turned_around(v);
            if turned > best.0 {
                continue;
            }
            let energy = self.ring_energy(v);
            if energy < highest && (turned, energy) < best {
                best = (turned, energy);
                place = (p, self.images[v]);
            }
        }
        (self.smoother.moving.positions[v], self.images[v]) = place;
    }

    fn opposite(&self, t: u32, i: u8) -> [DVec2; 2] {
        let corners = self.smoother.moving.triangles[t as usize];
        [1, 2].map(|k| self.smoother.moving.positions[corners[(i as usize + k) % 3] as usize])
    }

    fn ring_energy(&mut self, v: usize) -> f64 {
        let ring = self.fans.around(v).iter();
        ring.filter_map(|&(t, _)| self.smoother.exact_energy_of(t as usize)).map(|p| p.energy).sum()
    }

    fn turned_around(&mut self, v: usize) -> usize {
        let around = std::mem::take(&mut self.around[v]);
        let count = around.iter().filter(|&&f| self.is_turned(f as usize)).count();
        self.around[v] = around;
        count
    }

    /// True if the face's image is turned against the surface at its corners.
    fn is_turned(&mut self, f: usize) -> bool {
        let [a, b, c] = self.faces[f].map(|v| self.image(v as usize));
        let normal = (b.point - a.point).cross(c.point - a.point);
        normal.dot(a.normal + b.normal + c.normal) < 0.0
    }

    fn image(&mut self, v: usize) -> Image {
        if let Some(image) = self.images[v] {
            return image;
        }
        let near = self.images.get(v.saturating_sub(1)).copied().flatten().map_or(0, |i| i.triangle);
        let spot = walk(self.fixed, near, self.smoother.moving.positions[v]);
        let [p, q, r] = self.fixed.spatial(&self.fixed.triangles[spot.triangle as usize]);
        let normal = (q - p).cross(r - p).normalize_or_zero();
        let image = Image { triangle: spot.triangle, point: spot.point(self.fixed), normal };
        self.images[v] = Some(image);
        image
    }
}
