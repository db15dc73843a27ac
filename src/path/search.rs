//! Shortest paths between two corners of a region, over vertices and edge nodes (VORONOI 4).
//!
//! Arcs that are already on the cut mesh run along its edges, so a path that never enters a vertex on an arc and never
//! uses a node of an arc's edge cannot cross one: crossing is decided by connectivity alone.
//! The search is A* with the straight-line distance, which never overestimates a path on the surface.

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
    /// Length in mesh units.
    pub length: f64,
}

#[derive(PartialEq)]
struct Open {
    estimate: f64,
    length: f64,
    node: u32,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.estimate.total_cmp(&self.estimate).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[derive(Clone, Copy)]
struct Label {
    epoch: u32,
    parent: u32,
    face: FaceId,
    length: f64,
}

const NO_NODE: u32 = u32::MAX;

/// Reusable working memory of the search: one label per node, valid if it carries the current epoch.
#[derive(Default)]
pub struct Searcher {
    labels: Vec<Label>,
    epoch: u32,
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
}

/// No restriction beyond the arcs.
pub struct Anywhere;

impl Passage for Anywhere {}

/// What one search knows.
struct Query<'a> {
    cut: &'a CutMesh,
    goal: &'a Terminal,
    goal_faces: Vec<FaceId>,
    goal_position: DVec3,
    passage: &'a dyn Passage,
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
        let goal_faces = goal.sector.iter().map(|&h| face_of(h)).collect();
        let goal_position = cut.positions[goal.vertex];
        let query = Query { cut, goal, goal_faces, goal_position, passage };
        self.begin(cut.node_count());
        for &h in &start.sector {
            if passage.face(face_of(h)) {
                self.expand_vertex_face(&query, NO_NODE, 0.0, cut.positions[start.vertex], h);
            }
        }
        let goal_node = cut.node_at(goal.vertex);
        while let Some(Open { length, node, .. }) = self.queue.pop() {
            if node == goal_node {
                return Some(self.trace(cut, start.vertex, goal_node));
            }
            if length > self.labels[node as usize].length {
                continue;
            }
            self.expand(&query, node, length);
        }
        None
    }

    fn begin(&mut self, nodes: usize) {
        self.epoch += 1;
        self.queue.clear();
        let empty = Label { epoch: 0, parent: NO_NODE, face: FaceId(0), length: 0.0 };
        self.labels.resize(nodes.max(self.labels.len()), empty);
    }

    fn expand(&mut self, query: &Query, node: u32, length: f64) {
        let cut = query.cut;
        let from = cut.node_position(node);
        match cut.place(node) {
            Place::Vertex(v) => {
                for h in cut.conn.outgoing(v) {
                    if query.passage.face(face_of(h)) {
                        self.expand_vertex_face(query, node, length, from, h);
                    }
                }
            }
            Place::Edge(h, _) => {
                // Two steps on end through one face never beat the straight one, except along an arc; there they cross.
                let came_through = self.labels[node as usize].face;
                for side in [Some(h), cut.conn.twin(h)].into_iter().flatten() {
                    let f = face_of(side);
                    if f != came_through && query.passage.face(f) {
                        self.reach_vertex(query, node, length, from, f, cut.conn.from(prev(side)));
                        self.reach_edge(query, node, length, from, next(side));
                        self.reach_edge(query, node, length, from, prev(side));
                    }
                }
            }
        }
    }

    /// From the vertex that `h` leaves into the face left of `h`: along its two sides, and to the opposite edge.
    fn expand_vertex_face(&mut self, query: &Query, node: u32, length: f64, from: DVec3, h: HalfedgeId) {
        let f = face_of(h);
        for side in [h, prev(h)] {
            if query.cut.arc_at(side).is_none() {
                let far = if side == h { query.cut.conn.to(h) } else { query.cut.conn.from(side) };
                self.reach_vertex(query, node, length, from, f, far);
            }
        }
        self.reach_edge(query, node, length, from, next(h));
    }

    fn reach_vertex(&mut self, query: &Query, parent: u32, length: f64, from: DVec3, f: FaceId, v: VertexId) {
        let arrives = v == query.goal.vertex && query.goal_faces.contains(&f);
        if arrives || (!query.cut.is_blocked(v) && query.passage.vertex(v)) {
            self.relax(query, parent, length, from, f, query.cut.node_at(v));
        }
    }

    fn reach_edge(&mut self, query: &Query, parent: u32, length: f64, from: DVec3, side: HalfedgeId) {
        if query.cut.arc_at(side).is_none() && query.passage.edge(side) {
            for node in query.cut.nodes_on(side).iter() {
                self.relax(query, parent, length, from, face_of(side), node);
            }
        }
    }

    fn relax(&mut self, query: &Query, parent: u32, length: f64, from: DVec3, face: FaceId, node: u32) {
        let at = query.cut.node_position(node);
        let length = length + from.distance(at);
        let label = &mut self.labels[node as usize];
        if label.epoch != self.epoch || length < label.length {
            *label = Label { epoch: self.epoch, parent, face, length };
            self.queue.push(Open { estimate: length + at.distance(query.goal_position), length, node });
        }
    }

    fn trace(&self, cut: &CutMesh, start: VertexId, goal: u32) -> Path {
        let mut nodes = Vec::new();
        let mut faces = Vec::new();
        let mut node = goal;
        while node != NO_NODE {
            let label = self.labels[node as usize];
            nodes.push(node);
            faces.push(label.face);
            node = label.parent;
        }
        nodes.push(cut.node_at(start));
        nodes.reverse();
        faces.reverse();
        let mut path = Path { nodes, faces, length: self.labels[goal as usize].length };
        path.shorten_repeats(cut);
        path
    }
}

impl Path {
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
