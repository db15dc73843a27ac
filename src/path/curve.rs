//! Closed curves that tell whether a path opens a handle.
//!
//! Between a point of a region's boundary and another one of the same boundary a path separates the region unless it
//! crosses some closed curve an odd number of times. The curves that need looking at come from a spanning tree of the
//! region's faces and a spanning tree of its vertices that shares no edge with it: every edge in neither closes one path
//! of the former (the tree-cotree decomposition of D. Eppstein, "Dynamic generators of topologically embedded graphs",
//! SODA 2003).

use super::cut_mesh::{CutMesh, Place};
use super::region::on_arc;
use crate::mesh::{FaceId, HalfedgeId, Id, IdVec, VertexId, corner, face_of};
use std::collections::HashSet;

/// A closed curve through faces of a cut mesh, crossing edges in their middles.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The crossed edges, by their lower-numbered halves.
    edges: HashSet<HalfedgeId>,
}

impl Curve {
    /// True if the curve passes, an odd number of times, between two places on the boundary of a face.
    pub fn is_between(&self, cut: &CutMesh, f: FaceId, a: Place, b: Place) -> bool {
        let [a, b] = [a, b].map(|place| nearest_end(cut, place));
        let joins = |h: &HalfedgeId| [[a, b], [b, a]].contains(&[cut.conn.from(*h), cut.conn.to(*h)]);
        // Where the curve crosses the face, it leaves one corner on one side and two on the other.
        a != b && (0..3).map(|i| corner(f, i)).find(joins).is_some_and(|h| self.crosses(cut, h))
    }

    fn crosses(&self, cut: &CutMesh, h: HalfedgeId) -> bool {
        self.edges.contains(&cut.conn.edge_representative(h))
    }
}

/// The end of its edge that a place shares its side of the edge's middle with.
fn nearest_end(cut: &CutMesh, place: Place) -> VertexId {
    match place {
        Place::Vertex(v) => v,
        Place::Edge(h, t) if t < 0.5 => cut.conn.from(h),
        Place::Edge(h, _) => cut.conn.to(h),
    }
}

/// Closed curves in the region of face `seed` of which a path opens a handle if and only if it crosses one an odd number
/// of times; the path must start and end on one boundary walk of the region, or at one landmark inside.
///
/// There are `2 genus + walks - 1`, of which the last ones only run around boundary walks; none if the region is a disc.
pub fn closed_curves(cut: &CutMesh, seed: FaceId) -> Vec<Curve> {
    let tree = DualTree::grow(cut, seed);
    let mut forest = Forest::new(cut);
    let mut curves = Vec::new();
    for h in tree.faces.iter().flat_map(|&f| (0..3).map(move |i| corner(f, i))) {
        let is_free = cut.conn.is_edge_representative(h) && cut.arc_at(h).is_none() && !tree.crosses(cut, h);
        if is_free && !forest.join(cut.conn.from(h), cut.conn.to(h)) {
            curves.push(tree.close(cut, h));
        }
    }
    curves
}

/// A spanning tree of the faces of a region.
struct DualTree {
    /// The faces in the order in which the tree reaches them.
    faces: Vec<FaceId>,
    /// The half-edge through which the tree enters each face, in that face; none for the root.
    entry: IdVec<FaceId, Option<HalfedgeId>>,
}

impl DualTree {
    fn grow(cut: &CutMesh, root: FaceId) -> Self {
        let mut entry = IdVec::filled(None, cut.conn.face_count());
        let mut reached = IdVec::filled(false, cut.conn.face_count());
        reached[root] = true;
        let mut faces = vec![root];
        let mut at = 0;
        while let Some(&f) = faces.get(at) {
            at += 1;
            let open = (0..3).map(|i| corner(f, i)).filter(|&h| cut.arc_at(h).is_none());
            for t in open.filter_map(|h| cut.conn.twin(h)) {
                if !std::mem::replace(&mut reached[face_of(t)], true) {
                    entry[face_of(t)] = Some(t);
                    faces.push(face_of(t));
                }
            }
        }
        DualTree { faces, entry }
    }

    fn crosses(&self, cut: &CutMesh, h: HalfedgeId) -> bool {
        let enters = |h: HalfedgeId| self.entry[face_of(h)] == Some(h);
        enters(h) || cut.conn.twin(h).is_some_and(enters)
    }

    /// The closed curve across the edge of `h` and back through the tree.
    fn close(&self, cut: &CutMesh, h: HalfedgeId) -> Curve {
        let mut edges = HashSet::from([cut.conn.edge_representative(h)]);
        for mut f in [Some(h), cut.conn.twin(h)].into_iter().flatten().map(face_of) {
            while let Some(entry) = self.entry[f] {
                let edge = cut.conn.edge_representative(entry);
                // What both ways to the root have in common is not part of the curve.
                if !edges.remove(&edge) {
                    edges.insert(edge);
                }
                let Some(t) = cut.conn.twin(entry) else { break };
                f = face_of(t);
            }
        }
        Curve { edges }
    }
}

/// A forest over the vertices, all of those on arcs counting as one.
struct Forest {
    parent: Vec<u32>,
}

impl Forest {
    fn new(cut: &CutMesh) -> Self {
        let mut arcs = None;
        let parent = cut.conn.vertices().map(|v| {
            let own = v.index() as u32;
            if on_arc(cut, v) { *arcs.get_or_insert(own) } else { own }
        });
        Forest { parent: parent.collect() }
    }

    fn root(&mut self, v: VertexId) -> u32 {
        let mut at = v.index() as u32;
        while self.parent[at as usize] != at {
            self.parent[at as usize] = self.parent[self.parent[at as usize] as usize];
            at = self.parent[at as usize];
        }
        at
    }

    /// Joins two vertices; false if they were joined before.
    fn join(&mut self, a: VertexId, b: VertexId) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a as usize] = b;
        a != b
    }
}
