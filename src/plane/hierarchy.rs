//! A domain from coarse to fine, so that errors that reach over all of it cost a few moves of a few vertices.
//!
//! Vertices that may move are merged into neighbours, an independent set at a time; every level keeps its triangles
//! positive in the plane and close to the surface in space. After a level has been relaxed its vertices come back where
//! they lay within their rings, or at the centre of the ring's kernel where that no longer is a place for them.
//!
//! Sources: D. Kirkpatrick, "Optimal search in planar subdivisions", 1983 (the hierarchy); Shen, Jiang, Zorin, Panozzo,
//! "Progressive embedding", 2019 (collapsed vertices brought back into positive triangles).

use super::domain::{Domain, OUTSIDE};
use super::rings;
use super::visible::kernel;
use glam::DVec2;

/// Vertices of higher degree are not merged: their neighbours would get too many.
const HIGHEST_DEGREE: usize = 9;
/// A triangle made by a merge has at least this share of the mean area of the ring's triangles in the plane.
const LEAST_SHARE: f64 = 0.02;
/// Least cosine of the angle between the normals of a triangle before and after a merge: fewer levels follow the surface
/// better, coarser ones carry errors farther.
const LEAST_COSINE: f64 = 0.3;

/// A vertex that was merged with the first vertex of its ring.
struct Merged {
    vertex: u32,
    ring: Vec<u32>,
    /// Where it lay: weights of the ring's vertices.
    weights: Vec<f64>,
}

/// The levels of a domain, and its vertices' neighbours at the level reached.
pub struct Hierarchy {
    /// The neighbours of every vertex in use, counter-clockwise; closed inside, open on the boundary.
    rings: Vec<Vec<u32>>,
    is_inner: Vec<bool>,
    /// What was merged, level by level, the finest first.
    levels: Vec<Vec<Merged>>,
    /// Vertices in use that may move.
    free: Vec<u32>,
}

impl Hierarchy {
    /// Coarsens a domain until at most `enough` vertices can move, or no more can be merged.
    pub fn new(domain: &Domain, enough: usize) -> Self {
        let (rings, is_inner) = rings(domain);
        let free = (0..domain.vertices.len() as u32).filter(|&v| domain.free[v as usize]).collect();
        let mut hierarchy = Hierarchy { rings, is_inner, levels: Vec::new(), free };
        while hierarchy.free.len() > enough {
            let level = hierarchy.coarsen(domain);
            if level.is_empty() {
                break;
            }
            hierarchy.levels.push(level);
        }
        hierarchy
    }

    /// Number of vertices that may move at this level.
    pub fn free(&self) -> usize {
        self.free.len()
    }

    /// True if all vertices are back.
    pub fn is_finest(&self) -> bool {
        self.levels.is_empty()
    }

    /// The domain at this level, and the vertex of the whole domain for each of its vertices.
    pub fn domain(&self, whole: &Domain) -> (Domain, Vec<u32>) {
        let used: Vec<u32> = (0..self.rings.len() as u32).filter(|&v| !self.rings[v as usize].is_empty()).collect();
        let mut number = vec![u32::MAX; self.rings.len()];
        (0u32..).zip(&used).for_each(|(k, &v)| number[v as usize] = k);
        let mut domain = Domain::default();
        for &v in &used {
            let ring = &self.rings[v as usize];
            let ends = ring.len() - usize::from(!self.is_inner[v as usize]);
            for i in 0..ends {
                let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
                if v < a && v < b {
                    domain.triangles.push([v, a, b].map(|w| number[w as usize]));
                }
            }
            let v = v as usize;
            domain.vertices.push(whole.vertices[v]);
            domain.positions.push(whole.positions[v]);
            domain.points.push(whole.points[v]);
            domain.free.push(whole.free[v]);
        }
        domain.connect();
        (domain, used)
    }

    /// Brings one level back into `domain`; None if rounding leaves a vertex no place.
    pub fn refine(&mut self, domain: &mut Domain) -> Option<()> {
        for merged in self.levels.pop()?.into_iter().rev() {
            self.bring_back(merged, domain)?;
        }
        Some(())
    }

    fn coarsen(&mut self, domain: &Domain) -> Vec<Merged> {
        let nearest = |&v: &u32| {
            let ring = self.rings[v as usize].iter();
            ring.map(|&w| distance(domain, v, w)).fold(f32::INFINITY, f32::min)
        };
        let mut order: Vec<(f32, u32)> = self.free.iter().map(|v| (nearest(v), *v)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut touched = vec![false; self.rings.len()];
        let mut level = Vec::new();
        for (_, v) in order {
            if touched[v as usize] || self.rings[v as usize].len() > HIGHEST_DEGREE {
                continue;
            }
            if let Some(start) = self.partner(v, domain) {
                self.rings[v as usize].iter().for_each(|&w| touched[w as usize] = true);
                level.push(self.merge(v, start, domain));
            }
        }
        self.free.retain(|&v| !self.rings[v as usize].is_empty());
        level
    }

    /// The place in the ring of `v` of the nearest neighbour it can be merged with.
    fn partner(&self, v: u32, domain: &Domain) -> Option<usize> {
        let ring = &self.rings[v as usize];
        let to = |i: usize| distance(domain, v, ring[i]);
        let allowed = (0..ring.len()).filter(|&i| self.can_merge(v, i, domain));
        allowed.min_by(|&i, &j| to(i).total_cmp(&to(j)))
    }

    /// True if merging `v` into place `i` of its ring makes no edge that is there already and no bad triangle.
    fn can_merge(&self, v: u32, i: usize, domain: &Domain) -> bool {
        let ring = &self.rings[v as usize];
        let n = ring.len();
        let u = ring[i];
        let is_new = |x: &u32| !self.rings[u as usize].contains(x);
        if n < 3 || !(2..n - 1).map(|k| ring[(i + k) % n]).all(|x| is_new(&x)) {
            return false;
        }
        let plane = |w: u32| domain.positions[w as usize];
        let area = |a: u32, b: u32, c: u32| (plane(b) - plane(a)).perp_dot(plane(c) - plane(a));
        let whole: f64 = (0..n).map(|k| area(v, ring[k], ring[(k + 1) % n])).sum();
        let normal = |a: u32, b: u32, c: u32| {
            let [a, b, c] = [a, b, c].map(|w| domain.points[w as usize]);
            (b - a).cross(c - a)
        };
        (1..n - 1).all(|k| {
            let (a, b) = (ring[(i + k) % n], ring[(i + k + 1) % n]);
            let (old, new) = (normal(v, a, b), normal(u, a, b));
            area(u, a, b) > LEAST_SHARE * whole / n as f64
                && old.dot(new) >= LEAST_COSINE * (old.length_squared() * new.length_squared()).sqrt()
        })
    }

    fn merge(&mut self, v: u32, start: usize, domain: &Domain) -> Merged {
        let ring = rings::merge(&mut self.rings, v, start);
        let polygon: Vec<DVec2> = ring.iter().map(|&w| domain.positions[w as usize]).collect();
        let weights = mean_value(domain.positions[v as usize], &polygon);
        Merged { vertex: v, ring, weights }
    }

    fn bring_back(&mut self, Merged { vertex: v, ring, weights }: Merged, domain: &mut Domain) -> Option<()> {
        let polygon: Vec<DVec2> = ring.iter().map(|&w| domain.positions[w as usize]).collect();
        let same: DVec2 = polygon.iter().zip(&weights).map(|(&p, &w)| p * w).sum();
        let place = if sees(same, &polygon) {
            same
        } else {
            let room = kernel(&polygon);
            [room.centre(), room.mean()].into_iter().find(|&p| sees(p, &polygon))?
        };
        domain.positions[v as usize] = place;
        rings::bring_back(&mut self.rings, v, ring);
        self.free.push(v);
        Some(())
    }
}

/// Squared distance in space, in single precision: what differs by rounding alone is equal, and the lower number comes
/// first.
fn distance(domain: &Domain, v: u32, w: u32) -> f32 {
    domain.points[v as usize].distance_squared(domain.points[w as usize]) as f32
}

/// The neighbours of every vertex, counter-clockwise, and whether they close around it.
fn rings(domain: &Domain) -> (Vec<Vec<u32>>, Vec<bool>) {
    let fans = domain.fans();
    let count = domain.vertices.len();
    let (mut rings, mut is_inner) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for v in 0..count {
        let fan = fans.around(v);
        // Counter-clockwise around a vertex, the boundary comes first in the triangle behind whose first side is nothing.
        let open = fan.iter().copied().find(|&(t, i)| domain.neighbours[t as usize][i as usize] == OUTSIDE);
        let Some((mut t, mut i)) = open.or(fan.first().copied()) else {
            rings.push(Vec::new());
            is_inner.push(false);
            continue;
        };
        let mut ring = Vec::with_capacity(fan.len() + 1);
        let mut closed = true;
        for _ in 0..fan.len() {
            let corners = domain.triangles[t as usize];
            ring.push(corners[(i as usize + 1) % 3]);
            let behind = domain.neighbours[t as usize][(i as usize + 2) % 3];
            if behind == OUTSIDE {
                ring.push(corners[(i as usize + 2) % 3]);
                closed = false;
                break;
            }
            t = behind;
            i = domain.triangles[t as usize].iter().position(|&w| w as usize == v).unwrap_or(0) as u8;
        }
        rings.push(ring);
        is_inner.push(closed);
    }
    (rings, is_inner)
}

/// True if `p` lies left of every edge of the polygon.
fn sees(p: DVec2, polygon: &[DVec2]) -> bool {
    let n = polygon.len();
    (0..n).all(|i| (polygon[i] - p).perp_dot(polygon[(i + 1) % n] - p) > 0.0)
}

/// Weights of sum 1 by which the corners of a polygon make up a point that sees them all (Floater 2003).
fn mean_value(p: DVec2, polygon: &[DVec2]) -> Vec<f64> {
    let n = polygon.len();
    let spokes: Vec<DVec2> = polygon.iter().map(|&q| q - p).collect();
    let half_tangent = |i: usize| {
        let (u, w) = (spokes[i], spokes[(i + 1) % n]);
        let (sine, product, cosine) = (u.perp_dot(w), u.length() * w.length(), u.dot(w));
        if cosine >= 0.0 { sine / (product + cosine) } else { (product - cosine) / sine }
    };
    let tangents: Vec<f64> = (0..n).map(half_tangent).collect();
    let weights: Vec<f64> = (0..n).map(|i| (tangents[(i + n - 1) % n] + tangents[i]) / spokes[i].length()).collect();
    let sum: f64 = weights.iter().sum();
    weights.into_iter().map(|w| w / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::super::grid::{grid, swirl};
    use super::*;

    fn area(domain: &Domain, t: usize) -> f64 {
        let [a, b, c] = domain.triangle(t);
        (b - a).perp_dot(c - a)
    }

    /// Positive triangles that fill the square.
    fn check(domain: &Domain) {
        let areas: Vec<f64> = (0..domain.triangles.len()).map(|t| area(domain, t)).collect();
        assert!(areas.iter().all(|&a| a > 0.0));
        assert!((areas.iter().sum::<f64>() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn every_level_fills_the_domain_and_keeps_what_must_not_move() {
        let domain = grid(16, swirl);
        let levels = Hierarchy::new(&domain, 10);
        assert!(levels.free() <= 10 && !levels.is_finest());
        let (level, of_level) = levels.domain(&domain);
        check(&level);
        assert_eq!(level.free.iter().filter(|free| !**free).count(), domain.free.iter().filter(|free| !**free).count());
        assert!(of_level.iter().zip(&level.points).all(|(&v, &p)| domain.points[v as usize] == p));
    }

    #[test]
    fn vertices_come_back_where_they_were_if_nothing_moved() {
        let mut domain = grid(16, swirl);
        let before = domain.clone();
        let mut levels = Hierarchy::new(&domain, 10);
        while !levels.is_finest() {
            levels.refine(&mut domain).expect("there is room where the vertices were");
        }
        assert!(domain.positions.iter().zip(&before.positions).all(|(p, q)| p.distance(*q) < 1e-12));
        let (finest, _) = levels.domain(&domain);
        let sorted = |mut triangles: Vec<[u32; 3]>| {
            triangles.iter_mut().for_each(|t| {
                let first = (0..3).min_by_key(|&i| t[i]).expect("three corners");
                t.rotate_left(first);
            });
            triangles.sort_unstable();
            triangles
        };
        assert_eq!(sorted(finest.triangles), sorted(before.triangles));
    }

    #[test]
    fn vertices_find_a_place_among_others_that_moved_far() {
        let mut domain = grid(16, |p| p);
        let mut levels = Hierarchy::new(&domain, 10);
        let crowd = |p: &mut DVec2| *p = DVec2::new(p.x * (0.4 + 0.6 * p.x), p.y * (0.3 + 0.7 * p.y));
        let (level, of_level) = levels.domain(&domain);
        of_level.iter().filter(|&&v| domain.free[v as usize]).for_each(|&v| crowd(&mut domain.positions[v as usize]));
        let moved = Domain { positions: of_level.iter().map(|&v| domain.positions[v as usize]).collect(), ..level };
        check(&moved);
        while !levels.is_finest() {
            levels.refine(&mut domain).expect("a ring around a merged vertex has a kernel");
            check(&levels.domain(&domain).0);
        }
    }
}
