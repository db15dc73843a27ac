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
//! run through a maze, and all that they cut off winds around them.

use super::{Network, edges_of};
use crate::error::Result;
use crate::mesh::{LandmarkId, TriMesh, VertexId};
use crate::plane::warp::Triangulation;
use crate::solve::nearest::Nearest;
use std::collections::BinaryHeap;

/// Edges by what their paths cost at least: costs only grow as others are laid.
type Queue = BinaryHeap<Nearest<[u32; 2]>>;

/// Paths of the tree that cost at least this share of the longest one are laid together, before the tree is found anew: with
/// a smaller share trees are found fewer times, of paths that block each other more.
const TOGETHER: f64 = 0.7;
/// A path that others have made so many times as dear since the tree was found waits for the next tree.
const DEARER: f64 = 1.2;

impl<'a> Network<'a> {
    /// Lays a path along every edge of the base mesh, whose point `i` is vertex `points[i]` of `mesh`, wherever that lies.
    ///
    /// `rim` is the mesh's boundary in order, from the first of those points on that lie on it; they come last.
    pub fn grow(mesh: &'a TriMesh, base: &Triangulation, points: &[VertexId], rim: &[VertexId]) -> Result<Self> {
        let mut network = Self::framed(mesh, points, rim)?;
        let mut tree: Vec<usize> = (0..points.len()).collect();
        network.arcs.keys().for_each(|&edge| join(&mut tree, edge));
        let place = |i: u32| network.cut.positions[network.cut.landmarks[LandmarkId(i)]];
        let inner = edges_of(base).into_iter().filter(|edge| !network.arcs.contains_key(edge));
        let mut queue: Queue = inner.map(|[a, b]| Nearest(place(a).distance(place(b)), [a, b])).collect();
        let shortest = network.shortest_tree(base, tree.clone(), &mut queue)?;
        for &Nearest(cost, edge) in shortest.iter().rev() {
            let found = network.find(base, edge)?;
            if found.cost <= DEARER * cost {
                network.follow(edge, &found)?;
                join(&mut tree, edge);
            }
        }
        queue.retain(|Nearest(_, [a, b])| !network.arcs.contains_key(&[*a, *b]));
        let mut chords = Queue::new();
        while let Some(next) = queue.pop() {
            let [a, b] = next.1;
            if tree[a as usize] == tree[b as usize] {
                chords.push(next);
            } else if network.lay_if_cheapest(base, next, &mut queue)? {
                join(&mut tree, [a, b]);
            }
        }
        eprintln!("dbg tree added {}", network.added());
        while let Some(next) = chords.pop() {
            network.lay_if_cheapest(base, next, &mut chords)?;
        }
        Ok(network)
    }

    /// Lays a path if none in the queue can be cheaper, otherwise puts it back with what it costs now.
    fn lay_if_cheapest(&mut self, base: &Triangulation, Nearest(_, edge): Nearest<[u32; 2]>, queue: &mut Queue) -> Result<bool> {
        let found = self.find(base, edge)?;
        if queue.peek().is_some_and(|rival| rival.0 < found.cost) {
            queue.push(Nearest(found.cost, edge));
            return Ok(false);
        }
        if found.cost>10.0 {eprintln!("dbg {edge:?} cost {:.3} added {}", found.cost, self.added());}
        self.follow(edge, &found)?;
        Ok(true)
    }

    /// The edges, cheapest first, that make one tree of what is joined now, and what their paths cost as things are.
    fn shortest_tree(&self, base: &Triangulation, mut tree: Vec<usize>, queue: &mut Queue) -> Result<Vec<Nearest<[u32; 2]>>> {
        let (mut found, mut seen): (Vec<Nearest<[u32; 2]>>, Vec<Nearest<[u32; 2]>>) = (Vec::new(), Vec::new());
        while let Some(Nearest(least, edge)) = queue.pop() {
            if tree[edge[0] as usize] == tree[edge[1] as usize] {
                seen.push(Nearest(least, edge));
                continue;
            }
            let cost = self.find(base, edge)?.cost;
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
