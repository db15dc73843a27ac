//! Loops of edges through given vertices.

use super::cut_mesh::{CutMesh, Place};
use super::search::{Passage, Searcher, Terminal};
use crate::mesh::{HalfedgeId, IdVec, TriMesh, VertexId};

/// Two vertices between which there is no free way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoWay(pub [VertexId; 2]);

/// Closes loops on one mesh, each off the others.
pub struct Closer {
    /// The mesh without nodes on its edges, so that paths run from vertex to vertex.
    bare: CutMesh,
    searcher: Searcher,
    taken: IdVec<VertexId, bool>,
}

impl Closer {
    /// For a mesh on which no loop passes a vertex that is `taken`, unless it lists it.
    pub fn new(mesh: &TriMesh, taken: IdVec<VertexId, bool>) -> Self {
        Closer { bare: CutMesh::new(mesh, &[], 0), searcher: Searcher::default(), taken }
    }

    /// The loop of half-edges through `vertices` in order: along the edge between neighbours, else the shortest way along
    /// edges. Its vertices are taken afterwards.
    pub fn close(&mut self, vertices: &[VertexId]) -> Result<Vec<HalfedgeId>, NoWay> {
        let mut halfedges = Vec::new();
        for (i, &from) in vertices.iter().enumerate() {
            let to = vertices[(i + 1) % vertices.len()];
            let way = self.way(from, to).ok_or(NoWay([from, to]))?;
            way.iter().for_each(|&h| self.taken[self.bare.conn.from(h)] = true);
            halfedges.extend(way);
        }
        Ok(halfedges)
    }

    fn way(&mut self, from: VertexId, to: VertexId) -> Option<Vec<HalfedgeId>> {
        let Closer { bare, searcher, taken } = self;
        if let Some(h) = bare.conn.find(from, to) {
            return Some(vec![h]);
        }
        let [start, goal] = [from, to].map(|v| Terminal::whole(bare, v));
        let path = searcher.shortest(bare, &start, &goal, &OverFree(taken))?;
        let vertex = |&node: &u32| match bare.place(node) {
            Place::Vertex(v) => Some(v),
            Place::Edge(..) => None,
        };
        let vertices: Vec<VertexId> = path.nodes.iter().filter_map(vertex).collect();
        vertices.windows(2).map(|ends| bare.conn.find(ends[0], ends[1])).collect()
    }
}

/// Lets a path pass vertices that are not taken.
struct OverFree<'a>(&'a IdVec<VertexId, bool>);

impl Passage for OverFree<'_> {
    fn vertex(&self, v: VertexId) -> bool {
        !self.0[v]
    }
}
