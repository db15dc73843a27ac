//! Stage: a layout led by path hypotheses (HYPOTHESIS 3.2).
//!
//! Input: hypotheses of paths, the shortest first. Output: the same arcs on both meshes. An arc is searched near its
//! hypothesis on one mesh and between the same corners near its counterpart on the other; where there is no way near it,
//! between the corners that are best on either mesh, as long as that is no detour. It is put off while it is much longer
//! than the hypothesis on both (a swirl), and left out if it separates other things on the one mesh than on the other. What
//! no hypothesis leads to is completed by arcs that can never get stuck. Invariant: that of a growth.

use super::cluster::BaseVertices;
use super::growth::Growth;
use super::hypothesis::PathHypothesis;
use super::joint::Grown;
use super::order::{outwardness, tree_first};
use crate::error::Result;
use crate::mesh::TriMesh;
use crate::path::punishment::Punishment;
use crate::path::region::base_complex;
use crate::path::search::{Anywhere, Bounds, Path};

/// An arc longer than its hypothesis by this factor on both meshes swirls (HYPOTHESIS 3.2: k = 1.5); then by the next.
const SWIRL: [f64; 2] = [1.5, 3.0];
/// How far the punishment field reaches, as a share of the hypothesis' length,
const REACH_ALONG: f64 = 0.2;
/// and in mean lengths of an edge.
const REACH_EDGES: f64 = 4.0;

/// Which hypotheses come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lead {
    /// The shortest (HYPOTHESIS 3.2).
    Shortest,
    /// A spanning tree of the shortest, the arcs of the outermost base vertices leading. A base vertex far out, which the
    /// shortest come to last, is so not passed on different sides on the two meshes before it has an arc of its own.
    OuterTree,
}

/// What became of a hypothesis.
enum Outcome {
    Laid,
    /// Too long: perhaps it is shorter once others have gone, or it has to be.
    PutOff,
    /// No way, or it separates other things on the one mesh than on the other.
    Refused,
}

/// Lays out both meshes along hypotheses of paths; also returns how often an arc was put off.
pub fn guided(
    meshes: [&TriMesh; 2],
    set: &BaseVertices,
    hypotheses: &[PathHypothesis],
    lead: Lead,
    edge_nodes: u32,
) -> Result<(Grown, usize)> {
    let base = set.vertices.each_ref().map(Vec::as_slice);
    let mut growth = Growth::new(meshes, base, edge_nodes, 0);
    growth.lay_given(&set.given)?;
    let mut wanted = arrange(hypotheses, lead, growth.halves.each_ref().map(|half| half.unit), base[0].len());
    wanted.retain(|path| !growth.arcs.iter().any(|&[a, b]| path.ends == [a, b] || path.ends == [b, a]));
    let edges = meshes.map(mean_edge);
    let mut put_off = 0;
    for limit in SWIRL {
        let mut left = Vec::new();
        for path in wanted {
            if growth.is_complete() {
                break;
            }
            match try_hypothesis(&mut growth, path, limit, edges)? {
                Outcome::PutOff => left.push(path),
                Outcome::Laid | Outcome::Refused => {}
            }
        }
        put_off += left.len();
        wanted = left;
    }
    growth.complete()?;
    let Growth { halves: [source, target], arcs, .. } = growth;
    let base = base_complex(&source.cut, &arcs)?;
    Ok((Grown { base, cuts: [source.cut, target.cut] }, put_off))
}

/// Sorts the hypotheses of paths between so many base vertices; they come with the shortest first.
fn arrange(hypotheses: &[PathHypothesis], lead: Lead, units: [f64; 2], count: usize) -> Vec<&PathHypothesis> {
    let mut sorted: Vec<&PathHypothesis> = hypotheses.iter().collect();
    if lead == Lead::OuterTree {
        let length = |path: &PathHypothesis| (0..2).map(|k| path.lengths[k] / units[k]).sum();
        let outward = outwardness(count, hypotheses.iter().map(|path| (path.ends, length(path))));
        tree_first(&mut sorted, |path| path.ends, &outward);
    }
    sorted
}

fn mean_edge(mesh: &TriMesh) -> f64 {
    let edges = mesh.conn.halfedges().filter(|&h| mesh.conn.is_edge_representative(h));
    let length = |h| mesh.positions[mesh.conn.from(h)].distance(mesh.positions[mesh.conn.to(h)]);
    let (sum, count) = edges.map(length).fold((0.0, 0), |(sum, count), l: f64| (sum + l, count + 1));
    sum / f64::from(count.max(1))
}

fn try_hypothesis(growth: &mut Growth, path: &PathHypothesis, limit: f64, edges: [f64; 2]) -> Result<Outcome> {
    let fields = [0, 1].map(|k| {
        let reach = REACH_ALONG * path.lengths[k] + REACH_EDGES * edges[k];
        Punishment::around(growth.halves[k].mesh, &path.vertices[k], reach)
    });
    let near = [0, 1].map(|k| &fields[k] as &dyn Bounds);
    let mut outcome = Outcome::Refused;
    for first in 0..2 {
        let Some(paths) = growth.paths_alike(path.ends, first, near) else { continue };
        let lengths = lengths(growth, &paths);
        if (0..2).all(|k| lengths[k] > limit * path.lengths[k]) {
            outcome = Outcome::PutOff;
        } else if growth.lay_if_alike(path.ends, &paths)? {
            return Ok(Outcome::Laid);
        }
    }
    match outcome {
        Outcome::Refused => try_anywhere(growth, path, limit),
        _ => Ok(outcome),
    }
}

/// Lays an arc where that is no detour on either mesh, near the hypothesis or not: the arcs that are there may have left
/// its ends no way near it in the same corners of both meshes (`CyclicalOrderAdjust` in HYPOTHESIS 3.2).
fn try_anywhere(growth: &mut Growth, path: &PathHypothesis, limit: f64) -> Result<Outcome> {
    let anywhere = [&Anywhere as &dyn Bounds; 2];
    let units = growth.halves.each_ref().map(|half| half.unit);
    let mut ways = Vec::with_capacity(2);
    for first in 0..2 {
        if let Some(paths) = growth.paths_alike(path.ends, first, anywhere) {
            let lengths = lengths(growth, &paths);
            let is_detour = (0..2).any(|k| lengths[k] > limit * path.lengths[k]);
            ways.push((is_detour, lengths[0] / units[0] + lengths[1] / units[1], first));
        }
    }
    ways.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut outcome = Outcome::Refused;
    for (is_detour, _, first) in ways {
        if is_detour {
            outcome = Outcome::PutOff;
        } else if let Some(paths) = growth.paths_alike(path.ends, first, anywhere)
            && growth.lay_if_alike(path.ends, &paths)?
        {
            return Ok(Outcome::Laid);
        }
    }
    Ok(outcome)
}

fn lengths(growth: &Growth, paths: &[Path; 2]) -> [f64; 2] {
    [0, 1].map(|k| paths[k].true_length(&growth.halves[k].cut))
}
