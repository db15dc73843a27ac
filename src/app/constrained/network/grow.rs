//! Paths of a base mesh whose points lie elsewhere on the disc: only their order around each other is given.
//!
//! First a tree of paths joins all points and the rim (Kraevoy, Sheffer, Gotsman: Matchmaker, 2003; Praun, Sweldens,
//! Schroeder: Consistent mesh parameterizations, 2001). What such a tree leaves of a disc is in one piece, so there is a way
//! for every further path of it, into whatever sectors of its ends. Once all points are joined, what is left is a disc whose
//! boundary passes the sectors in the base mesh's order; every other edge is a chord of it. So there is a way for all of
//! them, edges being split where taken vertices leave no other, whatever the places of the points.
//!
//! The tree decides how paths wind around points. It is the shortest one, its longest paths laid first: those of points
//! that lie far from their neighbours run straight then, and the short ones give way. The other way around the long ones
//! run through a maze, and all that they cut off winds around them: a hundred times as many vertices.

use super::super::route::Tolls;
use super::{Network, SPARING, STRAIGHT, edges_of, too_fine};
use crate::error::Result;
use crate::mesh::{LandmarkId, TriMesh, VertexId};
use crate::plane::warp::Triangulation;
use crate::solve::nearest::Nearest;
use std::collections::BinaryHeap;

/// An edge and what its path costs at least: costs only grow as others are laid.
type Edge = Nearest<[u32; 2]>;
/// Edges, the cheapest first.
type Queue = BinaryHeap<Edge>;

/// A path that others laid before have made so many times as dear waits until the cheaper ones are laid: with more it winds
/// around them, and what crosses it winds as well; with less straight long ones wait until they no longer can be.
const DEARER: f64 = 1.2;

impl<'a> Network<'a> {
    /// Lays a path along every edge of the base mesh, whose point `i` is vertex `points[i]` of `mesh`, wherever that lies.
    ///
    /// `rim` is the mesh's boundary in order, from the first of those points on that lie on it; they come last.
    ///
    /// # Errors
    /// Unsolvable once paths have added more than `most` vertices.
    pub fn grow(
        mesh: &'a TriMesh,
        base: &Triangulation,
        points: &[VertexId],
        rim: &[VertexId],
        most: usize,
    ) -> Result<Self> {
        let mut network = Self::framed(mesh, points, rim)?;
        let place = |i: u32| network.cut.positions[network.cut.landmarks[LandmarkId(i)]];
        let inner = edges_of(base).into_iter().filter(|edge| !network.arcs.contains_key(edge));
        let queue: Queue = inner.map(|[a, b]| Nearest(place(a).distance(place(b)), [a, b])).collect();
        let mut chords = network.lay_tree(base, queue)?;
        while !chords.is_empty() {
            network.lay_if_cheapest(base, &mut chords, &SPARING)?;
            (network.added() <= most).then_some(()).ok_or_else(too_fine)?;
        }
        Ok(network)
    }

    /// Lays paths that make one tree of all points and the rim; returns the other edges.
    fn lay_tree(&mut self, base: &Triangulation, mut queue: Queue) -> Result<Queue> {
        let mut tree: Vec<usize> = (0..self.cut.landmarks.len()).collect();
        self.arcs.keys().for_each(|&edge| join(&mut tree, edge));
        let shortest = self.shortest_tree(base, tree.clone(), &mut queue)?;
        for &Nearest(cost, edge) in shortest.iter().rev() {
            let found = self.find(base, edge, &STRAIGHT)?;
            if found.cost <= DEARER * cost {
                self.follow(edge, &found)?;
                join(&mut tree, edge);
            }
        }
        queue.retain(|Nearest(_, edge)| !self.arcs.contains_key(edge));
        let mut chords = Queue::new();
        while let Some(&Nearest(_, [a, b])) = queue.peek() {
            if tree[a as usize] == tree[b as usize] {
                chords.extend(queue.pop());
            } else if let Some(edge) = self.lay_if_cheapest(base, &mut queue, &STRAIGHT)? {
                join(&mut tree, edge);
            }
        }
        Ok(chords)
    }

    /// Lays the path of the first edge in the queue if no other can be cheaper, otherwise puts it back with what it costs now.
    fn lay_if_cheapest(&mut self, base: &Triangulation, queue: &mut Queue, tolls: &Tolls) -> Result<Option<[u32; 2]>> {
        let Some(Nearest(_, edge)) = queue.pop() else { return Ok(None) };
        let found = self.find(base, edge, tolls)?;
        if queue.peek().is_some_and(|rival| rival.0 < found.cost) {
            queue.push(Nearest(found.cost, edge));
            return Ok(None);
        }
        self.follow(edge, &found)?;
        Ok(Some(edge))
    }

    /// The edges, cheapest first, that make one tree of what is joined now, and what their paths cost as things are.
    fn shortest_tree(&self, base: &Triangulation, mut tree: Vec<usize>, queue: &mut Queue) -> Result<Vec<Edge>> {
        let mut found: Vec<Edge> = Vec::new();
        let mut seen: Vec<Edge> = Vec::new();
        while let Some(Nearest(least, edge)) = queue.pop() {
            if tree[edge[0] as usize] == tree[edge[1] as usize] {
                seen.push(Nearest(least, edge));
                continue;
            }
            let cost = self.find(base, edge, &STRAIGHT)?.cost;
            if queue.peek().is_some_and(|rival| rival.0 < cost) {
                queue.push(Nearest(cost, edge));
            } else {
                join(&mut tree, edge);
                found.push(Nearest(cost, edge));
            }
        }
        queue.extend(seen.iter().chain(&found).copied());
        Ok(found)
    }
}

/// Makes one tree of the two that an edge joins.
fn join(tree: &mut [usize], [a, b]: [u32; 2]) {
    let [from, to] = [tree[a as usize], tree[b as usize]];
    tree.iter_mut().filter(|t| **t == from).for_each(|t| *t = to);
}
