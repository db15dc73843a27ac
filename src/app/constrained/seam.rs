//! The seam along which a closed mesh is cut open.

use crate::error::{Error, Result};
use crate::mesh::{TriMesh, VertexId};
use crate::solve::nearest::Nearest;
use std::collections::{BinaryHeap, HashSet};

/// Vertices from one end of a seam to the other, neighbours joined by edges; empty without a seam.
pub type Seam = Vec<VertexId>;

/// A seam needs this many vertices: those between its ends are doubled, and there must be one.
const LEAST: usize = 3;

/// A way from the vertex farthest from all features to the one that is farthest from both, away from the features.
///
/// # Errors
/// Input if the features leave no way.
pub fn find_seam(mesh: &TriMesh, features: &[VertexId]) -> Result<Seam> {
    let none =
        || Error::input("the mesh is closed and its features leave no room for a seam").remedy("name one with --seam");
    let first = mesh.conn.vertices().find(|&v| mesh.conn.leaving(v).is_some()).ok_or_else(none)?;
    let from = if features.is_empty() { vec![first] } else { features.to_vec() };
    let (away, _) = distances(mesh, &from, |_| 1.0);
    let farthest = |distance: &dyn Fn(usize) -> f64| {
        let all = mesh.conn.vertices().filter(|v| mesh.conn.leaving(*v).is_some() && !features.contains(v));
        all.max_by(|a, b| distance(a.0 as usize).total_cmp(&distance(b.0 as usize)).then(b.cmp(a)))
    };
    let start = farthest(&|v| away[v]).ok_or_else(none)?;
    let (beyond, _) = distances(mesh, &[start], |_| 1.0);
    let end = farthest(&|v| away[v].min(beyond[v])).ok_or_else(none)?;
    let greatest = away[start.0 as usize].max(f64::MIN_POSITIVE);
    let dear = |v: VertexId| if features.contains(&v) { f64::INFINITY } else { greatest / away[v.0 as usize] };
    let (_, before) = distances(mesh, &[start], dear);
    let mut seam = vec![end];
    while let Some(v) = before[seam[seam.len() - 1].0 as usize] {
        seam.push(v);
    }
    seam.reverse();
    if seam[0] == start && seam.len() >= LEAST { Ok(seam) } else { Err(none()) }
}

/// Distances along edges from the sources, each edge counted `dear` times for where it leads, and the vertex before.
fn distances(
    mesh: &TriMesh,
    sources: &[VertexId],
    dear: impl Fn(VertexId) -> f64,
) -> (Vec<f64>, Vec<Option<VertexId>>) {
    let n = mesh.positions.len();
    let (mut distance, mut before) = (vec![f64::INFINITY; n], vec![None; n]);
    let mut queue: BinaryHeap<Nearest<VertexId>> = sources.iter().map(|&v| Nearest(0.0, v)).collect();
    sources.iter().for_each(|v| distance[v.0 as usize] = 0.0);
    while let Some(Nearest(d, v)) = queue.pop() {
        if d > distance[v.0 as usize] {
            continue;
        }
        for h in mesh.conn.outgoing(v) {
            let w = mesh.conn.to(h);
            let through = d + mesh.positions[v].distance(mesh.positions[w]) * dear(w);
            if through < distance[w.0 as usize] {
                distance[w.0 as usize] = through;
                before[w.0 as usize] = Some(v);
                queue.push(Nearest(through, w));
            }
        }
    }
    (distance, before)
}

/// Cuts a closed mesh along a seam: the corners right of it get copies of the vertices between its ends, numbered on from
/// the mesh's. Returns every copy with what it is a copy of.
///
/// # Errors
/// Input, naming the vertex, if the seam is no simple way along edges or a feature lies on it.
pub fn cut_along(
    mesh: &TriMesh,
    seam: &[VertexId],
    features: &[VertexId],
    faces: &mut [[VertexId; 3]],
) -> Result<Vec<(VertexId, VertexId)>> {
    let remedy = "name the vertices of a way along edges, in order";
    if seam.len() < LEAST {
        return Err(Error::input(format!("a seam of {} vertices", seam.len())).remedy("name three or more"));
    }
    let mut seen = HashSet::new();
    for &v in seam {
        let exists = (v.0 as usize) < mesh.positions.len();
        if !exists || !seen.insert(v) {
            let what = if exists { "the seam passes a vertex twice" } else { "the seam has a vertex the mesh lacks" };
            return Err(Error::input(what).at(v).remedy(remedy));
        }
        if features.contains(&v) {
            return Err(Error::input("a constrained vertex lies on the seam").at(v).remedy("lead the seam past it"));
        }
    }
    let mut copies = Vec::new();
    for three in seam.windows(LEAST) {
        let missing = |a: VertexId, b: VertexId| {
            Error::input("the seam jumps: there is no edge").at(format!("{a} to {b}")).remedy(remedy)
        };
        let [a, v, b] = [three[0], three[1], three[2]];
        let ahead = mesh.conn.find(v, b).ok_or_else(|| missing(v, b))?;
        let back = mesh.conn.find(v, a).ok_or_else(|| missing(a, v))?;
        let copy = VertexId((mesh.positions.len() + copies.len()) as u32);
        // Counter-clockwise from the way back to the way ahead lies what is right of the seam.
        let mut h = back;
        while h != ahead {
            let face = crate::mesh::face_of(h).0 as usize;
            faces[face].iter_mut().filter(|c| **c == v).for_each(|c| *c = copy);
            h = mesh.conn.turn_left(h).ok_or_else(|| Error::bug("a closed mesh has a boundary").at(v))?;
        }
        copies.push((copy, v));
    }
    Ok(copies)
}
