//! Triangles glued side to side, where a triangle may meet another, or itself, along several sides.
//!
//! This is a generalised triangulation (a Delta-complex): edges are told apart by number, not by their ends. Half-edge
//! `3 f + i` leaves corner `i` of face `f`, as in [`crate::mesh::Connectivity`], which needs distinct ends.

use crate::error::{Error, Result};
use glam::{DVec2, DVec3};

/// Marks a missing twin, vertex or slot.
pub(super) const NONE: usize = usize::MAX;

/// Rounds of splitting before they are called endless. Splitting every edge and face twice makes any triangulation
/// simplicial; a round that splits only edges needs a few more.
const MAX_ROUNDS: usize = 16;

/// A corner of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Its vertex.
    pub(super) vertex: usize,
    /// Its texture coordinates.
    pub(super) uv: usize,
}

/// Glued triangles with vertex positions and texture coordinates.
#[derive(Default)]
pub(super) struct Glued {
    /// Vertex positions.
    pub(super) positions: Vec<DVec3>,
    /// Texture coordinates.
    pub(super) uv: Vec<DVec2>,
    /// The corner each half-edge leaves.
    start: Vec<Node>,
    /// The other half of each edge; [`NONE`] on the boundary.
    twin: Vec<usize>,
}

fn next(h: usize) -> usize {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

fn prev(h: usize) -> usize {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl Glued {
    /// Number of faces.
    pub(super) fn face_count(&self) -> usize {
        self.start.len() / 3
    }

    /// The corners of all faces.
    pub(super) fn faces(&self) -> impl Iterator<Item = [Node; 3]> {
        (0..self.face_count()).map(|f| [self.start[3 * f], self.start[3 * f + 1], self.start[3 * f + 2]])
    }

    /// Adds a face that is not glued to anything and returns its number.
    pub(super) fn add_face(&mut self, corners: [Node; 3]) -> usize {
        self.start.extend(corners);
        self.twin.extend([NONE; 3]);
        self.face_count() - 1
    }

    /// Glues two half-edges together.
    pub(super) fn join(&mut self, h: usize, k: usize) {
        self.twin[h] = k;
        self.twin[k] = h;
    }

    /// Splits edges at their midpoints until no edge has equal ends and no two edges have both ends in common.
    ///
    /// # Errors
    /// Bug, if that does not end; it does for every surface.
    pub(super) fn separate_edges(&mut self) -> Result<()> {
        for _ in 0..MAX_ROUNDS {
            let edges = self.indistinct_edges();
            if edges.is_empty() {
                return Ok(());
            }
            for edge in edges {
                // A split beside it may have moved the edge to another number: then it waits for the next round.
                if self.edge(edge.2) == edge {
                    self.split(edge.2);
                }
            }
        }
        Err(Error::bug("a rebuilt mesh keeps edges with common ends"))
    }

    /// The ends of the edge of `h`, the lower first, and `h`.
    fn edge(&self, h: usize) -> (usize, usize, usize) {
        let (a, b) = (self.start[h].vertex, self.start[next(h)].vertex);
        (a.min(b), a.max(b), h)
    }

    /// The edges to split next: those with equal ends if there are any, otherwise all but one of every set with common
    /// ends.
    ///
    /// Edges with equal ends go first: a face glued to itself has one, and once it is split the face is two.
    fn indistinct_edges(&self) -> Vec<(usize, usize, usize)> {
        let one_half = |&h: &usize| self.twin[h] == NONE || h < self.twin[h];
        let mut edges: Vec<_> = (0..self.start.len()).filter(one_half).map(|h| self.edge(h)).collect();
        edges.sort_unstable();
        let loops: Vec<_> = edges.iter().filter(|&&(a, b, _)| a == b).copied().collect();
        if !loops.is_empty() {
            return loops;
        }
        let pairs = edges.windows(2).filter(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1));
        pairs.map(|pair| pair[1]).collect()
    }

    /// Splits the edge of `h` at its midpoint, and the faces at it, which must differ; `h` keeps its start.
    fn split(&mut self, h: usize) {
        let ends = [self.start[h], self.start[next(h)]];
        let vertex = self.positions.len();
        self.positions.push(ends.map(|end| self.positions[end.vertex]).iter().sum::<DVec3>() * 0.5);
        let uv = self.middle(ends);
        let twin = self.twin[h];
        let rest = self.split_side(h, Node { vertex, uv });
        if twin != NONE {
            let twin_ends = [self.start[next(twin)], self.start[twin]];
            let same = ends.iter().zip(&twin_ends).all(|(a, b)| a.uv == b.uv);
            let uv = if same { uv } else { self.middle(twin_ends) };
            let twin_rest = self.split_side(twin, Node { vertex, uv });
            self.join(h, twin_rest);
            self.join(twin, rest);
        }
    }

    /// New texture coordinates halfway between two corners of a face.
    fn middle(&mut self, ends: [Node; 2]) -> usize {
        self.uv.push(ends.map(|end| self.uv[end.uv]).iter().sum::<DVec2>() * 0.5);
        self.uv.len() - 1
    }

    /// Face (a, b, c) with `h` = a b becomes (a, m, c), and a new face is (m, b, c); returns the half-edge m b.
    fn split_side(&mut self, h: usize, m: Node) -> usize {
        let bc = next(h);
        let rest = 3 * self.add_face([m, self.start[bc], self.start[prev(h)]]);
        self.start[bc] = m;
        if self.twin[bc] != NONE {
            self.join(next(rest), self.twin[bc]);
        }
        self.join(bc, prev(rest));
        rest
    }
}
