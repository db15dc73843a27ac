//! Re-embeds a region that folds: positive weights in the convex square, as the patches of the main job.
//!
//! Where an edge inside the region joins two vertices of one side, what lies between the edge and the side has no room in
//! any map that keeps the side straight. Such pockets are left out of the embedding and laid flat on the side.

use super::piece::Piece;
use super::square::pin;
use crate::mesh::TriMesh;
use crate::plane::convex::embed_patch;
use crate::plane::patch_disc::PatchDisc;
use crate::plane::stretch::Frame;
use glam::DVec2;
use std::collections::{HashMap, HashSet};

/// Gives a region new coordinates, those of its sides excepted. Triangles of pockets stay flat, all others are positive.
/// If no weights give positive triangles in floating point the region stays as it is.
pub fn repair(mesh: &TriMesh, piece: &mut Piece) {
    let (vertices, mut disc) = without_pockets(piece);
    let points: Vec<_> = disc.vertices.iter().map(|&v| mesh.positions[v]).collect();
    let size = piece.size(mesh);
    let frame = Frame { first: DVec2::new(size.x, 0.0), second: DVec2::new(0.0, size.y) };
    if embed_patch(&mut disc, &points, &frame).is_none() {
        return;
    }
    vertices.iter().zip(&disc.positions).for_each(|(&v, &p)| piece.st[v as usize] = p);
    lay_flat(piece, &vertices);
    pin(&piece.sides, &mut piece.st);
    piece.repaired = true;
}

/// The region without its pockets as a patch, and the region's number of each of its vertices.
fn without_pockets(piece: &Piece) -> (Vec<u32>, PatchDisc) {
    let pocketed = pockets(piece);
    let kept: Vec<usize> = (0..pocketed.len()).filter(|&t| !pocketed[t]).collect();
    let mut vertices = rim_of(piece, &kept);
    let boundary = vertices.len();
    let corner = |k: usize| vertices.iter().position(|&v| v == piece.sides[k].vertices[0]).unwrap_or(0) as u32;
    // Patches have three sides; two of the square's count as one, which holds back merges across its corner, no more.
    let corners = [0, 1, 2].map(corner);
    let mut number: HashMap<u32, u32> = vertices.iter().copied().zip(0u32..).collect();
    let mut local = |v: u32| {
        *number.entry(v).or_insert_with(|| {
            vertices.push(v);
            vertices.len() as u32 - 1
        })
    };
    let triangles = kept.iter().map(|&t| piece.disc.triangles[t].map(&mut local)).collect();
    let disc = PatchDisc {
        vertices: vertices.iter().map(|&v| piece.disc.vertices[v as usize]).collect(),
        faces: kept.iter().map(|&t| piece.disc.faces[t]).collect(),
        triangles,
        boundary,
        corners,
        positions: vertices.iter().map(|&v| piece.st[v as usize]).collect(),
    };
    (vertices, disc)
}

/// The triangles between a side and an edge that joins two of its vertices.
pub fn pockets(piece: &Piece) -> Vec<bool> {
    let triangles = &piece.disc.triangles;
    let mut at_edge: HashMap<[u32; 2], usize> = HashMap::new();
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        at_edge.extend([[a, b], [b, c], [c, a]].map(|way| (way, t)));
    }
    let mut pocketed = vec![false; triangles.len()];
    for side in &piece.sides {
        let place: HashMap<u32, usize> = side.vertices.iter().enumerate().map(|(i, &v)| (v, i)).collect();
        // An edge a b with the pocket at its left runs against the side.
        let is_chord = |[a, b]: [u32; 2]| {
            let ends = place.get(&a).zip(place.get(&b));
            ends.is_some_and(|(&i, &j)| i > j) && at_edge.contains_key(&[b, a])
        };
        let mut stack: Vec<usize> = at_edge.iter().filter(|&(&way, _)| is_chord(way)).map(|(_, &t)| t).collect();
        while let Some(t) = stack.pop() {
            if std::mem::replace(&mut pocketed[t], true) {
                continue;
            }
            let [a, b, c] = triangles[t];
            let ways = [[a, b], [b, c], [c, a]].into_iter().filter(|&way| !is_chord(way));
            stack.extend(ways.filter_map(|[v, w]| at_edge.get(&[w, v]).copied()));
        }
    }
    pocketed
}

/// The border of the triangles that are kept, counter-clockwise from the first corner.
fn rim_of(piece: &Piece, kept: &[usize]) -> Vec<u32> {
    let ways = kept.iter().flat_map(|&t| {
        let [a, b, c] = piece.disc.triangles[t];
        [[a, b], [b, c], [c, a]]
    });
    let all: HashSet<[u32; 2]> = ways.clone().collect();
    let after: HashMap<u32, u32> = ways.filter(|&[a, b]| !all.contains(&[b, a])).map(|[a, b]| (a, b)).collect();
    let first = piece.sides[0].vertices[0];
    let mut rim = vec![first];
    while let Some(&next) = after.get(&rim[rim.len() - 1]).filter(|&&next| next != first && rim.len() <= after.len()) {
        rim.push(next);
    }
    rim
}

/// Puts the vertices inside pockets at the nearest vertex that has a place, along edges.
fn lay_flat(piece: &mut Piece, placed: &[u32]) {
    let on_side: Vec<u32> = piece.sides.iter().flat_map(|side| &side.vertices).copied().collect();
    let mut settled: HashSet<u32> = on_side.into_iter().chain(placed.iter().copied()).collect();
    while settled.len() < piece.st.len() {
        let before = settled.clone();
        for &[a, b, c] in &piece.disc.triangles {
            for [v, w] in [[a, b], [b, c], [c, a], [b, a], [c, b], [a, c]] {
                if before.contains(&v) && settled.insert(w) {
                    piece.st[w as usize] = piece.st[v as usize];
                }
            }
        }
        if settled.len() == before.len() {
            return;
        }
    }
}
