//! Removes vertices that only the cut mesh has and that no arc needs any more.
//!
//! Every move of an arc leaves the vertices of its old way behind. Such a vertex is merged into a neighbour where that
//! leaves the original surface as it is (all triangles stay inside their original faces and keep their orientation
//! there) and the embedding too (all triangles stay exactly positive).

use super::embedding::EmbeddedMesh;
use crate::error::{Error, Result};
use crate::mesh::{FaceId, Id, IdVec, PatchId, TriMesh, VertexId};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cut_mesh::CutMesh;
use crate::plane::orientation::orientation;
use crate::plane::patch_disc::{PatchDisc, Scratch, patch_disc};
use glam::DVec2;
use rayon::prelude::*;
use std::collections::HashMap;

/// Every triangle made by a merge keeps at least this share of the ring's area, on the surface and in the plane.
const LEAST_SHARE: f64 = 1e-4;

/// A triangle of a patch, by local vertices, and the original face it is part of.
type Part = ([u32; 3], FaceId);

/// Removes what can be removed from all patches of a mesh; returns how many vertices went.
pub fn purge(mesh: &TriMesh, embedded: &mut EmbeddedMesh, base: &BaseComplex, edge_nodes: u32) -> Result<usize> {
    let thin = |disc: &PatchDisc| thin_out(mesh, &embedded.cut, disc);
    let parts: Vec<Vec<Part>> = embedded.discs.raw.par_iter().map(thin).collect();
    let before = embedded.cut.conn.vertex_count();
    let (cut, number) = assemble(mesh, embedded, &parts, edge_nodes)?;
    let cut = mark_arcs(cut, embedded, base, &number)?;
    let mut scratch = Scratch::default();
    let mut discs = IdVec::<PatchId, PatchDisc>::default();
    for p in base.patches.ids() {
        let old = &embedded.discs[p];
        let mut disc = patch_disc(&cut, base, p, &embedded.shares, &mut scratch)?;
        let at: HashMap<VertexId, DVec2> =
            (old.boundary..old.vertices.len()).map(|i| (number[old.vertices[i]], old.positions[i])).collect();
        for i in disc.boundary..disc.vertices.len() {
            let missing = || Error::bug("a vertex got lost in clean-up").at(disc.vertices[i]);
            disc.positions[i] = *at.get(&disc.vertices[i]).ok_or_else(missing)?;
        }
        discs.push(disc);
    }
    let removed = before - cut.conn.vertex_count();
    embedded.cut = cut;
    embedded.discs = discs;
    Ok(removed)
}

/// Builds the cut mesh from the remaining triangles; also returns the new number of every old vertex.
fn assemble(
    mesh: &TriMesh,
    embedded: &EmbeddedMesh,
    parts: &[Vec<Part>],
    edge_nodes: u32,
) -> Result<(CutMesh, IdVec<VertexId, VertexId>)> {
    let old = &embedded.cut;
    let originals = mesh.positions.len();
    let mut used = vec![false; old.conn.vertex_count()];
    used[..originals].fill(true);
    for (disc, parts) in embedded.discs.iter().zip(parts) {
        parts.iter().flat_map(|(t, _)| t).for_each(|&v| used[disc.vertices[v as usize].index()] = true);
    }
    let mut number = IdVec::filled(VertexId(u32::MAX), used.len());
    let mut origin = Vec::new();
    for v in old.conn.vertices().filter(|v| used[v.index()]) {
        number[v] = VertexId::new(origin.len());
        origin.push(old.origin[v]);
    }
    let (mut faces, mut face_origin) = (Vec::new(), Vec::new());
    for (disc, parts) in embedded.discs.iter().zip(parts) {
        for (t, f) in parts {
            faces.push(t.map(|v| number[disc.vertices[v as usize]]));
            face_origin.push(*f);
        }
    }
    let cut = CutMesh::assemble(mesh, &faces, origin, face_origin, &old.landmarks.raw, edge_nodes)?;
    Ok((cut, number))
}

fn mark_arcs(
    mut cut: CutMesh,
    embedded: &EmbeddedMesh,
    base: &BaseComplex,
    number: &IdVec<VertexId, VertexId>,
) -> Result<CutMesh> {
    for (arc, ends) in base.arcs.iter_ids() {
        for h in embedded.cut.arc_path(arc, ends[0]) {
            let [a, b] = [embedded.cut.conn.from(h), embedded.cut.conn.to(h)].map(|v| number[v]);
            let lost = || Error::bug("an arc got lost in clean-up").at(arc);
            let h = cut.conn.find(a, b).ok_or_else(lost)?;
            cut.mark(h, DirectedArc { arc, reversed: false });
        }
    }
    Ok(cut)
}

/// The triangles of a patch after merging all free vertices that can be merged.
fn thin_out(mesh: &TriMesh, cut: &CutMesh, disc: &PatchDisc) -> Vec<Part> {
    let mut parts: Vec<Option<Part>> =
        disc.triangles.iter().zip(&disc.faces).map(|(&t, &f)| Some((t, cut.face_origin[f]))).collect();
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); disc.vertices.len()];
    for (k, t) in (0u32..).zip(&disc.triangles) {
        t.iter().for_each(|&v| around[v as usize].push(k));
    }
    for v in disc.boundary..disc.vertices.len() {
        if disc.vertices[v].index() >= mesh.positions.len() {
            merge(mesh, cut, disc, v as u32, &mut parts, &mut around);
        }
    }
    parts.into_iter().flatten().collect()
}

/// Merges `v` into the first neighbour that allows it.
fn merge(mesh: &TriMesh, cut: &CutMesh, disc: &PatchDisc, v: u32, parts: &mut [Option<Part>], around: &mut [Vec<u32>]) {
    let ring: Vec<(u32, Part)> = around[v as usize].iter().filter_map(|&k| Some((k, parts[k as usize]?))).collect();
    let neighbours: Vec<u32> = ring.iter().map(|(_, (t, _))| after(t, v)).collect();
    let into = neighbours.iter().copied().find(|&w| {
        let shared =
            |u: &u32| around[w as usize].iter().any(|&k| parts[k as usize].is_some_and(|(t, _)| t.contains(u)));
        let link = neighbours.iter().filter(|&&u| u != w && shared(&u)).count();
        link == 2 && keeps_shape(mesh, cut, disc, &ring, v, w)
    });
    let Some(w) = into else { return };
    for (k, (t, f)) in ring {
        if t.contains(&w) {
            parts[k as usize] = None;
        } else {
            parts[k as usize] = Some((t.map(|u| if u == v { w } else { u }), f));
            around[w as usize].push(k);
        }
    }
    around[v as usize].clear();
}

/// The corner of `t` that follows `v`.
fn after(t: &[u32; 3], v: u32) -> u32 {
    let i = t.iter().position(|&u| u == v).unwrap_or(0);
    t[(i + 1) % 3]
}

/// True if the ring of `v`, drawn to `w` instead, stays inside the original faces and embedded.
fn keeps_shape(mesh: &TriMesh, cut: &CutMesh, disc: &PatchDisc, ring: &[(u32, Part)], v: u32, w: u32) -> bool {
    let planar = |t: [u32; 3]| {
        let [a, b, c] = t.map(|u| disc.positions[u as usize]);
        orientation(a, b, c)
    };
    let on_face = |t: [u32; 3], f: FaceId| -> Option<f64> {
        let [a, b, c] = t.map(|u| cut.origin[disc.vertices[u as usize]].barycentric_in(mesh, f));
        let [a, b, c] = [a?, b?, c?].map(|b| DVec2::new(b[1], b[2]));
        Some((b - a).perp_dot(c - a))
    };
    let total: f64 = ring.iter().map(|(_, (t, _))| planar(*t)).sum();
    ring.iter().all(|(_, (t, f))| {
        let moved = t.map(|u| if u == v { w } else { u });
        let whole: f64 = ring.iter().filter(|(_, (_, g))| g == f).filter_map(|(_, (t, _))| on_face(*t, *f)).sum();
        let stays =
            || on_face(moved, *f).is_some_and(|x| x > LEAST_SHARE * whole) && planar(moved) > LEAST_SHARE * total;
        if t.contains(&w) { on_face([w; 3], *f).is_some() } else { stays() }
    })
}
