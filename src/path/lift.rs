//! Arcs on a simplified mesh carried back to the mesh it was made from.
//!
//! The merges are undone one by one, the last first. Undoing one fills the ring of the vertex, laid out flat, with other
//! triangles; the arcs stay where they are in that plane, and are read off again as polylines with a point on every spoke
//! that they cross. So arcs that met at their ends alone still do, and each keeps its place on the surface.

use super::rebuild::Curve;
use crate::mesh::simplify::{Removal, Simplified};
use crate::mesh::{ArcId, IdVec, SurfacePoint, TriMesh, VertexId, face_of};
use glam::DVec2;
use std::collections::{BTreeSet, HashMap};
use std::f64::consts::{PI, TAU};

/// Crossings stay off the ends of their edge by this share of its length.
const LEAST_GAP: f64 = 1e-9;
/// Turns below this angle may be rounding.
const TINY: f64 = 1e-9;
/// A step from neighbour to neighbour that misses a vertex by less than this angle leads through it.
const STRAIGHT: f64 = 1e-6;
/// Bends of a smaller sine are given up.
const LEAST_BEND: f64 = 1e-3;
/// Stands for no neighbour along an arc.
const NONE: u32 = u32::MAX;

/// Carries curves from a simplified mesh to `mesh`.
pub fn lift(mesh: &TriMesh, simplified: &Simplified, curves: &IdVec<ArcId, Curve>) -> IdVec<ArcId, Curve> {
    let mut lifting = Lifting::new(simplified, curves);
    simplified.removals.iter().rev().for_each(|removal| lifting.undo(removal));
    lifting.curves(mesh)
}

/// Two vertices joined by an edge, the lower first.
type Ends = [VertexId; 2];
/// The corners of a triangle, the lowest first.
type Corners = [VertexId; 3];

fn ends(a: VertexId, b: VertexId) -> Ends {
    if a < b { [a, b] } else { [b, a] }
}

fn corners(mut triangle: [VertexId; 3]) -> Corners {
    triangle.sort_unstable();
    triangle
}

#[derive(Clone, Copy, Debug)]
enum Stop {
    Vertex(VertexId),
    /// At a share of the way from the lower end to the other.
    Edge(Ends, f64),
    /// With the weights of the corners.
    Face(Corners, [f64; 3]),
}

/// A stop of an arc and the one behind it.
struct Link {
    stop: Stop,
    share: f64,
    behind: u32,
}

struct Lifting {
    links: Vec<Link>,
    /// The first link of every arc.
    first: IdVec<ArcId, u32>,
    at_vertex: HashMap<VertexId, Vec<u32>>,
    on_edge: HashMap<Ends, Vec<u32>>,
    in_face: HashMap<Corners, Vec<u32>>,
}

/// A point of a polyline across a ring.
struct Point {
    stop: Stop,
    place: DVec2,
    /// See [`Ring`].
    direction: usize,
    share: f64,
}

impl Lifting {
    fn new(simplified: &Simplified, curves: &IdVec<ArcId, Curve>) -> Self {
        let mut lifting = Lifting {
            links: Vec::new(),
            first: IdVec::default(),
            at_vertex: HashMap::new(),
            on_edge: HashMap::new(),
            in_face: HashMap::new(),
        };
        let conn = &simplified.mesh.conn;
        for curve in curves.iter() {
            lifting.first.push(lifting.links.len() as u32);
            for (i, &(point, share)) in curve.iter().enumerate() {
                let stop = match point {
                    SurfacePoint::Vertex(v) => Stop::Vertex(simplified.kept[v]),
                    SurfacePoint::Edge(h, t) => {
                        let [a, b] = [conn.from(h), conn.to(h)].map(|v| simplified.kept[v]);
                        Stop::Edge(ends(a, b), if a < b { t } else { 1.0 - t })
                    }
                    SurfacePoint::Face(f, weights) => in_triangle(conn.face(f).map(|v| simplified.kept[v]), weights),
                };
                let before = if i == 0 { NONE } else { lifting.links.len() as u32 - 1 };
                let link = lifting.add(stop, share);
                lifting.join(before, link);
            }
        }
        lifting
    }

    /// Puts a link where its stop is.
    fn place(&mut self, link: u32, stop: Stop) {
        self.links[link as usize].stop = stop;
        match stop {
            Stop::Vertex(v) => self.at_vertex.entry(v).or_default().push(link),
            Stop::Edge(ends, _) => self.on_edge.entry(ends).or_default().push(link),
            Stop::Face(corners, _) => self.in_face.entry(corners).or_default().push(link),
        }
    }

    fn add(&mut self, stop: Stop, share: f64) -> u32 {
        let link = self.links.len() as u32;
        self.links.push(Link { stop, share, behind: NONE });
        self.place(link, stop);
        link
    }

    fn join(&mut self, before: u32, behind: u32) {
        if before != NONE {
            self.links[before as usize].behind = behind;
        }
    }

    /// Brings a vertex back.
    fn undo(&mut self, removal: &Removal) {
        let ring = Ring::new(removal);
        let at = |i: usize| removal.ring[i];
        let apex = at(removal.apex);
        let across = ring.drawn.iter().filter_map(|&i| self.on_edge.remove(&ends(apex, at(i))));
        let mut inner: BTreeSet<u32> = across.flatten().collect();
        let inside = removal.fan().filter_map(|i| self.in_face.remove(&corners([apex, at(i), at(removal.after(i))])));
        inner.extend(inside.flatten());
        for chain in self.chains(removal, &ring, &inner) {
            self.redraw(removal, &ring, &chain);
        }
    }

    /// The runs of steps across a ring, each from a stop on it to the next one on it.
    fn chains(&self, removal: &Removal, ring: &Ring, inner: &BTreeSet<u32>) -> Vec<Vec<u32>> {
        let side = |i: usize| ends(removal.ring[i], removal.ring[removal.after(i)]);
        let on_sides = (0..removal.sectors()).filter_map(|i| self.on_edge.get(&side(i)));
        let at_corners = removal.ring.iter().filter_map(|v| self.at_vertex.get(v));
        let chain = |&start: &u32| {
            let mut chain = vec![start];
            loop {
                let last = chain[chain.len() - 1];
                let behind = self.links[last as usize].behind;
                if behind != NONE && inner.contains(&behind) {
                    chain.push(behind);
                    continue;
                }
                let is_across =
                    behind != NONE && (chain.len() > 1 || ring.holds_step(self.stop(start), self.stop(behind)));
                chain.push(behind);
                return is_across.then_some(chain);
            }
        };
        on_sides.chain(at_corners).flatten().filter_map(chain).collect()
    }

    fn stop(&self, link: u32) -> Stop {
        self.links[link as usize].stop
    }

    /// Reads a chain off again as the spokes that it crosses, with its bends between them.
    fn redraw(&mut self, removal: &Removal, ring: &Ring, chain: &[u32]) {
        let point = |&link: &u32| {
            let Link { stop, share, .. } = self.links[link as usize];
            let place = ring.place(stop);
            Point { stop, place, direction: ring.direction(stop, place), share }
        };
        let points: Vec<Point> = chain.iter().map(point).collect();
        if let [
            Point { stop: Stop::Vertex(_), place: p, share: s, .. },
            Point { stop: Stop::Vertex(_), place: q, share: t, .. },
        ] = points.as_slice()
            && (p.angle_to(*q).abs() - PI).abs() < STRAIGHT
        {
            let share = s + (t - s) * p.length() / (p.length() + q.length());
            let link = self.add(Stop::Vertex(removal.vertex), share);
            self.join(chain[0], link);
            self.join(link, chain[1]);
            return;
        }
        let mut kept = 0;
        for i in 1..points.len() {
            if i + 1 < points.len() && is_straight(points[kept].place, points[i].place, points[i + 1].place) {
                continue;
            }
            let mut before = chain[kept];
            for (spoke, t, share) in ring.crossings(&points[kept], &points[i]) {
                let (v, w) = (removal.vertex, removal.ring[spoke]);
                let link = self.add(Stop::Edge(ends(v, w), if v < w { t } else { 1.0 - t }), share);
                self.join(before, link);
                before = link;
            }
            self.join(before, chain[i]);
            if i + 1 < points.len() {
                let stop = ring.stop_in(points[i].direction / 2, points[i].place);
                self.place(chain[i], stop);
            }
            kept = i;
        }
    }

    fn curves(&self, mesh: &TriMesh) -> IdVec<ArcId, Curve> {
        let curve = |&first: &u32| {
            let behind = |&link: &u32| Some(self.links[link as usize].behind).filter(|&b| b != NONE);
            let links = std::iter::successors(Some(first), behind);
            let point = |link: u32| {
                let Link { stop, share, .. } = self.links[link as usize];
                Some(match stop {
                    Stop::Vertex(v) => (SurfacePoint::Vertex(v), share),
                    Stop::Face([a, b, c], weights) => (in_face(mesh, [a, b, c], weights)?, share),
                    // An edge on the boundary has a half in one direction only.
                    Stop::Edge([a, b], t) => match mesh.conn.find(a, b) {
                        Some(h) => (SurfacePoint::Edge(h, t), share),
                        None => (SurfacePoint::Edge(mesh.conn.find(b, a)?, 1.0 - t), share),
                    },
                })
            };
            links.filter_map(point).collect()
        };
        self.first.iter().map(curve).collect()
    }
}

/// The ring of a vertex laid out flat, divided by the edges from its apex.
///
/// Directions from the vertex are numbered counter-clockwise: `2 i` is the spoke to neighbour `i`, `2 i + 1` the sector
/// between that and the next.
struct Ring<'a> {
    removal: &'a Removal,
    /// The neighbours that an edge from the apex across the ring leads to.
    drawn: Vec<usize>,
    angles: Vec<f64>,
}

impl<'a> Ring<'a> {
    fn new(removal: &'a Removal) -> Self {
        let n = removal.ring.len();
        let is_beside = |i: usize| {
            let gap = i.abs_diff(removal.apex);
            gap <= 1 || (removal.is_inner && gap == n - 1)
        };
        let drawn = (0..n).filter(|&i| !is_beside(i)).collect();
        let angles = removal.places.iter().map(|p| p.to_angle().rem_euclid(TAU)).collect();
        Ring { removal, drawn, angles }
    }

    fn index(&self, v: VertexId) -> Option<usize> {
        self.removal.ring.iter().position(|&w| w == v)
    }

    /// The neighbours at a stop on the ring; none if it does not lie there.
    fn indices(&self, stop: Stop) -> Option<Vec<usize>> {
        match stop {
            Stop::Vertex(v) => Some(vec![self.index(v)?]),
            Stop::Edge([a, b], _) => Some(vec![self.index(a)?, self.index(b)?]),
            Stop::Face(..) => None,
        }
    }

    /// True if a step between stops on the ring crosses one of the triangles drawn to the apex, or runs along an edge
    /// between two of them.
    fn holds_step(&self, from: Stop, to: Stop) -> bool {
        let (Some(mut all), Some(other)) = (self.indices(from), self.indices(to)) else { return false };
        let is_edge = all.len() == 1 && other.len() == 1;
        all.extend(other);
        all.sort_unstable();
        all.dedup();
        let apex = self.removal.apex;
        if is_edge {
            return all.len() == 2 && all.contains(&apex) && self.drawn.iter().any(|i| all.contains(i));
        }
        let is_fan = |i: usize| [apex, i, self.removal.after(i)].iter().all(|k| all.contains(k));
        all.len() == 3 && self.removal.fan().any(is_fan)
    }

    fn place(&self, stop: Stop) -> DVec2 {
        let at = |v: VertexId| self.index(v).map_or(DVec2::ZERO, |i| self.removal.places[i]);
        match stop {
            Stop::Vertex(v) => at(v),
            Stop::Edge([a, b], t) => at(a).lerp(at(b), t),
            Stop::Face(corners, weights) => (0..3).map(|k| at(corners[k]) * weights[k]).sum(),
        }
    }

    /// The stop at a place in a sector.
    fn stop_in(&self, sector: usize, place: DVec2) -> Stop {
        let Removal { vertex, ring, places, .. } = self.removal;
        let after = self.removal.after(sector);
        let (a, b) = (places[sector], places[after]);
        let whole = a.perp_dot(b);
        let (first, second) = (place.perp_dot(b) / whole, a.perp_dot(place) / whole);
        in_triangle([*vertex, ring[sector], ring[after]], [1.0 - first - second, first, second])
    }

    /// The direction of a stop from the vertex.
    fn direction(&self, stop: Stop, place: DVec2) -> usize {
        match self.indices(stop).as_deref() {
            Some(&[i]) => 2 * i,
            // A side of the ring, from one neighbour to the next.
            Some(&[i, j]) if self.is_side(i, j) => 2 * i + 1,
            Some(&[i, j]) if self.is_side(j, i) => 2 * j + 1,
            _ => 2 * self.sector(place) + 1,
        }
    }

    fn is_side(&self, i: usize, j: usize) -> bool {
        i < self.removal.sectors() && self.removal.after(i) == j
    }

    /// The sector that a place inside the ring lies in.
    fn sector(&self, place: DVec2) -> usize {
        let angle = place.to_angle().rem_euclid(TAU);
        let reached = self.angles.iter().rposition(|&a| a <= angle).unwrap_or(0);
        reached.min(self.removal.sectors() - 1)
    }

    /// The spokes that a straight step crosses, in order: each with the share of the way from the vertex to its neighbour,
    /// and the share of the arc.
    fn crossings(&self, from: &Point, to: &Point) -> Vec<(usize, f64, f64)> {
        let (p, q) = (from.place, to.place);
        let mut reached: f64 = 0.0;
        let crossing = |spoke: usize| {
            let towards = self.removal.places[spoke];
            let (a, b) = (towards.perp_dot(p), towards.perp_dot(q));
            let share = a / (a - b);
            reached = reached.max(if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 });
            let t = p.lerp(q, reached).dot(towards) / towards.length_squared();
            (spoke, t.clamp(LEAST_GAP, 1.0 - LEAST_GAP), from.share + (to.share - from.share) * reached)
        };
        self.spokes_between(from.direction, to.direction, p.angle_to(q)).into_iter().map(crossing).collect()
    }

    /// The spokes between two directions, in the order in which a straight step that turns by `turn` crosses them.
    fn spokes_between(&self, at: usize, goal: usize, turn: f64) -> Vec<usize> {
        let spokes =
            |directions: &mut dyn Iterator<Item = usize>| directions.filter(|d| d % 2 == 0).map(|d| d / 2).collect();
        if !self.removal.is_inner {
            return match goal > at {
                true => spokes(&mut (at + 1..goal)),
                false => spokes(&mut (goal + 1..at).rev()),
            };
        }
        let all = 2 * self.removal.ring.len();
        let (left, right) = ((goal + all - at) % all, (at + all - goal) % all);
        let leftward = if turn.abs() < TINY { left < right } else { turn > 0.0 };
        match (left, leftward) {
            (0, _) => Vec::new(),
            (_, true) => spokes(&mut (1..left).map(|k| (at + k) % all)),
            (_, false) => spokes(&mut (1..right).map(|k| (at + all - k) % all)),
        }
    }
}

/// A stop in a triangle whose corners have weights.
fn in_triangle(triangle: [VertexId; 3], weights: [f64; 3]) -> Stop {
    let sorted = corners(triangle);
    let weight = |v: VertexId| (0..3).find(|&k| triangle[k] == v).map_or(0.0, |k| weights[k]);
    Stop::Face(sorted, sorted.map(weight))
}

/// The point of a mesh in the face with the given corners; none if there is none.
fn in_face(mesh: &TriMesh, [a, b, c]: Corners, weights: [f64; 3]) -> Option<SurfacePoint> {
    let around = mesh.conn.outgoing(a).map(face_of);
    let f = around.into_iter().find(|&f| corners(mesh.face(f)) == [a, b, c])?;
    let weight = |v: VertexId| [a, b, c].iter().position(|&w| w == v).map_or(0.0, |k| weights[k]);
    Some(SurfacePoint::Face(f, mesh.face(f).map(weight)))
}

/// True if a polyline hardly bends at `q`.
fn is_straight(p: DVec2, q: DVec2, r: DVec2) -> bool {
    let (a, b) = (q - p, r - q);
    a.perp_dot(b).abs() <= LEAST_BEND * a.length() * b.length() && a.dot(b) >= 0.0
}
