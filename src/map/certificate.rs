//! The certificate that a finished map is a bijection, checked from the stored data alone.

use super::embedding::{EmbeddedMesh, Embedding};
use crate::mesh::{ArcId, FaceId, HalfedgeId, IdVec, LandmarkId, PatchId};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cut_mesh::CutMesh;
use crate::path::region::Regions;
use crate::plane::orientation::orientation;
use crate::plane::patch_disc::{PatchDisc, on_side};
use rayon::prelude::*;

/// What was checked, and how it came out.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Certificate {
    /// All of the below hold: the map is a homeomorphism.
    pub bijective: bool,
    /// Both cut meshes carry the same base complex, their arcs between the same landmarks.
    pub same_complex: bool,
    /// Every patch of both cut meshes is a disc with three sides, made of the faces it stands for.
    pub patches_are_discs: bool,
    /// Every triangle of every patch is exactly positively oriented in its base triangle, and boundary vertices follow
    /// each other along its sides, at the same place from both patches of an arc.
    pub positive: bool,
    /// Smallest orientation (twice the signed area) of any triangle, base triangles having orientation 1.
    pub min_orientation: f64,
}

/// Checks both meshes of an embedding.
pub fn certify(embedding: &Embedding) -> Certificate {
    let Embedding { base, meshes, .. } = embedding;
    let read = |m: &EmbeddedMesh| arcs_join_their_ends(m, base) && patches_of(m, base).as_ref() == Some(&base.patches);
    let same_complex = meshes.iter().all(read);
    let disc = |m: &EmbeddedMesh| m.discs.raw.par_iter().all(|d| is_disc(d) && stands_for_its_faces(d, &m.cut));
    let patches_are_discs = meshes.iter().all(disc);
    // Without the two above, a patch has no boundary to speak of.
    let boundaries = same_complex && patches_are_discs && meshes.iter().all(|m| boundaries_follow_arcs(m, base));
    let least = |m: &EmbeddedMesh| m.discs.raw.par_iter().map(min_orientation).reduce(|| f64::INFINITY, worse);
    let min_orientation = meshes.iter().map(least).fold(f64::INFINITY, worse);
    let positive = boundaries && min_orientation > 0.0;
    let bijective = same_complex && patches_are_discs && positive;
    Certificate { bijective, same_complex, patches_are_discs, positive, min_orientation }
}

/// True if every arc is a chain of edges between the landmarks at its ends.
fn arcs_join_their_ends(mesh: &EmbeddedMesh, base: &BaseComplex) -> bool {
    let cut = &mesh.cut;
    let known = cut.landmarks.iter_ids().all(|(l, &v)| cut.landmark_at[v] == Some(l));
    let joined = |(arc, ends): (ArcId, &[LandmarkId; 2])| {
        let end = cut.arc_path(arc, ends[0]).last().map(|&h| cut.conn.to(h));
        end == Some(cut.landmarks[ends[1]])
    };
    known && cut.landmarks.len() == base.landmarks && base.arcs.iter_ids().all(joined)
}

/// The patches as the arcs on the cut mesh bound them; None if some region is not a triangular disc or its faces are
/// not those of the embedded patch.
fn patches_of(mesh: &EmbeddedMesh, base: &BaseComplex) -> Option<IdVec<PatchId, [DirectedArc; 3]>> {
    let regions = Regions::find(&mesh.cut);
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

/// True if the triangles have the corners of the faces they stand for.
fn stands_for_its_faces(disc: &PatchDisc, cut: &CutMesh) -> bool {
    let corners = |t: &[u32; 3]| t.map(|v| disc.vertices[v as usize]);
    let same = |(t, &f): (&[u32; 3], &FaceId)| corners(t) == cut.conn.face(f);
    disc.triangles.len() == disc.faces.len() && disc.triangles.iter().zip(&disc.faces).all(same)
}

/// True if the boundary of every patch runs along its arcs, every vertex exactly at its share of the arc: in order, and
/// at the same place from both patches of the arc.
fn boundaries_follow_arcs(mesh: &EmbeddedMesh, base: &BaseComplex) -> bool {
    let paths: IdVec<ArcId, Vec<HalfedgeId>> =
        base.arcs.iter_ids().map(|(arc, ends)| mesh.cut.arc_path(arc, ends[0])).collect();
    let ordered = |(arc, path): (ArcId, &Vec<HalfedgeId>)| {
        let shares = &mesh.shares[arc];
        let ends = (shares.first(), shares.last()) == (Some(&0.0), Some(&1.0));
        ends && shares.len() == path.len() + 1 && shares.windows(2).all(|w| w[0] < w[1])
    };
    let patches: Vec<PatchId> = base.patches.ids().collect();
    paths.iter_ids().all(ordered) && patches.par_iter().all(|&p| boundary_follows_arcs(mesh, base, p, &paths))
}

fn boundary_follows_arcs(
    mesh: &EmbeddedMesh,
    base: &BaseComplex,
    p: PatchId,
    paths: &IdVec<ArcId, Vec<HalfedgeId>>,
) -> bool {
    let disc = &mesh.discs[p];
    let mut at = 0;
    for (k, side) in base.patches[p].iter().enumerate() {
        let (path, shares) = (&paths[side.arc], &mesh.shares[side.arc]);
        if disc.corners[k] as usize != at || disc.boundary < at + path.len() {
            return false;
        }
        for i in 0..path.len() {
            let (v, s) = if side.reversed {
                let j = path.len() - i;
                (mesh.cut.conn.to(path[j - 1]), 1.0 - shares[j])
            } else {
                (mesh.cut.conn.from(path[i]), shares[i])
            };
            if disc.vertices[at] != v || disc.positions[at] != on_side(k, s) {
                return false;
            }
            at += 1;
        }
    }
    at == disc.boundary
}

fn min_orientation(disc: &PatchDisc) -> f64 {
    let one = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| disc.positions[v as usize]);
        orientation(a, b, c)
    };
    disc.triangles.iter().map(one).fold(f64::INFINITY, worse)
}

/// The lower of two orientations; NaN must not pass for positive, so it counts as the lowest.
fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}
