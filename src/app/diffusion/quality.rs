//! How good a region's (u, v) are: folds, stretch, angles, and how much isolines turn where they cross edges.

use super::piece::Piece;
use super::repair::pockets;
use crate::map::distortion::{Measures, distortion};
use crate::mesh::{FaceId, IdVec, TriMesh, VertexId, metric};
use crate::plane::orientation::orientation;
use glam::{DVec2, DVec3};
use serde::Serialize;
use std::collections::HashMap;

/// What is measured of a region.
#[derive(Clone, Debug, Serialize)]
pub struct Quality {
    /// Triangles that are turned over in (u, v): the map is no bijection there.
    pub folds: Vec<FaceId>,
    /// Triangles without area in (u, v).
    pub flat: Vec<FaceId>,
    /// Triangles that no map with these sides has room for: an edge that joins two vertices of one side cuts them off. They
    /// count neither as folds nor as flat, and the measures leave them out.
    pub pinned: Vec<FaceId>,
    /// From the surface to (u, v) as a rectangle with the region's mean width and height; `flips` counts folds and flat ones.
    pub measures: Measures,
    /// The same from the rectangle to the surface: the stretch of a texture; very large where triangles are flat.
    pub texture: Measures,
    /// Mean angle by which an isoline of u or v turns where it crosses an edge, radians, in the unfolded surface.
    pub jitter: f64,
}

/// Measures a region.
pub fn quality(mesh: &TriMesh, piece: &Piece) -> Quality {
    let corners = |t: &[u32; 3]| t.map(|v| piece.st[v as usize]);
    let signs: Vec<f64> = piece.disc.triangles.iter().map(corners).map(|[a, b, c]| orientation(a, b, c)).collect();
    let pocketed = pockets(piece);
    let pick = |keep: fn(f64, bool) -> bool| -> Vec<FaceId> {
        let kept = (0..signs.len()).filter(|&t| keep(signs[t], pocketed[t]));
        kept.map(|t| piece.disc.faces[t]).collect()
    };
    let folds = pick(|sign, is_pinned| sign < 0.0 && !is_pinned);
    let flat = pick(|sign, is_pinned| sign == 0.0 && !is_pinned);
    let pinned = pick(|_, is_pinned| is_pinned);
    let size = piece.size(mesh);
    let roomy = piece.disc.triangles.iter().zip(&pocketed).filter(|&(_, &is_pinned)| !is_pinned);
    let triangles: Vec<[VertexId; 3]> = roomy.map(|(t, _)| t.map(VertexId)).collect();
    let before: IdVec<VertexId, DVec3> = piece.disc.points(mesh).into_iter().collect();
    let after = piece.st.iter().map(|&p| (p * size).extend(0.0)).collect();
    let both = distortion(&triangles, &before, &after, folds.len() + flat.len());
    Quality { folds, flat, pinned, measures: both.forward, texture: both.backward, jitter: jitter(piece, &before.raw) }
}

/// Mean turn of isolines at edges; an edge counts as often as isolines of equal spacing cross it.
fn jitter(piece: &Piece, points: &[DVec3]) -> f64 {
    let mut first_of: HashMap<[u32; 2], [DVec2; 2]> = HashMap::new();
    let (mut turn, mut crossings) = (0.0, 0.0);
    for t in &piece.disc.triangles {
        for i in 0..3 {
            let [a, b, c] = [t[i], t[(i + 1) % 3], t[(i + 2) % 3]];
            let slopes = slopes([a, b, c], points, &piece.st);
            let Some(others) = first_of.remove(&[a.min(b), a.max(b)]) else {
                first_of.insert([a.min(b), a.max(b)], slopes);
                continue;
            };
            for axis in 0..2 {
                let steps = (piece.st[a as usize][axis] - piece.st[b as usize][axis]).abs();
                let angle = turned(slopes[axis], others[axis]);
                if steps > 0.0 && angle.is_finite() {
                    turn += steps * angle;
                    crossings += steps;
                }
            }
        }
    }
    if crossings > 0.0 { turn / crossings } else { 0.0 }
}

/// The slope of s and of t in a triangle, along its first side and at right angles to it, inwards.
fn slopes(corners: [u32; 3], points: &[DVec3], st: &[DVec2]) -> [DVec2; 2] {
    let [_, b, c] = metric::flatten(corners.map(|v| points[v as usize]));
    [0, 1].map(|axis| {
        let [at_a, at_b, at_c] = corners.map(|v| st[v as usize][axis]);
        let along = (at_b - at_a) / b.x;
        DVec2::new(along, (at_c - at_a - along * c.x) / c.y)
    })
}

/// The angle between slopes on both sides of an edge, each as its own triangle sees it: along the edge their signs differ,
/// and inwards is outwards of the other.
fn turned(here: DVec2, there: DVec2) -> f64 {
    here.angle_to(-there).abs()
}
