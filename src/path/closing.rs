//! Loops of edges through given vertices.

use crate::mesh::{HalfedgeId, IdVec, TriMesh, VertexId};
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

/// Two vertices between which there is no free way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoWay(pub [VertexId; 2]);

/// The loop of half-edges through `vertices` in order: along the edge between neighbours, else the shortest way along
/// edges over vertices that are not `taken`. Vertices that the loop comes through are taken afterwards.
pub fn close_loop(
    mesh: &TriMesh,
    vertices: &[VertexId],
    taken: &mut IdVec<VertexId, bool>,
) -> Result<Vec<HalfedgeId>, NoWay> {
    let mut halfedges = Vec::new();
    for (i, &from) in vertices.iter().enumerate() {
        let to = vertices[(i + 1) % vertices.len()];
        let way = match mesh.conn.find(from, to) {
            Some(h) => vec![h],
            None => shortest_way(mesh, from, to, taken).ok_or(NoWay([from, to]))?,
        };
        way.iter().skip(1).for_each(|&h| taken[mesh.conn.from(h)] = true);
        halfedges.extend(way);
    }
    Ok(halfedges)
}

/// An entry of the queue; the shortest estimate comes first, ties go to the lower vertex.
#[derive(PartialEq)]
struct Open {
    estimate: f64,
    length: f64,
    vertex: VertexId,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.estimate.total_cmp(&self.estimate).then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The shortest way along edges from one vertex to another, over vertices that are not taken.
fn shortest_way(
    mesh: &TriMesh,
    from: VertexId,
    to: VertexId,
    taken: &IdVec<VertexId, bool>,
) -> Option<Vec<HalfedgeId>> {
    let goal = mesh.positions[to];
    let mut reached: HashMap<VertexId, (f64, Option<HalfedgeId>)> = HashMap::from([(from, (0.0, None))]);
    let mut queue = BinaryHeap::from([Open { estimate: 0.0, length: 0.0, vertex: from }]);
    while let Some(Open { length, vertex, .. }) = queue.pop() {
        if vertex == to {
            return Some(way_back(mesh, &reached, to));
        }
        if length > reached[&vertex].0 {
            continue;
        }
        for h in mesh.conn.outgoing(vertex) {
            let next = mesh.conn.to(h);
            let there = length + mesh.positions[vertex].distance(mesh.positions[next]);
            let is_shorter = reached.get(&next).is_none_or(|&(known, _)| there < known);
            if is_shorter && (next == to || !taken[next]) {
                reached.insert(next, (there, Some(h)));
                queue.push(Open { estimate: there + mesh.positions[next].distance(goal), length: there, vertex: next });
            }
        }
    }
    None
}

fn way_back(mesh: &TriMesh, reached: &HashMap<VertexId, (f64, Option<HalfedgeId>)>, to: VertexId) -> Vec<HalfedgeId> {
    let step = |h: &HalfedgeId| reached[&mesh.conn.from(*h)].1;
    let mut way: Vec<HalfedgeId> = std::iter::successors(reached[&to].1, step).collect();
    way.reverse();
    way
}
