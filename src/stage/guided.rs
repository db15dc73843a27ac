//! Stage: a layout led by path hypotheses (HYPOTHESIS 3.2).
//!
//! Input: hypotheses of paths, the shortest first. Output: the same arcs on both meshes. An arc is searched near its
//! hypothesis on one mesh and between the same corners near its counterpart on the other. It is put off while it is much
//! longer than the hypothesis on both (a swirl), and left out if it separates other things on the one mesh than on the
//! other. What no hypothesis leads to is completed by arcs that can never get stuck. Invariant: that of a growth.

use super::cluster::BaseVertices;
use super::growth::Growth;
use super::hypothesis::{PathHypothesis, Rough, path_hypotheses};
use super::joint::Grown;
use crate::error::Result;
use crate::mesh::TriMesh;
use crate::path::punishment::Punishment;
use crate::path::region::base_complex;
use crate::path::search::Bounds;

/// An arc longer than its hypothesis by this factor on both meshes swirls (HYPOTHESIS 3.2: k = 1.5); then by the next.
const SWIRL: [f64; 2] = [1.5, 3.0];
/// How far the punishment field reaches, as a share of the hypothesis' length,
const REACH_ALONG: f64 = 0.2;
/// and in mean lengths of an edge.
const REACH_EDGES: f64 = 4.0;

/// What became of a hypothesis.
enum Outcome {
    Laid,
    /// Too long: perhaps it is shorter once others have gone, or it has to be.
    PutOff,
    /// No way, or it separates other things on the one mesh than on the other.
    Refused,
}

/// Lays out both meshes along the hypotheses of a rough map; also returns how often an arc was put off.
pub fn guided(meshes: [&TriMesh; 2], set: &BaseVertices, rough: &Rough, edge_nodes: u32) -> Result<(Grown, usize)> {
    let base = set.vertices.each_ref().map(Vec::as_slice);
    let mut growth = Growth::new(meshes, base, edge_nodes, 0);
    growth.lay_given(&set.given)?;
    let mut wanted = path_hypotheses(meshes, base, rough);
    wanted.retain(|path| !growth.arcs.iter().any(|&[a, b]| path.ends == [a, b] || path.ends == [b, a]));
    let edges = meshes.map(mean_edge);
    let mut put_off = 0;
    for limit in SWIRL {
        let mut left = Vec::new();
        for path in wanted {
            if growth.is_complete() {
                break;
            }
            match try_hypothesis(&mut growth, &path, limit, edges)? {
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
    let bounds = [0, 1].map(|k| &fields[k] as &dyn Bounds);
    let paths = [0, 1].into_iter().find_map(|first| growth.paths_alike(path.ends, first, bounds));
    let Some(paths) = paths else { return Ok(Outcome::Refused) };
    let swirls = (0..2).all(|k| paths[k].true_length(&growth.halves[k].cut) > limit * path.lengths[k]);
    if swirls {
        return Ok(Outcome::PutOff);
    }
    Ok(if growth.lay_if_alike(path.ends, &paths)? { Outcome::Laid } else { Outcome::Refused })
}
