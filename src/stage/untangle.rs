//! Stage: triangles of the compatible meshes that came out turned over are turned back.
//!
//! Input: a relaxed embedding. Output: the same with some vertices moved a little. Invariant: every patch stays embedded,
//! and the number of turned triangles does not rise; the energy may, by little and near such triangles alone.

use super::relax::{LEAST_SNAP, domains, independent_domains, unit_scale};
use crate::error::Result;
use crate::map::embedding::Embedding;
use crate::map::recut::{Relaxed, recut_all};
use crate::mesh::{TriMesh, VertexId, face_of};
use crate::plane::domain::Domain;
use crate::plane::straighten::straighten;
use crate::plane::tiling::Tiling;
use crate::plane::untangle::untangle;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// Visits of all domains.
const ROUNDS: usize = 2;

/// Turns back what can be turned back; returns how many triangles were.
pub fn untangle_samples(meshes: [&TriMesh; 2], embedding: &mut Embedding) -> Result<usize> {
    let scale = unit_scale(meshes);
    let groups = independent_domains(embedding);
    let mut turned_back = 0;
    for _ in 0..ROUNDS {
        let before = turned_back;
        for group in &groups {
            let visit = |tiling: &Tiling| visit(meshes, embedding, tiling, scale);
            let results: Vec<Option<(usize, [Relaxed; 2])>> = group.par_iter().map(visit).collect();
            turned_back += results.iter().flatten().map(|(count, _)| count).sum::<usize>();
            let relaxed: Vec<_> = results.into_iter().map(|r| r.map(|(_, relaxed)| relaxed)).collect();
            recut_all(meshes, embedding, group, &relaxed)?;
        }
        if turned_back == before {
            break;
        }
    }
    Ok(turned_back)
}

fn visit(
    meshes: [&TriMesh; 2],
    embedding: &Embedding,
    tiling: &Tiling,
    scale: [f64; 2],
) -> Option<(usize, [Relaxed; 2])> {
    let [mut source, mut target] = domains(embedding, tiling, scale);
    let sampled = [faces(meshes[0], &source), faces(meshes[1], &target)];
    let on_target = untangle(&mut source, &target, &sampled[0]);
    let on_source = untangle(&mut target, &source, &sampled[1]);
    if on_target + on_source == 0 {
        return None;
    }
    let straight = [straighten(&mut source, tiling, LEAST_SNAP)?, straighten(&mut target, tiling, LEAST_SNAP)?];
    let [first, second] = straight;
    let relaxed = [Relaxed { domain: source, straight: first }, Relaxed { domain: target, straight: second }];
    Some((on_target + on_source, relaxed))
}

/// The faces of the original mesh with a corner that may move, by vertices of the domain.
fn faces(mesh: &TriMesh, domain: &Domain) -> Vec<[u32; 3]> {
    let is_original = |v: VertexId| (v.0 as usize) < mesh.positions.len();
    let number: HashMap<VertexId, u32> =
        (0u32..).zip(&domain.vertices).filter(|(_, v)| is_original(**v)).map(|(i, &v)| (v, i)).collect();
    let free = domain.vertices.iter().zip(&domain.free).filter(|(v, free)| **free && is_original(**v));
    let mut seen = HashSet::new();
    let mut faces = Vec::new();
    for f in free.flat_map(|(&v, _)| mesh.conn.outgoing(v).map(face_of)) {
        let [a, b, c] = mesh.conn.face(f).map(|v| number.get(&v).copied());
        if let (Some(a), Some(b), Some(c)) = (a, b, c)
            && seen.insert(f)
        {
            faces.push([a, b, c]);
        }
    }
    faces
}
