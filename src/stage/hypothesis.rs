//! Stage: where arcs should run, guessed from a rough compatible mesh (HYPOTHESIS 3.1, 3.2).
//!
//! Input: two meshes and pairs of base vertices. Output: for every pair of base vertices a path on the source and the
//! vertices near its counterpart on the target. The rough mesh has the source's connectivity: the least-squares mesh
//! with its base vertices on the target's, drawn onto the target where that faces the same way. Or it is a finished map.

use crate::error::{Error, Result};
use crate::mesh::face_tree::FaceTree;
use crate::mesh::{FaceId, Id, IdVec, LandmarkId, TriMesh, VertexId, metric};
use crate::path::edge_tree::EdgeTree;
use crate::solve::least_squares_mesh::{Pull, least_squares_mesh};
use glam::DVec3;
use rayon::prelude::*;

/// Weight of a base vertex: it lies where it should but for rounding.
const PINNED: f64 = 1e4;
/// Weights of the places that the target offers, one fit after the other: first the mesh only leans towards them.
const DRAWN: [f64; 3] = [1e-3, 1e-2, 1e-1];
/// A vertex is drawn to nothing farther than this, in units of the root of the target's area.
const REACH: f64 = 0.2;
/// Least cosine of the angle between the normals of a vertex and the face it is drawn to.
const FACING: f64 = 0.3;

/// Where every vertex of the source lies on the target, roughly.
pub type Rough = IdVec<VertexId, DVec3>;

/// A guess of where two paths that correspond run.
#[derive(Clone, Debug)]
pub struct PathHypothesis {
    /// The base vertices it joins.
    pub ends: [LandmarkId; 2],
    /// Vertices along it on either mesh.
    pub vertices: [Vec<VertexId>; 2],
    /// Its length on the source, and on the rough mesh: what an arc that does not swirl comes near.
    pub lengths: [f64; 2],
}

/// The source draped over the target. Fails where the meshes do not allow a solution.
pub fn rough_map(meshes: [&TriMesh; 2], base: [&[VertexId]; 2]) -> Result<Rough> {
    let [source, target] = meshes;
    let pins =
        base[0].iter().zip(base[1]).map(|(&vertex, &on)| Pull { vertex, to: target.positions[on], weight: PINNED });
    let pins: Vec<Pull> = pins.collect();
    let unsolved = || Error::bug("the least-squares mesh has no solution");
    let mut rough = least_squares_mesh(source, &pins).ok_or_else(unsolved)?;
    let tree = FaceTree::new(target);
    let reach = REACH * target.area().sqrt();
    for weight in DRAWN {
        let normals = normals(source, &rough);
        let draw =
            |v: VertexId| Some(Pull { vertex: v, to: place(target, &tree, rough[v], normals[v], reach)?, weight });
        let vertices: Vec<VertexId> = source.conn.vertices().collect();
        let drawn: Vec<Option<Pull>> = vertices.par_iter().map(|&v| draw(v)).collect();
        let pulls: Vec<Pull> = pins.iter().copied().chain(drawn.into_iter().flatten()).collect();
        rough = least_squares_mesh(source, &pulls).ok_or_else(unsolved)?;
    }
    let normals = normals(source, &rough);
    let vertices: Vec<VertexId> = source.conn.vertices().collect();
    let onto = |&v: &VertexId| place(target, &tree, rough[v], normals[v], reach).unwrap_or(rough[v]);
    let mut drawn: Rough = IdVec::from_raw(vertices.par_iter().map(onto).collect());
    pins.iter().for_each(|pin| drawn[pin.vertex] = pin.to);
    Ok(drawn)
}

/// The nearest point of a mesh that faces the same way.
fn place(mesh: &TriMesh, tree: &FaceTree, p: DVec3, normal: DVec3, reach: f64) -> Option<DVec3> {
    let faces = |f: FaceId| {
        let [a, b, c] = mesh.triangle(f);
        (b - a).cross(c - a).normalize_or_zero().dot(normal) >= FACING
    };
    let f = tree.nearest_within(p, reach, faces)?;
    Some(metric::closest_point(p, mesh.triangle(f)))
}

/// Unit normals of the vertices of a mesh at other positions.
fn normals(mesh: &TriMesh, positions: &Rough) -> IdVec<VertexId, DVec3> {
    let mut normals = IdVec::filled(DVec3::ZERO, positions.len());
    for f in mesh.conn.faces() {
        let corners = mesh.conn.face(f);
        let [a, b, c] = corners.map(|v| positions[v]);
        corners.into_iter().for_each(|v| normals[v] += (b - a).cross(c - a));
    }
    normals.raw.iter_mut().for_each(|n| *n = n.normalize_or_zero());
    normals
}

/// Hypotheses for all pairs of base vertices whose path passes by no other one, the shortest on the rough mesh first.
pub fn path_hypotheses(meshes: [&TriMesh; 2], base: [&[VertexId]; 2], rough: &Rough) -> Vec<PathHypothesis> {
    let [source, target] = meshes;
    let tree = FaceTree::new(target);
    let from = |i: usize| {
        let step = |v: VertexId, w: VertexId| rough[v].distance(rough[w]);
        let paths = EdgeTree::grow(source, &base[0][i..=i], f64::INFINITY, step);
        let to = |j: usize| {
            let along = paths.path_to(base[0][j]);
            let is_clear =
                paths.length[base[0][j]].is_finite() && !along[1..along.len() - 1].iter().any(|v| base[0].contains(v));
            is_clear.then(|| {
                let length = along.windows(2).map(|w| source.positions[w[0]].distance(source.positions[w[1]])).sum();
                PathHypothesis {
                    ends: [i, j].map(LandmarkId::new),
                    lengths: [length, paths.length[base[0][j]]],
                    vertices: [along.clone(), counterpart(target, &tree, rough, &along, [base[1][i], base[1][j]])],
                }
            })
        };
        (i + 1..base[0].len()).filter_map(to).collect::<Vec<_>>()
    };
    let all: Vec<Vec<PathHypothesis>> = (0..base[0].len()).into_par_iter().map(from).collect();
    let mut all = all.concat();
    all.sort_by(|a, b| a.lengths[1].total_cmp(&b.lengths[1]).then(a.ends.cmp(&b.ends)));
    all
}

/// The target's vertices near the places of a path on the rough mesh.
fn counterpart(
    target: &TriMesh,
    tree: &FaceTree,
    rough: &Rough,
    along: &[VertexId],
    ends: [VertexId; 2],
) -> Vec<VertexId> {
    let middle = |w: &[VertexId]| (rough[w[0]] + rough[w[1]]) * 0.5;
    let places = along.iter().map(|&v| rough[v]).chain(along.windows(2).map(middle));
    let faces = places.filter_map(|p| tree.nearest_within(p, f64::INFINITY, |_| true));
    let mut near: Vec<VertexId> = faces.flat_map(|f| target.conn.face(f)).chain(ends).collect();
    near.sort_unstable();
    near.dedup();
    near
}
