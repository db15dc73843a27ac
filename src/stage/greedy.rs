//! Stage: the greedy layout of Kraevoy and Sheffer, as VORONOI and HYPOTHESIS describe it; the baseline.
//!
//! Input: base vertices. Output: the same arcs on both meshes, or the pair of landmarks at which it got stuck. All pairs
//! are joined by shortest paths along edges, the pair with the least total length leading. A path is taken if it meets
//! the landmarks between the same arcs on both meshes and separates the same on both; one that earlier arcs have made
//! longer is searched again and waits its turn. When edges leave no way the same is done across faces. No mesh is
//! refined to make way, so some layouts cannot be finished.
//!
//! V. Kraevoy, A. Sheffer, "Cross-parameterization and compatible remeshing of 3D models", 2004.

use super::cluster::BaseVertices;
use super::growth::{Growth, corners_of};
use super::joint::Grown;
use super::trace::{diagonals, joins, parts};
use crate::error::Result;
use crate::mesh::{HalfedgeId, LandmarkId, TriMesh};
use crate::path::network::{Corner, terminal};
use crate::path::region::{Regions, base_complex};
use crate::path::search::{Anywhere, Passage, Path, Terminal};
use crate::solve::nearest::Nearest;
use std::collections::BinaryHeap;

/// A path that is longer than before by less than this share has not changed.
const SAME: f64 = 1e-9;

/// Keeps a path on edges.
struct AlongEdges;

impl Passage for AlongEdges {
    fn edge(&self, _: HalfedgeId) -> bool {
        false
    }
}

/// How the greedy layout ended.
pub enum Greedy<T> {
    /// Every region is a triangle.
    Complete(T),
    /// An arc is missing between two base vertices, and no path that is left can be placed.
    Stuck([LandmarkId; 2]),
}

/// Lays out both meshes, as far as it goes.
pub fn greedy(meshes: [&TriMesh; 2], set: &BaseVertices, edge_nodes: u32) -> Result<Greedy<Grown>> {
    let base = set.vertices.each_ref().map(Vec::as_slice);
    let mut growth = Growth::new(meshes, base, edge_nodes, 0);
    growth.lay_given(&set.given)?;
    for passage in [&AlongEdges as &dyn Passage, &Anywhere] {
        add_paths(&mut growth, passage)?;
    }
    if let Some(pair) = missing(&growth) {
        return Ok(Greedy::Stuck(pair));
    }
    let Growth { halves: [source, target], arcs, .. } = growth;
    let base = base_complex(&source.cut, &arcs)?;
    Ok(Greedy::Complete(Grown { base, cuts: [source.cut, target.cut] }))
}

/// Adds all paths that agree, the shortest first.
fn add_paths(growth: &mut Growth, passage: &dyn Passage) -> Result<()> {
    let count = growth.halves[0].cut.landmarks.len() as u32;
    let mut queue = BinaryHeap::new();
    for pair in (0..count).flat_map(|a| (a + 1..count).map(move |b| [LandmarkId(a), LandmarkId(b)])) {
        let is_joined = growth.arcs.iter().any(|&[a, b]| pair == [a, b] || pair == [b, a]);
        if let Some((length, _)) = (!is_joined).then(|| both_paths(growth, pair, passage)).flatten() {
            queue.push(Nearest(length, pair));
        }
    }
    while let Some(Nearest(length, pair)) = queue.pop() {
        let Some((now, paths)) = both_paths(growth, pair, passage) else { continue };
        if now > length * (1.0 + SAME) {
            queue.push(Nearest(now, pair));
        } else {
            growth.lay_if_alike(pair, &paths)?;
        }
    }
    Ok(())
}

/// Paths between the same corners on both meshes, and their length together: the corners are those of the shortest path
/// of one of them.
fn both_paths(growth: &mut Growth, ends: [LandmarkId; 2], passage: &dyn Passage) -> Option<(f64, [Path; 2])> {
    let mut best: Option<(f64, [Path; 2])> = None;
    for first in 0..2 {
        let half = &mut growth.halves[first];
        let whole = ends.map(|l| Terminal::whole(&half.cut, half.cut.landmarks[l]));
        let one = half.searcher.shortest(&half.cut, &whole[0], &whole[1], passage)?;
        let corners: [Corner; 2] = corners_of(&half.cut, &one)?;
        let unit = half.unit;
        let half = &mut growth.halves[1 - first];
        let [start, goal] = corners.map(|c| terminal(&half.cut, c, &|_| true).ok());
        let (Some(start), Some(goal)) = (start, goal) else { continue };
        let Some(other) = half.searcher.shortest(&half.cut, &start, &goal, passage) else { continue };
        let length = one.length / unit + other.length / half.unit;
        if best.as_ref().is_none_or(|(least, _)| length < *least) {
            best = Some((length, if first == 0 { [one, other] } else { [other, one] }));
        }
    }
    best
}

/// Two landmarks between which an arc is missing; none if the layout is complete.
fn missing(growth: &Growth) -> Option<[LandmarkId; 2]> {
    let regions = Regions::find(&growth.halves[0].cut);
    for (r, walks) in regions.walks.iter().enumerate() {
        let parts = parts(&growth.arcs, walks, &regions.isolated[r]);
        let candidates = match parts.as_slice() {
            [walk] if regions.genus[r] == 0 && walk.len() == 3 => continue,
            [walk] => diagonals(walk),
            _ => joins(&parts),
        };
        let corner = |c: Corner| c.landmark;
        let alone = || parts.first().and_then(|walk| walk.first()).map(|c| [c.landmark; 2]);
        return candidates.first().map(|ends| ends.map(corner)).or_else(alone);
    }
    None
}
