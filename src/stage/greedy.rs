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
use super::growth::Growth;
use super::joint::Grown;
use super::path_flip::flip_paths;
use super::trace::{diagonals, joins, parts};
use crate::error::Result;
use crate::mesh::{HalfedgeId, LandmarkId, TriMesh};
use crate::path::cut_mesh::CutMesh;
use crate::path::network::Corner;
use crate::path::region::{Regions, base_complex};
use crate::path::search::{Anywhere, Bounds, Passage, Path};
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

impl Bounds for AlongEdges {
    fn on<'a>(&'a self, _: &'a CutMesh) -> Box<dyn Passage + 'a> {
        Box::new(AlongEdges)
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
    for bounds in [&AlongEdges as &dyn Bounds, &Anywhere] {
        add_paths(&mut growth, bounds)?;
    }
    if let Some(pair) = missing(&growth) {
        return Ok(Greedy::Stuck(pair));
    }
    flip_paths(&mut growth)?;
    let Growth { halves: [source, target], arcs, .. } = growth;
    let base = base_complex(&source.cut, &arcs)?;
    Ok(Greedy::Complete(Grown { base, cuts: [source.cut, target.cut] }))
}

/// Adds all paths that agree, the shortest first.
fn add_paths(growth: &mut Growth, bounds: &dyn Bounds) -> Result<()> {
    let count = growth.halves[0].cut.landmarks.len() as u32;
    let mut queue = BinaryHeap::new();
    for pair in (0..count).flat_map(|a| (a + 1..count).map(move |b| [LandmarkId(a), LandmarkId(b)])) {
        let is_joined = growth.arcs.iter().any(|&[a, b]| pair == [a, b] || pair == [b, a]);
        if let Some((length, _)) = (!is_joined).then(|| both_paths(growth, pair, bounds)).flatten() {
            queue.push(Nearest(length, pair));
        }
    }
    while let Some(Nearest(length, pair)) = queue.pop() {
        let Some((now, paths)) = both_paths(growth, pair, bounds) else { continue };
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
fn both_paths(growth: &mut Growth, ends: [LandmarkId; 2], bounds: &dyn Bounds) -> Option<(f64, [Path; 2])> {
    let units = growth.halves.each_ref().map(|half| half.unit);
    let measured = |first: usize| {
        let paths = growth.paths_alike(ends, first, [bounds; 2])?;
        Some((paths[0].length / units[0] + paths[1].length / units[1], paths))
    };
    (0..2).filter_map(measured).min_by(|a, b| a.0.total_cmp(&b.0))
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
