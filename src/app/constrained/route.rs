//! The cheapest way for a path: over free vertices, and over the middles of edges between taken ones.
//!
//! Only an edge whose two ends other paths or features hold can block a path; splitting it adds a Steiner vertex
//! (WARP 4.2), so it is dear. Vertices beside taken ones cost more than others, so that paths leave room beside them.

use crate::mesh::{HalfedgeId, VertexId, face_of, next, prev};
use crate::path::cut_mesh::CutMesh;
use crate::solve::nearest::Nearest;
use glam::DVec3;
use std::collections::{BTreeMap, BinaryHeap};

/// What a path pays besides its length.
#[derive(Clone, Copy, Debug)]
pub struct Tolls {
    /// For every place on it, in units of length: a path over few vertices leaves more to others.
    pub hop: f64,
    /// A way beside a taken vertex counts as this many times its length.
    pub crowded: f64,
    /// A split edge counts as a detour of this many times its length.
    pub split: f64,
}

/// What is asked for.
pub struct Route {
    /// From and to.
    pub ends: [VertexId; 2],
    /// The half-edges that leave each end into the faces in which the path may leave or arrive; along the first one, and
    /// one behind the last, other paths run.
    pub sectors: [Vec<HalfedgeId>; 2],
    /// What it pays.
    pub tolls: Tolls,
}

/// A place between the ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stop {
    /// A vertex that no path holds.
    Vertex(VertexId),
    /// The middle of the edge between two vertices, the lower one first.
    Middle([VertexId; 2]),
}

/// A way that was found.
pub struct Found {
    /// The places between the ends, in order.
    pub stops: Vec<Stop>,
    /// What it costs, in units of length: no less than the distance of the ends.
    pub cost: f64,
}

struct Search<'a> {
    cut: &'a CutMesh,
    route: &'a Route,
    /// Places by what the way over them costs at least.
    queue: BinaryHeap<Nearest<Stop>>,
    /// The cost of every place reached, and from where; none from the start.
    reached: BTreeMap<Stop, (f64, Option<Stop>)>,
}

/// Finds the cheapest way (A*); none if there is none.
pub fn route(cut: &CutMesh, route: &Route) -> Option<Found> {
    let goal = Stop::Vertex(route.ends[1]);
    let mut search = Search { cut, route, queue: BinaryHeap::new(), reached: BTreeMap::new() };
    search.leave();
    while let Some(Nearest(least, at)) = search.queue.pop() {
        let cost = search.reached[&at].0;
        if at == goal {
            return Some(Found { stops: search.trail(at), cost });
        }
        if cost + search.ahead(at) < least {
            continue;
        }
        match at {
            Stop::Vertex(v) => search.cut.conn.outgoing(v).for_each(|h| search.go_on(at, cost, h)),
            Stop::Middle([p, q]) => {
                for h in [search.cut.conn.find(p, q), search.cut.conn.find(q, p)].into_iter().flatten() {
                    search.cross(at, cost, h);
                }
            }
        }
    }
    None
}

impl Search<'_> {
    /// Everything that the start's sector touches.
    fn leave(&mut self) {
        for &h in &self.route.sectors[0] {
            self.step_along(None, 0.0, h);
            self.step_across(None, 0.0, next(h));
        }
    }

    /// From a vertex along a half-edge and into the face at its left.
    fn go_on(&mut self, at: Stop, cost: f64, h: HalfedgeId) {
        self.step_along(Some(at), cost, h);
        self.step_across(Some(at), cost, next(h));
    }

    /// From the middle of a half-edge into the face at its left.
    fn cross(&mut self, at: Stop, cost: f64, h: HalfedgeId) {
        let apex = self.cut.conn.from(prev(h));
        self.reach(Some(at), cost, Stop::Vertex(apex), prev(h));
        self.step_across(Some(at), cost, next(h));
        self.step_across(Some(at), cost, prev(h));
    }

    /// To the vertex at the end of a half-edge; a path into the goal arrives along the edge's other half.
    fn step_along(&mut self, from: Option<Stop>, cost: f64, h: HalfedgeId) {
        let to = self.cut.conn.to(h);
        let Some(t) = self.cut.conn.twin(h) else { return };
        if self.cut.arc_at(h).is_none() {
            self.reach(from, cost, Stop::Vertex(to), t);
        }
    }

    /// To the middle of an edge that blocks.
    fn step_across(&mut self, from: Option<Stop>, cost: f64, h: HalfedgeId) {
        let [a, b] = [self.cut.conn.from(h), self.cut.conn.to(h)];
        let blocks = self.cut.is_blocked(a) && self.cut.is_blocked(b) && self.cut.arc_at(h).is_none();
        if blocks && self.cut.conn.twin(h).is_some() {
            self.reach(from, cost, Stop::Middle([a.min(b), a.max(b)]), h);
        }
    }

    /// Notes a place; `at` is a half-edge that leaves it, with which the goal tells whether it is reached in its sector.
    fn reach(&mut self, from: Option<Stop>, cost: f64, to: Stop, at: HalfedgeId) {
        if let Stop::Vertex(v) = to
            && (if v == self.route.ends[1] { !self.arrives(from, at) } else { self.cut.is_blocked(v) })
        {
            return;
        }
        let start = from.map_or(self.cut.positions[self.route.ends[0]], |s| self.position(s));
        let Tolls { hop, crowded, split } = self.route.tolls;
        let way = start.distance(self.position(to)) + hop;
        let toll = match to {
            Stop::Vertex(v) if v == self.route.ends[1] => way,
            Stop::Vertex(v) => way * if self.is_crowded(v) { crowded } else { 1.0 },
            Stop::Middle([p, q]) => {
                way * crowded + (self.cut.positions[p].distance(self.cut.positions[q]) + hop) * split
            }
        };
        self.note(from, cost + toll, to);
    }

    fn note(&mut self, from: Option<Stop>, cost: f64, to: Stop) {
        if self.reached.get(&to).is_none_or(|r| cost < r.0) {
            self.reached.insert(to, (cost, from));
            self.queue.push(Nearest(cost + self.ahead(to), to));
        }
    }

    /// The way ahead costs at least so much.
    fn ahead(&self, at: Stop) -> f64 {
        self.position(at).distance(self.cut.positions[self.route.ends[1]])
    }

    /// True if half-edge `at`, which leaves the goal, lies in its sector: from the middle of an edge with its face, from a
    /// vertex as an edge without another path.
    fn arrives(&self, from: Option<Stop>, at: HalfedgeId) -> bool {
        let sector = &self.route.sectors[1];
        match from {
            Some(Stop::Middle(_)) => sector.iter().any(|&h| face_of(h) == face_of(at)),
            _ => self.cut.arc_at(at).is_none() && sector.contains(&at),
        }
    }

    fn is_crowded(&self, v: VertexId) -> bool {
        self.cut.conn.outgoing(v).any(|h| self.cut.is_blocked(self.cut.conn.to(h)))
    }

    fn position(&self, stop: Stop) -> DVec3 {
        match stop {
            Stop::Vertex(v) => self.cut.positions[v],
            Stop::Middle([p, q]) => (self.cut.positions[p] + self.cut.positions[q]) * 0.5,
        }
    }

    /// The places on the way to the goal, without the goal.
    fn trail(&self, goal: Stop) -> Vec<Stop> {
        let mut trail: Vec<Stop> = Vec::new();
        let mut at = self.reached[&goal].1;
        while let Some(stop) = at {
            trail.push(stop);
            at = self.reached[&stop].1;
        }
        trail.reverse();
        trail
    }
}
