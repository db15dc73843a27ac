//! Even triangles on a smooth solid: from a raw polygonisation to a mesh of about a wished number of vertices.
//!
//! Rounds of splitting long edges, collapsing short ones, Delaunay flips and tangential smoothing with projection back
//! onto the field. Curved places get shorter edges.
//! Source: Botsch, Kobbelt, "A remeshing approach to multiresolution modeling", 2004.

use super::draft::Draft;
use super::field::{Field, curvature, project};
use glam::DVec3;
use rayon::prelude::*;

/// Rounds of the four steps; the vertex count and the angles settle after about eight.
const ROUNDS: usize = 10;
/// Meshes with more vertices than this grow from one of this size.
const GROWN_FROM: usize = 8_000;
/// Rounds after growing.
const GROWN_ROUNDS: usize = 4;
/// Edges longer than this times the wish are split, edges shorter than [`SHORT`] times it collapsed. The two factors
/// bring the halves of a split edge, and the edges beside a collapsed one, nearest to the wish.
const LONG: f64 = 4.0 / 3.0;
/// See [`LONG`].
const SHORT: f64 = 4.0 / 5.0;
/// Edges on the most curved places are this share of those on flat ones; smaller wastes vertices on rims.
const FINEST_SHARE: f64 = 0.18;
/// Passes that spread a small wish to its neighbourhood, so that edge lengths change gradually.
const GRADING_PASSES: usize = 4;
/// The wish is stretched by at most this to meet the vertex count; where thin walls forbid a coarser mesh, insisting
/// would only spoil the triangles.
const MOST_CORRECTION: f64 = 1.3;
/// Passes over the faces in which long edges are split; a face meets at most this many splits a round.
const SPLIT_PASSES: usize = 6;
/// Smoothing steps a round.
const SMOOTHING_PASSES: usize = 3;

/// Turns `draft` into about `vertices` well-shaped vertices on the field's surface.
///
/// `flat` is the curvature radius from which on the surface counts as flat. Large meshes grow from a good small one,
/// which saves most of their rounds.
pub fn remesh(field: &Field, mut draft: Draft, vertices: usize, flat: f64) -> Draft {
    let small = vertices.min(GROWN_FROM);
    draft = rounds(field, draft, small, flat, ROUNDS);
    if vertices > small {
        draft = rounds(field, draft, vertices, flat, GROWN_ROUNDS);
    }
    draft
}

fn rounds(field: &Field, mut draft: Draft, vertices: usize, flat: f64, count: usize) -> Draft {
    let mut correction = 1.0;
    for round in 0..count {
        draft = draft.compacted();
        settle(field, &mut draft);
        wish(field, &mut draft, flat, vertices, correction);
        split_long(field, &mut draft);
        collapse_short(&mut draft);
        for _ in 0..SMOOTHING_PASSES {
            flip_all(&mut draft);
            smooth(field, &mut draft);
        }
        if round > 0 {
            correction *= (draft.live_vertices() as f64 / vertices as f64).sqrt();
            correction = correction.clamp(1.0 / MOST_CORRECTION, MOST_CORRECTION);
        }
    }
    flip_all(&mut draft);
    draft
}

/// Moves every vertex onto the surface and notes the normal there.
fn settle(field: &Field, draft: &mut Draft) {
    let both = draft.positions.par_iter_mut().zip(&mut draft.normals);
    both.for_each(|(p, n)| (*p, *n) = project(field, *p));
}

/// Sets the wished edge lengths: by curvature, graded, and scaled so that about `vertices` vertices result.
fn wish(field: &Field, draft: &mut Draft, flat: f64, vertices: usize, correction: f64) {
    draft.sizes.par_iter_mut().zip(&draft.positions).for_each(|(size, &p)| {
        let bend = curvature(field, p) * flat;
        *size = (1.0 / bend.max(1.0)).sqrt().max(FINEST_SHARE);
    });
    for _ in 0..GRADING_PASSES {
        let old = draft.sizes.clone();
        for v in 0..old.len() {
            let (sum, n) = draft.neighbours(v as u32).fold((0.0, 0), |(s, n), w| (s + old[w as usize], n + 1));
            if n > 0 {
                draft.sizes[v] = old[v].min(0.5 * (old[v] + sum / f64::from(n)));
            }
        }
    }
    let mut triangles = 0.0;
    for [a, b, c] in (0..draft.capacity().1).filter_map(|f| draft.face(f)).map(|face| face.map(|v| v as usize)) {
        let (p, q, r) = (draft.positions[a], draft.positions[b], draft.positions[c]);
        let size = (draft.sizes[a] + draft.sizes[b] + draft.sizes[c]) / 3.0;
        triangles += (q - p).cross(r - p).length() * 0.5 / (size * size * 3f64.sqrt() / 4.0);
    }
    let unit = (triangles / (2 * vertices) as f64).sqrt() * correction;
    draft.sizes.iter_mut().for_each(|size| *size *= unit);
}

/// The edges of a face that leave it for a higher-numbered vertex: each edge of a closed mesh is met once.
fn edges(face: [u32; 3]) -> impl Iterator<Item = (u32, u32)> {
    (0..3).map(move |i| (face[i], face[(i + 1) % 3])).filter(|(a, b)| a < b)
}

/// Splits the first long edge of every face, a few times over: each split halves what is left to do.
fn split_long(field: &Field, draft: &mut Draft) {
    for _ in 0..SPLIT_PASSES {
        for f in 0..draft.capacity().1 {
            let long = draft.face(f).and_then(|face| edges(face).find(|&(a, b)| draft.relative_length(a, b) > LONG));
            if let Some((a, b)) = long {
                draft.split(a, b, field);
            }
        }
    }
}

fn collapse_short(draft: &mut Draft) {
    for f in 0..draft.capacity().1 {
        let Some(face) = draft.face(f) else { continue };
        for (a, b) in edges(face).filter(|&(a, b)| draft.relative_length(a, b) < SHORT).collect::<Vec<_>>() {
            if draft.collapse(a, b, LONG) || draft.collapse(b, a, LONG) {
                break;
            }
        }
    }
}

fn flip_all(draft: &mut Draft) {
    for f in 0..draft.capacity().1 {
        let Some(face) = draft.face(f) else { continue };
        for (a, b) in edges(face) {
            if draft.flip(a, b) {
                break;
            }
        }
    }
}

/// Moves every vertex towards the middle of its neighbours, along the surface.
fn smooth(field: &Field, draft: &mut Draft) {
    let moved = |v: usize| {
        let old = |w: u32| draft.positions[w as usize];
        let (sum, n) = draft.neighbours(v as u32).fold((DVec3::ZERO, 0), |(s, n), w| (s + old(w), n + 1));
        let (p, normal) = (draft.positions[v], draft.normals[v]);
        if n == 0 {
            return (p, normal);
        }
        let step = sum / f64::from(n) - p;
        project(field, p + (step - normal * step.dot(normal)) * 0.5)
    };
    (draft.positions, draft.normals) = (0..draft.positions.len()).into_par_iter().map(moved).unzip();
}
