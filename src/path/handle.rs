//! Arcs that open a handle: shortest paths that do not separate their region.

use super::curve::closed_curves;
use super::cut_mesh::{CutMesh, Place};
use super::network::{Corner, embed, open_up, terminal};
use super::search::{Path, Searcher, Terminal};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, LandmarkId, TriMesh, VertexId, face_of};
use std::collections::HashSet;

/// Pieces in which an arc is laid before that is called endless; an arc to a handle and back takes two or three.
const MOST_PIECES: usize = 32;

/// An arc as it was laid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laid {
    /// Where it starts and ends.
    pub ends: [LandmarkId; 2],
    /// Its length in mesh units.
    pub length: f64,
}

/// Lays `arc` along the shortest path from one of `starts` to one of `goals` that leaves their region in one piece.
///
/// All corners must be on one boundary walk of a region with a handle, or at one landmark inside. A path to a far handle
/// and back would use the same way twice: the arc is laid up to where it would meet itself, and goes on from there
/// beside its first piece.
///
/// # Errors
/// Bug, if there is no such path; nothing is laid then.
pub fn lay_across_handle(
    cut: &mut CutMesh,
    mesh: &TriMesh,
    searcher: &mut Searcher,
    [starts, goals]: [&[Corner]; 2],
    arc: ArcId,
) -> Result<Laid> {
    let mut laying = Laying { cut, mesh, searcher, arc, goals, first: None, length: 0.0 };
    let last = laying.lay(starts);
    match (last, laying.first) {
        (Ok(last), Some(first)) => Ok(Laid { ends: [first, last], length: laying.length }),
        (last, first) => {
            if let Some(first) = first {
                cut.unmark(arc, first);
            }
            Err(last.err().unwrap_or_else(|| Error::bug("an arc without a beginning").at(arc)))
        }
    }
}

struct Laying<'a> {
    cut: &'a mut CutMesh,
    mesh: &'a TriMesh,
    searcher: &'a mut Searcher,
    arc: ArcId,
    goals: &'a [Corner],
    first: Option<LandmarkId>,
    length: f64,
}

impl Laying<'_> {
    /// Lays the arc piece by piece; returns the landmark where it ends.
    fn lay(&mut self, starts: &[Corner]) -> Result<LandmarkId> {
        for _ in 0..MOST_PIECES {
            let path = self.path(starts)?;
            let (piece, whole) = first_piece(self.cut, &path);
            if self.first.is_none() {
                self.first = landmark_at(self.cut, path.nodes[0]);
            }
            self.length += piece.length;
            embed(self.cut, self.mesh, &piece, self.arc)?;
            if whole {
                let last = path.nodes.last().and_then(|&node| landmark_at(self.cut, node));
                return last.ok_or_else(|| self.bug());
            }
        }
        Err(self.bug())
    }

    fn bug(&self) -> Error {
        Error::bug("no arc opens the handle of a region").at(self.arc)
    }

    /// The shortest way on that opens a handle; the region is refined if its nodes leave none.
    fn path(&mut self, starts: &[Corner]) -> Result<Path> {
        for _ in 0..2 {
            let starts = match self.tip() {
                Some(tip) => vec![Terminal::whole(self.cut, tip)],
                None => self.terminals(starts)?,
            };
            let goals = self.terminals(self.goals)?;
            let seed = starts.first().and_then(|t| t.sector.first()).map(|&h| face_of(h)).ok_or_else(|| self.bug())?;
            if let Some(path) = self.shortest(seed, &starts, &goals) {
                return Ok(path);
            }
            open_up(self.cut, self.mesh, seed);
        }
        Err(self.bug())
    }

    fn shortest(&mut self, seed: FaceId, starts: &[Terminal], goals: &[Terminal]) -> Option<Path> {
        let mut best: Option<Path> = None;
        for curve in closed_curves(self.cut, seed) {
            let limit = best.as_ref().map_or(f64::INFINITY, |path| path.length);
            best = self.searcher.shortest_across(self.cut, starts, goals, &curve, limit).or(best);
        }
        best
    }

    /// Where the part of the arc ends that has been laid so far.
    fn tip(&self) -> Option<VertexId> {
        let laid = self.cut.arc_path(self.arc, self.first?);
        laid.last().map(|&h| self.cut.conn.to(h))
    }

    fn terminals(&self, corners: &[Corner]) -> Result<Vec<Terminal>> {
        corners.iter().map(|&c| terminal(self.cut, c, &|a| a != self.arc)).collect()
    }
}

fn landmark_at(cut: &CutMesh, node: u32) -> Option<LandmarkId> {
    match cut.place(node) {
        Place::Vertex(v) => cut.landmark_at[v],
        Place::Edge(..) => None,
    }
}

/// The part of a path before it comes back to a node or face, and whether that is all of it.
fn first_piece(cut: &CutMesh, path: &Path) -> (Path, bool) {
    let mut nodes = HashSet::new();
    let mut faces = HashSet::new();
    let mut steps = 0;
    while steps < path.faces.len() && nodes.insert(path.nodes[steps]) && faces.insert(path.faces[steps]) {
        steps += 1;
    }
    if steps == path.faces.len() {
        return (path.clone(), true);
    }
    // A node that was met before is on the first piece already: stop short of it.
    let met_node = path.nodes[..steps].contains(&path.nodes[steps]);
    let steps = if met_node { steps - 1 } else { steps };
    let nodes = path.nodes[..=steps].to_vec();
    let length = nodes.windows(2).map(|w| cut.node_position(w[0]).distance(cut.node_position(w[1]))).sum();
    (Path { nodes, faces: path.faces[..steps].to_vec(), length }, false)
}
