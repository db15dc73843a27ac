//! A mesh with fewer vertices, and the way back: every vertex of the mesh has its place on the simplified one.
//!
//! Vertices are merged into neighbours, an independent set at a time, those first that cost the least shape. The ring of a
//! vertex is laid out flat around it; there the triangles drawn to the neighbour instead fill the same polygon, which is a
//! bijection between the mesh before and after. Vertices that are merged keep their neighbours' positions untouched, so the
//! simplified mesh's vertices are vertices of the mesh. Boundary vertices are merged along the boundary only.
//!
//! Sources: A. Lee, W. Sweldens, P. Schröder, L. Cowsar, D. Dobkin, "MAPS: multiresolution adaptive parameterization of
//! surfaces", 1998; M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", 1997.

use super::quadric::Quadric;
use super::{FaceId, Id, IdVec, SurfacePoint, TriMesh, VertexId, face_of, metric};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Rings become no larger.
const HIGHEST_DEGREE: usize = 12;
/// A triangle made by a merge has at least this share of the ring's mean triangle, laid out flat.
const LEAST_SHARE: f64 = 0.05;
/// Least cosine of the angle between the normals of a triangle before and after a merge.
const LEAST_COSINE: f64 = 0.7;
/// Least angle between two spokes that are laid out flat; below it they would run into one.
const LEAST_ANGLE: f64 = 1e-6;
/// What a merge costs beside the shape it loses: for the squared length of the way that the vertex moves, the area around
/// it, and thin triangles. Flat regions keep triangles of a middling size.
const WAY: f64 = 1e-2;
/// The square of a triangle's roundness counts as no less.
const LEAST_ROUNDNESS: f64 = 1e-6;
/// In one pass the cheapest of so many merges in a hundred are made, so that no dear one comes before a cheap one.
const CHEAPEST_PERCENT: usize = 30;
/// A piece of the mesh keeps so many vertices, and a boundary loop, so that there is room for a layout on them.
const LEAST_OF_PIECE: u32 = 200;
/// See [`LEAST_OF_PIECE`].
const LEAST_OF_LOOP: u32 = 24;
/// Stands for the missing face behind the last spoke of a boundary vertex.
const OUTSIDE: u32 = u32::MAX;

/// A vertex that was merged into a neighbour.
#[derive(Clone, Debug)]
pub struct Removal {
    /// The vertex.
    pub vertex: VertexId,
    /// Its neighbours, counter-clockwise; around a boundary vertex from boundary to boundary.
    pub ring: Vec<VertexId>,
    /// The neighbours laid out flat; the vertex lies at the origin.
    pub places: Vec<DVec2>,
    /// Which of them it was merged into.
    pub apex: usize,
    /// Whether the ring closes.
    pub is_inner: bool,
}

/// A simplified mesh; see the module documentation.
#[derive(Clone, Debug)]
pub struct Simplified {
    /// The mesh.
    pub mesh: TriMesh,
    /// For every vertex its number in the given mesh.
    pub kept: IdVec<VertexId, VertexId>,
    /// The merged vertices in order, all numbers those of the given mesh.
    pub removals: Vec<Removal>,
    /// Where every vertex of the given mesh lies on this one; an unreferenced vertex has no place.
    pub images: IdVec<VertexId, Option<SurfacePoint>>,
}

/// Merges vertices, but none of those to `keep`, until at most `enough` are left or no more can be merged.
pub fn simplify(mesh: &TriMesh, keep: &[VertexId], enough: usize) -> Simplified {
    let mut merging = Merging::new(mesh, keep);
    let mut stale: Vec<u32> = (0..merging.rings.len() as u32).collect();
    let mut best: Vec<Option<Merge>> = vec![None; merging.rings.len()];
    while merging.left > enough {
        let fresh: Vec<Option<Merge>> = stale.par_iter().map(|&v| merging.best_merge(v)).collect();
        stale.iter().zip(fresh).for_each(|(&v, merge)| best[v as usize] = merge);
        let before = merging.left;
        stale = merging.pass(&mut best, enough);
        if merging.left == before {
            break;
        }
    }
    merging.finish(mesh)
}

impl Removal {
    /// Number of triangles around the vertex.
    pub fn sectors(&self) -> usize {
        if self.is_inner { self.ring.len() } else { self.ring.len() - 1 }
    }

    /// The neighbour behind `i`, counter-clockwise.
    pub fn after(&self, i: usize) -> usize {
        (i + 1) % self.ring.len()
    }

    /// The sides of the ring whose triangles are drawn to the apex instead of the vertex, by their first ends.
    pub fn fan(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.sectors()).filter(|&i| i != self.apex && self.after(i) != self.apex)
    }
}

/// The cheapest merge of a vertex.
#[derive(Clone, Copy, Debug)]
struct Merge {
    cost: f64,
    /// The neighbour, by its place in the ring.
    apex: usize,
}

/// A neighbour, and the face behind it, counter-clockwise.
type Spoke = (u32, u32);

struct Merging<'a> {
    positions: &'a [DVec3],
    /// The neighbours of every vertex in use, counter-clockwise; on the boundary from boundary to boundary.
    rings: Vec<Vec<Spoke>>,
    is_inner: Vec<bool>,
    is_kept: Vec<bool>,
    quadrics: Vec<Quadric>,
    /// The corners of every face in use.
    corners: Vec<[u32; 3]>,
    is_used: Vec<bool>,
    /// The merged vertices in every face, with the weights of its corners.
    inside: Vec<Vec<(u32, [f64; 3])>>,
    removals: Vec<Removal>,
    /// Vertices in use.
    left: usize,
    pieces: Groups,
    loops: Groups,
}

/// Sets of vertices that keep a least number of vertices each.
struct Groups {
    /// The set that a vertex belongs to, if any.
    of_vertex: Vec<Option<u32>>,
    /// Vertices in use of every set.
    left: Vec<u32>,
    least: u32,
}

impl Groups {
    fn new(of_vertex: Vec<Option<u32>>, least: u32) -> Self {
        let count = of_vertex.iter().flatten().max().map_or(0, |&last| last as usize + 1);
        let mut left = vec![0; count];
        of_vertex.iter().flatten().for_each(|&group| left[group as usize] += 1);
        Groups { of_vertex, left, least }
    }

    fn can_lose(&self, v: u32) -> bool {
        self.of_vertex[v as usize].is_none_or(|group| self.left[group as usize] > self.least)
    }

    fn lose(&mut self, v: u32) {
        if let Some(group) = self.of_vertex[v as usize] {
            self.left[group as usize] -= 1;
        }
    }
}

impl<'a> Merging<'a> {
    fn new(mesh: &'a TriMesh, keep: &[VertexId]) -> Self {
        let count = mesh.positions.len();
        let conn = &mesh.conn;
        let ring = |v: VertexId| -> Vec<Spoke> {
            let mut ring: Vec<Spoke> = conn.outgoing(v).map(|h| (conn.to(h).0, face_of(h).0)).collect();
            if conn.is_on_boundary(v)
                && let Some(last) = conn.outgoing(v).last()
            {
                ring.push((conn.from(super::prev(last)).0, OUTSIDE));
            }
            ring
        };
        let faces: Vec<FaceId> = conn.faces().collect();
        let of_face: Vec<Quadric> = faces.par_iter().map(|&f| Quadric::of_triangle(mesh.triangle(f))).collect();
        let mut quadrics = vec![Quadric::NONE; count];
        for f in conn.faces() {
            mesh.face(f).iter().for_each(|v| quadrics[v.index()].add(&of_face[f.index()]));
        }
        let mut piece_of = vec![None; count];
        let pieces = conn.components();
        conn.faces().for_each(|f| mesh.face(f).iter().for_each(|v| piece_of[v.index()] = Some(pieces[f])));
        let mut loop_of = vec![None; count];
        for (one, halfedges) in (0u32..).zip(conn.boundary_loops()) {
            halfedges.iter().for_each(|&h| loop_of[conn.from(h).index()] = Some(one));
        }
        let mut is_kept = vec![false; count];
        keep.iter().for_each(|v| is_kept[v.index()] = true);
        Merging {
            positions: &mesh.positions.raw,
            rings: conn.vertices().map(ring).collect(),
            is_inner: conn.vertices().map(|v| !conn.is_on_boundary(v)).collect(),
            is_kept,
            quadrics,
            corners: conn.faces().map(|f| mesh.face(f).map(|v| v.0)).collect(),
            is_used: vec![true; conn.face_count()],
            inside: vec![Vec::new(); conn.face_count()],
            removals: Vec::new(),
            left: conn.vertices().filter(|&v| conn.leaving(v).is_some()).count(),
            pieces: Groups::new(piece_of, LEAST_OF_PIECE),
            loops: Groups::new(loop_of, LEAST_OF_LOOP),
        }
    }

    /// Makes an independent set of merges, the cheapest first; returns the vertices whose rings have changed.
    fn pass(&mut self, best: &mut [Option<Merge>], enough: usize) -> Vec<u32> {
        let mut order: Vec<(f64, u32)> = Vec::new();
        order.extend((0u32..).zip(best.iter()).filter_map(|(v, merge)| Some((merge.as_ref()?.cost, v))));
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        order.truncate((order.len() * CHEAPEST_PERCENT).div_ceil(100));
        let mut is_touched = vec![false; self.rings.len()];
        let mut touched = Vec::new();
        for (_, v) in order {
            if self.left <= enough {
                break;
            }
            let Some(Merge { apex, .. }) = best[v as usize].filter(|_| !is_touched[v as usize]) else { continue };
            // The ring of `v` is as it was; those of its neighbours may have changed.
            if !self.is_allowed(v, apex) {
                continue;
            }
            let Some(places) = self.lay_out(v) else { continue };
            best[v as usize] = None;
            for &(w, _) in &self.rings[v as usize] {
                if !is_touched[w as usize] {
                    is_touched[w as usize] = true;
                    touched.push(w);
                }
            }
            self.merge(v, apex, places);
        }
        touched
    }

    /// The cheapest merge of a vertex; none if there is none.
    fn best_merge(&self, v: u32) -> Option<Merge> {
        if self.is_kept[v as usize] || self.rings[v as usize].len() < 3 {
            return None;
        }
        let places = self.lay_out(v)?;
        let ring = &self.rings[v as usize];
        let (last, is_inner) = (ring.len() - 1, self.is_inner[v as usize]);
        let apexes = (0..ring.len()).filter(|&i| is_inner || i == 0 || i == last);
        let here = self.positions[v as usize];
        let sectors = if is_inner { last + 1 } else { last };
        let point = |i: usize| self.positions[ring[i % ring.len()].0 as usize];
        let area: f64 = (0..sectors).map(|i| metric::area([here, point(i), point(i + 1)])).sum();
        let cost = |apex: usize| {
            let there = point(apex);
            let drawn = (0..sectors).filter(|&i| i != apex && (i + 1) % ring.len() != apex);
            let worst = drawn.map(|i| roundness([there, point(i), point(i + 1)])).fold(1.0, f64::min);
            let way = here.distance_squared(there) * area / (worst * worst).max(LEAST_ROUNDNESS);
            self.quadrics[v as usize].at(there) + WAY * way
        };
        let mut by_cost: Vec<Merge> = apexes.map(|apex| Merge { cost: cost(apex), apex }).collect();
        by_cost.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        by_cost.into_iter().find(|m| self.is_allowed(v, m.apex) && self.is_sound(v, m.apex, &places))
    }

    /// The neighbours of a vertex laid out flat around it, lengths kept and angles scaled; none where spokes run into one.
    fn lay_out(&self, v: u32) -> Option<Vec<DVec2>> {
        let ring = &self.rings[v as usize];
        let is_inner = self.is_inner[v as usize];
        let spokes: Vec<DVec3> =
            ring.iter().map(|&(w, _)| self.positions[w as usize] - self.positions[v as usize]).collect();
        let sectors = if is_inner { ring.len() } else { ring.len() - 1 };
        let angle = |i: usize| {
            let (a, b) = (spokes[i], spokes[(i + 1) % spokes.len()]);
            a.cross(b).length().atan2(a.dot(b))
        };
        let angles: Vec<f64> = (0..sectors).map(angle).collect();
        let scale = if is_inner { TAU } else { PI } / angles.iter().sum::<f64>();
        if !angles.iter().all(|a| a * scale > LEAST_ANGLE && (a * scale < PI || sectors == 1)) {
            return None;
        }
        let mut turn = 0.0;
        let place = |(i, spoke): (usize, &DVec3)| {
            let place = DVec2::from_angle(turn) * spoke.length();
            turn += angles.get(i).map_or(0.0, |a| a * scale);
            place
        };
        let places: Vec<DVec2> = spokes.iter().enumerate().map(place).collect();
        places.iter().all(|p| p.is_finite() && p.length_squared() > 0.0).then_some(places)
    }

    /// True if merging `v` into place `apex` of its ring leaves a manifold and no vertex with too many neighbours.
    fn is_allowed(&self, v: u32, apex: usize) -> bool {
        let ring = &self.rings[v as usize];
        let n = ring.len();
        let is_inner = self.is_inner[v as usize];
        let is_beside = |i: usize| {
            let gap = i.abs_diff(apex);
            gap == 1 || (is_inner && gap == n - 1)
        };
        let u = ring[apex].0 as usize;
        let knows = |w: u32| self.rings[u].iter().any(|&(x, _)| x == w);
        let least = |w: u32| if self.is_inner[w as usize] { 3 } else { 2 };
        self.pieces.can_lose(v)
            && self.loops.can_lose(v)
            && self.rings[u].len() + n - 4 <= HIGHEST_DEGREE
            && (0..n).filter(|&i| i != apex).all(|i| {
                let w = ring[i].0;
                if is_beside(i) { self.rings[w as usize].len() > least(w) } else { !knows(w) }
            })
    }

    /// True if no triangle drawn to place `apex` instead of `v` is flat or turned away.
    fn is_sound(&self, v: u32, apex: usize, places: &[DVec2]) -> bool {
        let ring = &self.rings[v as usize];
        let n = ring.len();
        let sectors = if self.is_inner[v as usize] { n } else { n - 1 };
        let after = |i: usize| (i + 1) % n;
        let flat = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
        let whole: f64 = (0..sectors).map(|i| flat(DVec2::ZERO, places[i], places[after(i)])).sum();
        let normal = |a: u32, b: u32, c: u32| {
            let [a, b, c] = [a, b, c].map(|w| self.positions[w as usize]);
            (b - a).cross(c - a)
        };
        (0..sectors).filter(|&i| i != apex && after(i) != apex).all(|i| {
            let (b, c) = (ring[i].0, ring[after(i)].0);
            let (old, new) = (normal(v, b, c), normal(ring[apex].0, b, c));
            flat(places[apex], places[i], places[after(i)]) > LEAST_SHARE * whole / sectors as f64
                && old.dot(new) >= LEAST_COSINE * (old.length_squared() * new.length_squared()).sqrt()
        })
    }

    fn merge(&mut self, v: u32, apex: usize, places: Vec<DVec2>) {
        let spokes = std::mem::take(&mut self.rings[v as usize]);
        let ring = spokes.iter().map(|&(w, _)| VertexId(w)).collect();
        let removal = Removal { vertex: VertexId(v), ring, places, apex, is_inner: self.is_inner[v as usize] };
        let u = spokes[apex].0;
        let quadric = self.quadrics[v as usize];
        self.quadrics[u as usize].add(&quadric);
        let mut inside = vec![(v, DVec2::ZERO)];
        for &(_, f) in &spokes[..removal.sectors()] {
            let corners = self.corners[f as usize];
            let place = |w: u32| removal.ring.iter().position(|x| x.0 == w).map_or(DVec2::ZERO, |i| removal.places[i]);
            let places = corners.map(place);
            let points = std::mem::take(&mut self.inside[f as usize]);
            inside.extend(points.into_iter().map(|(p, w)| (p, (0..3).map(|k| places[k] * w[k]).sum())));
            self.is_used[f as usize] = false;
        }
        for i in removal.fan() {
            let f = spokes[i].1 as usize;
            self.corners[f] = [u, spokes[i].0, spokes[removal.after(i)].0];
            self.is_used[f] = true;
        }
        self.redraw(v, &spokes, &removal);
        for (p, place) in inside {
            let weights = removal.fan().map(|i| {
                let places = [apex, i, removal.after(i)].map(|k| removal.places[k]);
                (i, metric::barycentric(places, place))
            });
            let least = |w: &[f64; 3]| w.iter().copied().fold(f64::INFINITY, f64::min);
            let best = weights.max_by(|a, b| least(&a.1).total_cmp(&least(&b.1)));
            if let Some((i, weights)) = best {
                self.inside[spokes[i].1 as usize].push((p, inner(weights)));
            }
        }
        self.removals.push(removal);
        self.left -= 1;
        self.pieces.lose(v);
        self.loops.lose(v);
    }

    /// The neighbours' rings without `v`, whose triangles are drawn to the apex.
    fn redraw(&mut self, v: u32, spokes: &[Spoke], removal: &Removal) {
        let (n, apex) = (spokes.len(), removal.apex);
        let u = spokes[apex].0;
        let beside = |step: usize| {
            let i = (apex + step) % n;
            // Around a boundary vertex the first and the last neighbour are not beside each other.
            (removal.is_inner || i.abs_diff(apex) == 1).then_some(i)
        };
        let (behind, before) = (beside(1), beside(n - 1));
        for i in (0..n).filter(|&i| i != apex) {
            let ring = &mut self.rings[spokes[i].0 as usize];
            let Some(at) = ring.iter().position(|&(w, _)| w == v) else { continue };
            if Some(i) == behind {
                ring.remove(at);
            } else if Some(i) == before {
                let own = (at + ring.len() - 1) % ring.len();
                ring[own].1 = ring[at].1;
                ring.remove(at);
            } else {
                ring[at].0 = u;
            }
        }
        // Beside `v` the apex knows the neighbours next to itself; between these it now knows all others.
        let others: Vec<Spoke> = match (removal.is_inner, apex) {
            (true, _) => (2..n - 1).map(|k| spokes[(apex + k) % n]).collect(),
            (false, 0) => spokes[2..].to_vec(),
            (false, _) => spokes[..n - 2].to_vec(),
        };
        let ring = &mut self.rings[u as usize];
        let Some(at) = ring.iter().position(|&(w, _)| w == v) else { return };
        if let Some(behind) = behind {
            let own = (at + ring.len() - 1) % ring.len();
            ring[own].1 = spokes[behind].1;
        }
        ring.splice(at..=at, others);
    }

    fn finish(self, mesh: &TriMesh) -> Simplified {
        let used = (0u32..).zip(&self.rings).filter(|(_, ring)| !ring.is_empty()).map(|(v, _)| VertexId(v));
        let kept: IdVec<VertexId, VertexId> = used.collect();
        let mut number = vec![u32::MAX; self.rings.len()];
        (0u32..).zip(kept.iter()).for_each(|(here, there)| number[there.index()] = here);
        let faces: Vec<usize> = (0..self.corners.len()).filter(|&f| self.is_used[f]).collect();
        let triangles: Vec<[VertexId; 3]> =
            faces.iter().map(|&f| self.corners[f].map(|v| VertexId(number[v as usize]))).collect();
        let positions = kept.iter().map(|&v| mesh.positions[v]).collect();
        // Every merge was checked to leave a manifold.
        let simple = TriMesh::new(positions, &triangles).expect("merging vertices leaves a manifold");
        let mut images = IdVec::filled(None, mesh.positions.len());
        (0u32..).zip(kept.iter()).for_each(|(here, &there)| images[there] = Some(SurfacePoint::Vertex(VertexId(here))));
        for (here, &f) in faces.iter().enumerate() {
            for &(v, weights) in &self.inside[f] {
                images[VertexId(v)] = Some(SurfacePoint::from_barycentric(&simple, FaceId::new(here), weights));
            }
        }
        Simplified { mesh: simple, kept, removals: self.removals, images }
    }
}

/// Area over the sum of the squared sides, 1 for an equilateral triangle.
fn roundness([a, b, c]: [DVec3; 3]) -> f64 {
    let sides_sq = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    4.0 * 3f64.sqrt() * metric::area([a, b, c]) / sides_sq
}

/// Weights that rounding may have taken out of the triangle.
fn inner(weights: [f64; 3]) -> [f64; 3] {
    let positive = weights.map(|w| w.max(0.0));
    let sum: f64 = positive.iter().sum();
    positive.map(|w| w / sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::fixture::{disc, icosphere, torus};
    use std::collections::BTreeMap;

    /// The triangles around every vertex form one fan, and the genus and the boundary are what they were.
    fn check(mesh: &TriMesh, simple: &Simplified, keep: &[VertexId]) {
        assert_eq!(simple.mesh.genus(), mesh.genus());
        assert_eq!(simple.mesh.conn.boundary_loops().len(), mesh.conn.boundary_loops().len());
        assert!(keep.iter().all(|v| simple.kept.iter().any(|k| k == v)));
        assert_eq!(simple.kept.len() + simple.removals.len(), mesh.positions.len());
        assert!(simple.images.iter().all(Option::is_some));
    }

    #[test]
    fn a_sphere_stays_round_and_every_vertex_near_its_place() {
        let mesh = icosphere(4);
        let keep = [VertexId(0), VertexId(7), VertexId(1000)];
        let simple = simplify(&mesh, &keep, 300);
        check(&mesh, &simple, &keep);
        assert!(simple.kept.len() <= 300);
        for (v, image) in simple.images.iter_ids() {
            let image = image.expect("every vertex has a place").position(&simple.mesh);
            assert!(image.distance(mesh.positions[v]) < 0.1, "{v} went to {image}");
        }
    }

    #[test]
    fn undoing_the_merges_gives_the_mesh_back() {
        for mesh in [icosphere(4), torus(36, 24), disc(16)] {
            let simple = simplify(&mesh, &[VertexId(0)], 220);
            check(&mesh, &simple, &[VertexId(0)]);
            let sorted = |mut t: [u32; 3]| {
                let first = (0..3).min_by_key(|&i| t[i]).expect("three corners");
                t.rotate_left(first);
                t
            };
            let mut faces: BTreeMap<[u32; 3], ()> = BTreeMap::new();
            faces.extend(simple.mesh.faces().iter().map(|f| (sorted(f.map(|v| simple.kept[v].0)), ())));
            for removal in simple.removals.iter().rev() {
                for i in removal.fan() {
                    let drawn = [removal.apex, i, removal.after(i)].map(|k| removal.ring[k].0);
                    assert!(faces.remove(&sorted(drawn)).is_some(), "{drawn:?} is not there");
                }
                for i in 0..removal.sectors() {
                    let (a, b) = (removal.ring[i].0, removal.ring[removal.after(i)].0);
                    faces.insert(sorted([removal.vertex.0, a, b]), ());
                }
            }
            let given: BTreeMap<[u32; 3], ()> = mesh.faces().iter().map(|f| (sorted(f.map(|v| v.0)), ())).collect();
            assert_eq!(faces, given);
        }
    }
}
