//! Shortest paths along the edges of a mesh.

use crate::mesh::{IdVec, TriMesh, VertexId};
use crate::solve::nearest::Nearest;
use std::collections::BinaryHeap;

/// The shortest edge paths from some vertices to all others.
#[derive(Clone, Debug)]
pub struct EdgeTree {
    /// Length of the path to every vertex; infinite where none leads.
    pub length: IdVec<VertexId, f64>,
    /// The vertex before it on its path.
    parent: IdVec<VertexId, Option<VertexId>>,
}

impl EdgeTree {
    /// Grows paths from `starts`, no longer than `limit`; `step` is the length of the edge between two vertices.
    pub fn grow(mesh: &TriMesh, starts: &[VertexId], limit: f64, step: impl Fn(VertexId, VertexId) -> f64) -> Self {
        let count = mesh.positions.len();
        let mut tree = EdgeTree { length: IdVec::filled(f64::INFINITY, count), parent: IdVec::filled(None, count) };
        let mut queue = BinaryHeap::new();
        for &v in starts {
            tree.length[v] = 0.0;
            queue.push(Nearest(0.0, v));
        }
        while let Some(Nearest(length, v)) = queue.pop() {
            if length > tree.length[v] {
                continue;
            }
            for h in mesh.conn.outgoing(v) {
                for w in [mesh.conn.to(h), mesh.conn.from(crate::mesh::prev(h))] {
                    let through = length + step(v, w);
                    if through < tree.length[w] && through <= limit {
                        tree.length[w] = through;
                        tree.parent[w] = Some(v);
                        queue.push(Nearest(through, w));
                    }
                }
            }
        }
        tree
    }

    /// The vertices of the path to `v`, from its start.
    pub fn path_to(&self, v: VertexId) -> Vec<VertexId> {
        let mut path: Vec<VertexId> = std::iter::successors(Some(v), |&w| self.parent[w]).collect();
        path.reverse();
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Id;
    use crate::shape::fixture::icosphere;

    #[test]
    fn paths_are_as_long_as_told_and_no_edge_shortens_them() {
        let mesh = icosphere(3);
        let step = |v: VertexId, w: VertexId| mesh.positions[v].distance(mesh.positions[w]);
        let tree = EdgeTree::grow(&mesh, &[VertexId(0)], f64::INFINITY, step);
        for h in mesh.conn.halfedges() {
            let [a, b] = [mesh.conn.from(h), mesh.conn.to(h)];
            assert!(tree.length[b] <= tree.length[a] + step(a, b) + 1e-12);
        }
        for v in mesh.conn.vertices() {
            let path = tree.path_to(v);
            let length: f64 = path.windows(2).map(|w| step(w[0], w[1])).sum();
            assert!(path[0] == VertexId(0) && (length - tree.length[v]).abs() < 1e-12, "{}", v.index());
        }
        let near = EdgeTree::grow(&mesh, &[VertexId(0)], 0.5, step);
        assert!(mesh.conn.vertices().all(|v| near.length[v].is_finite() == (tree.length[v] <= 0.5)));
    }
}
