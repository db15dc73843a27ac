//! Shortest paths between two corners of a region, over vertices and edge nodes (VORONOI 4).
//!
//! Arcs that are already on the cut mesh run along its edges, so a path that never enters a vertex on an arc and never
//! uses a node of an arc's edge cannot cross one: crossing is decided by connectivity alone.
//! The search is A* with the straight-line distance, which never overestimates a path on the surface.
//!
//! A path that must cross a closed curve an odd number of times is searched on two copies of the region that are joined
//! crosswise along the curve: it starts on the one copy and ends on the other.

use super::curve::Curve;
use super::cut_mesh::{CutMesh, Place};
use crate::mesh::{FaceId, HalfedgeId, VertexId, face_of, next, prev};
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

/// One end of a path: a landmark's vertex and the faces around it through which the path may leave or arrive.
#[derive(Clone, Debug)]
pub struct Terminal {
    /// The vertex.
    pub vertex: VertexId,
    /// The half-edges leaving the vertex whose left faces are open to the path.
    pub sector: Vec<HalfedgeId>,
}

impl Terminal {
    /// The whole neighbourhood of a vertex.
    pub fn whole(cut: &CutMesh, vertex: VertexId) -> Self {
        Terminal { vertex, sector: cut.conn.outgoing(vertex).collect() }
    }
}

/// A path between two vertices of a cut mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The nodes passed, both ends included.
    pub nodes: Vec<u32>,
    /// For every step the face it crosses (or runs beside).
    pub faces: Vec<FaceId>,
    /// Length in mesh units, every step weighed as the passage said.
    pub length: f64,
}

#[derive(PartialEq)]
struct Open {
    estimate: f64,
    length: f64,
    state: u32,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.estimate.total_cmp(&self.estimate).then(other.state.cmp(&self.state))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// What is known of a state: a node on one of the copies, numbered `node + copy * nodes`.
#[derive(Clone, Copy)]
struct Label {
    epoch: u32,
    parent: u32,
    face: FaceId,
    length: f64,
}

/// Marks a parent as the node where the path starts; numbers of states stay below it.
const START: u32 = 1 << 31;

/// Reusable working memory of the search: one label per state, valid if it carries the current epoch.
#[derive(Default)]
pub struct Searcher {
    labels: Vec<Label>,
    epoch: u32,
    nodes: u32,
    queue: BinaryHeap<Open>,
}

/// Where a path may pass besides keeping off the arcs.
pub trait Passage {
    /// Whether the path may cross this face.
    fn face(&self, _f: FaceId) -> bool {
        true
    }
    /// Whether the path may cross the edge of this half-edge at its nodes.
    fn edge(&self, _h: HalfedgeId) -> bool {
        true
    }
    /// Whether the path may pass through this vertex.
    fn vertex(&self, _v: VertexId) -> bool {
        true
    }
    /// How many times its length a step through this face counts, not less than 1.
    fn weight(&self, _f: FaceId) -> f64 {
        1.0
    }
}

/// Where paths may pass on a mesh, however it is cut.
pub trait Bounds {
    /// The same on a cut mesh.
    fn on<'a>(&'a self, cut: &'a CutMesh) -> Box<dyn Passage + 'a>;
}

/// No restriction beyond the arcs.
pub struct Anywhere;

impl Bounds for Anywhere {
    fn on<'a>(&'a self, _: &'a CutMesh) -> Box<dyn Passage + 'a> {
        Box::new(Anywhere)
    }
}

impl Passage for Anywhere {}

/// What one search knows.
struct Query<'a> {
    cut: &'a CutMesh,
    goals: &'a [Terminal],
    passage: &'a dyn Passage,
    /// The curve to be crossed an odd number of times.
    curve: Option<&'a Curve>,
    /// The path must be shorter.
    limit: f64,
}

impl Query<'_> {
    fn arrives(&self, v: VertexId, f: FaceId) -> bool {
        self.goals.iter().any(|goal| goal.vertex == v && goal.sector.iter().any(|&h| face_of(h) == f))
    }

    /// The copy on which paths end.
    fn last_copy(&self) -> u32 {
        u32::from(self.curve.is_some())
    }

    /// The copy on which a step through a face arrives.
    fn copy_at(&self, tip: &Tip, face: FaceId, node: u32) -> u32 {
        let crosses = |curve: &Curve| curve.is_between(self.cut, face, tip.place, self.cut.place(node));
        tip.copy ^ u32::from(self.curve.is_some_and(crosses))
    }

    /// A lower bound of the way left; only a single goal is worth the trouble.
    fn remainder(&self, at: DVec3) -> f64 {
        match self.goals {
            [goal] => at.distance(self.cut.positions[goal.vertex]),
            _ => 0.0,
        }
    }
}

/// A path on its way: where it is and how long it has been.
#[derive(Clone, Copy)]
struct Tip {
    state: u32,
    place: Place,
    at: DVec3,
    length: f64,
    copy: u32,
}

impl Searcher {
    /// The shortest path from `start` to `goal` where `passage` lets it, or None if there is none.
    ///
    /// It meets blocked vertices only at its two ends. `start` and `goal` may be the same vertex with different
    /// sectors; the path then leaves through the one and comes back through the other.
    pub fn shortest(
        &mut self,
        cut: &CutMesh,
        start: &Terminal,
        goal: &Terminal,
        passage: &dyn Passage,
    ) -> Option<Path> {
        let goals = std::slice::from_ref(goal);
        let query = Query { cut, goals, passage, curve: None, limit: f64::INFINITY };
        let mut path = self.run(&query, std::slice::from_ref(start))?;
        path.shorten_repeats(cut);
        Some(path)
    }

    /// The shortest path from one of `starts` to one of `goals` that crosses `curve` an odd number of times; None if
    /// there is none shorter than `limit`.
    ///
    /// It may pass a node or a face twice: on the way to a handle and on the way back.
    pub fn shortest_across(
        &mut self,
        cut: &CutMesh,
        starts: &[Terminal],
        goals: &[Terminal],
        curve: &Curve,
        limit: f64,
    ) -> Option<Path> {
        self.run(&Query { cut, goals, passage: &Anywhere, curve: Some(curve), limit }, starts)
    }

    /// The shortest path from one of `starts` to one of `goals`.
    pub fn shortest_of(&mut self, cut: &CutMesh, starts: &[Terminal], goals: &[Terminal]) -> Option<Path> {
        let query = Query { cut, goals, passage: &Anywhere, curve: None, limit: f64::INFINITY };
        let mut path = self.run(&query, starts)?;
        path.shorten_repeats(cut);
        Some(path)
    }

    fn run(&mut self, query: &Query, starts: &[Terminal]) -> Option<Path> {
        self.begin(query);
        for start in starts {
            let place = Place::Vertex(start.vertex);
            let state = START | query.cut.node_at(start.vertex);
            let at = query.cut.positions[start.vertex];
            let tip = Tip { state, place, at, length: 0.0, copy: 0 };
            for &h in start.sector.iter().filter(|&&h| query.passage.face(face_of(h))) {
                self.expand_vertex_face(query, &tip, h);
            }
        }
        while let Some(Open { length, state, .. }) = self.queue.pop() {
            let (copy, node) = (state / self.nodes, state % self.nodes);
            let place = query.cut.place(node);
            let is_goal = |v: VertexId| query.goals.iter().any(|goal| goal.vertex == v);
            if copy == query.last_copy() && matches!(place, Place::Vertex(v) if is_goal(v)) {
                return Some(self.trace(state));
            }
            if length <= self.labels[state as usize].length {
                self.expand(query, &Tip { state, place, at: query.cut.node_position(node), length, copy });
            }
        }
        None
    }

    fn begin(&mut self, query: &Query) {
        self.epoch += 1;
        self.queue.clear();
        self.nodes = query.cut.node_count() as u32;
        let states = query.cut.node_count() * if query.curve.is_some() { 2 } else { 1 };
        let empty = Label { epoch: 0, parent: START, face: FaceId(0), length: 0.0 };
        self.labels.resize(states.max(self.labels.len()), empty);
    }

    fn expand(&mut self, query: &Query, tip: &Tip) {
        let cut = query.cut;
        match tip.place {
            Place::Vertex(v) => {
                for h in cut.conn.outgoing(v) {
                    if query.passage.face(face_of(h)) {
                        self.expand_vertex_face(query, tip, h);
                    }
                }
            }
            Place::Edge(h, _) => {
                // Two steps on end through one face never beat the straight one, except along an arc; there they cross.
                let came_through = self.labels[tip.state as usize].face;
                for side in [Some(h), cut.conn.twin(h)].into_iter().flatten() {
                    let f = face_of(side);
                    if f != came_through && query.passage.face(f) {
                        self.reach_vertex(query, tip, f, cut.conn.from(prev(side)));
                        self.reach_edge(query, tip, next(side));
                        self.reach_edge(query, tip, prev(side));
                    }
                }
            }
        }
    }

    /// From the vertex that `h` leaves into the face left of `h`: along its two sides, and to the opposite edge.
    fn expand_vertex_face(&mut self, query: &Query, tip: &Tip, h: HalfedgeId) {
        let f = face_of(h);
        for side in [h, prev(h)] {
            if query.cut.arc_at(side).is_none() {
                let far = if side == h { query.cut.conn.to(h) } else { query.cut.conn.from(side) };
                self.reach_vertex(query, tip, f, far);
            }
        }
        self.reach_edge(query, tip, next(h));
    }

    fn reach_vertex(&mut self, query: &Query, tip: &Tip, f: FaceId, v: VertexId) {
        let node = query.cut.node_at(v);
        let passes = !query.cut.is_blocked(v) && query.passage.vertex(v);
        // A goal on the wrong copy is not an end, and no place to pass through.
        if passes || (query.arrives(v, f) && query.copy_at(tip, f, node) == query.last_copy()) {
            self.relax(query, tip, f, node);
        }
    }

    fn reach_edge(&mut self, query: &Query, tip: &Tip, side: HalfedgeId) {
        if query.cut.arc_at(side).is_none() && query.passage.edge(side) {
            for node in query.cut.nodes_on(side).iter() {
                self.relax(query, tip, face_of(side), node);
            }
        }
    }

    fn relax(&mut self, query: &Query, tip: &Tip, face: FaceId, node: u32) {
        let at = query.cut.node_position(node);
        let length = tip.length + tip.at.distance(at) * query.passage.weight(face);
        let state = node + query.copy_at(tip, face, node) * self.nodes;
        let label = &mut self.labels[state as usize];
        if (label.epoch != self.epoch || length < label.length) && length < query.limit {
            *label = Label { epoch: self.epoch, parent: tip.state, face, length };
            self.queue.push(Open { estimate: length + query.remainder(at), length, state });
        }
    }

    fn trace(&self, goal: u32) -> Path {
        let mut nodes = Vec::new();
        let mut faces = Vec::new();
        let mut state = goal;
        while state & START == 0 {
            let label = self.labels[state as usize];
            nodes.push(state % self.nodes);
            faces.push(label.face);
            state = label.parent;
        }
        nodes.push(state & !START);
        nodes.reverse();
        faces.reverse();
        Path { nodes, faces, length: self.labels[goal as usize].length }
    }
}

impl Path {
    /// Length in mesh units, whatever steps were weighed with.
    pub fn true_length(&self, cut: &CutMesh) -> f64 {
        self.nodes.windows(2).map(|w| cut.node_position(w[0]).distance(cut.node_position(w[1]))).sum()
    }

    /// Removes excursions that come back to a face already crossed.
    ///
    /// The straight step inside that face is never longer, so they only occur between paths of equal length.
    fn shorten_repeats(&mut self, cut: &CutMesh) {
        while let Some((i, j)) = self.repeat(cut) {
            self.nodes.drain(i + 1..j + 1);
            self.faces.drain(i..j);
        }
    }

    /// The first two steps i < j through one face that a straight step from node i to node j + 1 can replace.
    fn repeat(&self, cut: &CutMesh) -> Option<(usize, usize)> {
        let mut last_step: HashMap<FaceId, usize> = HashMap::new();
        for (i, &f) in self.faces.iter().enumerate() {
            last_step.insert(f, i);
        }
        let apart = |i: usize, j: usize| !collinear(cut, cut.place(self.nodes[i]), cut.place(self.nodes[j + 1]));
        (0..self.faces.len()).map(|i| (i, last_step[&self.faces[i]])).find(|&(i, j)| i < j && apart(i, j))
    }
}

/// True if two places of one face lie on one edge where no step may go: between its nodes, or along an arc.
fn collinear(cut: &CutMesh, a: Place, b: Place) -> bool {
    match (a, b) {
        (Place::Edge(h, _), Place::Edge(k, _)) => cut.conn.edge_representative(h) == cut.conn.edge_representative(k),
        (Place::Edge(h, _), Place::Vertex(v)) | (Place::Vertex(v), Place::Edge(h, _)) => {
            cut.conn.from(h) == v || cut.conn.to(h) == v
        }
        (Place::Vertex(v), Place::Vertex(w)) => cut.conn.find(v, w).is_none_or(|h| cut.arc_at(h).is_some()),
    }
}
