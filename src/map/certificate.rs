//! The certificate that a finished map is a bijection, checked from the stored data alone.

use super::embedding::{EmbeddedMesh, Embedding};
use crate::mesh::{IdVec, PatchId};
use crate::path::base_complex::BaseComplex;
use crate::path::region::Regions;
use crate::plane::orientation::orientation;
use crate::plane::patch_disc::{PatchDisc, on_side};
use rayon::prelude::*;

/// What was checked, and how it came out.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Certificate {
    /// All of the below hold: the map is a homeomorphism.
    pub bijective: bool,
    /// Both cut meshes carry the same base complex.
    pub same_complex: bool,
    /// Every patch of both cut meshes is a disc with three sides.
    pub patches_are_discs: bool,
    /// Every triangle of every patch is exactly positively oriented in its base triangle, and boundary vertices follow
    /// each other along its sides.
    pub positive: bool,
    /// Smallest orientation (twice the signed area) of any triangle, base triangles having orientation 1.
    pub min_orientation: f64,
}

/// Checks both meshes of an embedding.
pub fn certify(embedding: &Embedding) -> Certificate {
    let read = [0, 1].map(|k| patches_of(&embedding.meshes[k], &embedding.base));
    let same_complex = read.iter().all(|patches| patches.as_ref() == Some(&embedding.base.patches));
    let patches_are_discs = embedding.meshes.iter().all(|m| m.discs.raw.par_iter().all(is_disc));
    let boundaries = embedding.meshes.iter().all(|m| m.discs.raw.par_iter().all(boundary_in_order));
    let least = |m: &EmbeddedMesh| m.discs.raw.par_iter().map(min_orientation).reduce(|| f64::INFINITY, f64::min);
    let min_orientation = embedding.meshes.iter().map(least).fold(f64::INFINITY, f64::min);
    let positive = boundaries && min_orientation > 0.0;
    let bijective = same_complex && patches_are_discs && positive;
    Certificate { bijective, same_complex, patches_are_discs, positive, min_orientation }
}

/// The patches as the arcs on the cut mesh bound them; None if some region is not a triangular disc or its faces are
/// not those of the embedded patch.
fn patches_of(
    mesh: &EmbeddedMesh,
    base: &BaseComplex,
) -> Option<IdVec<PatchId, [crate::path::base_complex::DirectedArc; 3]>> {
    let regions = Regions::find(&mesh.cut, &|_| true);
    let mut patches = Vec::with_capacity(base.patches.len());
    for disc in mesh.discs.iter() {
        let region = regions.of_face[*disc.faces.first()?];
        let whole = disc.faces.iter().all(|&f| regions.of_face[f] == region);
        let [walk] = regions.walks[region as usize].as_slice() else { return None };
        let mut sides = <[_; 3]>::try_from(walk.as_slice()).ok()?;
        let first = (0..3).min_by_key(|&k| sides[k])?;
        sides.rotate_left(first);
        if !whole || regions.genus[region as usize] != 0 || !regions.isolated[region as usize].is_empty() {
            return None;
        }
        patches.push(sides);
    }
    let covered: usize = mesh.discs.iter().map(|d| d.faces.len()).sum();
    (covered == mesh.cut.conn.face_count() && patches.len() == regions.walks.len()).then(|| IdVec::from_raw(patches))
}

/// A connected patch is a disc if V - E + F = 1 and its boundary edges are exactly its sides.
fn is_disc(disc: &PatchDisc) -> bool {
    let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * disc.triangles.len());
    for &[a, b, c] in &disc.triangles {
        edges.extend([(a, b), (b, c), (c, a)].map(|(u, v)| (u.min(v), u.max(v), u < v)));
    }
    edges.sort_unstable();
    let mut inner = 0;
    let mut outer = 0;
    let mut i = 0;
    while i < edges.len() {
        let paired = edges.get(i + 1).is_some_and(|e| (e.0, e.1) == (edges[i].0, edges[i].1) && e.2 != edges[i].2);
        if paired {
            inner += 1
        } else {
            outer += 1
        }
        i += if paired { 2 } else { 1 };
    }
    outer == disc.boundary && disc.vertices.len() + disc.triangles.len() == inner + outer + 1
}

/// Boundary vertices lie exactly on the sides, in order from corner to corner.
fn boundary_in_order(disc: &PatchDisc) -> bool {
    let n = disc.boundary;
    (0..3).all(|k| {
        let from = disc.corners[k] as usize;
        let to = if k == 2 { n } else { disc.corners[k + 1] as usize };
        let share = |i: usize| {
            let p = disc.positions[i % n];
            if k == 0 { p.x } else { if k == 1 { p.y } else { 1.0 - p.y } }
        };
        let starts = disc.positions[from] == on_side(k, 0.0);
        let ends = disc.positions[to % n] == on_side(k, 1.0);
        let on = (from..to).all(|i| disc.positions[i] == on_side(k, share(i)));
        let last = |i: usize| if i == to { 1.0 } else { share(i) };
        starts && ends && on && (from..to).all(|i| last(i) < last(i + 1))
    })
}

fn min_orientation(disc: &PatchDisc) -> f64 {
    let one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| disc.positions[v as usize]);
        orientation(a, b, c)
    };
    // NaN must not pass for positive, so it counts as the worst.
    disc.triangles.iter().map(one).fold(f64::INFINITY, |m, x| if x < m || x.is_nan() { x } else { m })
}
