//! Removes vertices that only the cut mesh has and that no arc needs any more.
//!
//! Every move of an arc leaves the vertices of its old way behind. Such a vertex is merged into a neighbour where that
//! leaves the original surface as it is (all triangles stay inside their original faces and keep their orientation
//! there), the embedding too (all triangles stay exactly positive), and the map nearly so (the energy of the ring).

use super::embedding::EmbeddedMesh;
use crate::error::{Error, Result};
use crate::mesh::{FaceId, Id, IdVec, PatchId, TriMesh, VertexId};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cut_mesh::CutMesh;
use crate::plane::domain::Domain;
use crate::plane::ground::{Above, Ground, least_area};
use crate::plane::orientation::orientation;
use crate::plane::overlay::Overlay;
use crate::plane::patch_disc::{PatchDisc, Scratch, patch_disc};
use glam::DVec2;
use rayon::prelude::*;
use std::collections::HashMap;

/// Every triangle made by a merge keeps at least this share of the ring's area, on the surface and in the plane.
const LEAST_SHARE: f64 = 1e-4;

/// A merge raises the energy of its ring at most by this share.
const MOST_RISE: f64 = 0.01;
/// Least edge nodes of the rebuilt cut mesh; no arc is traced on it any more.
const EDGE_NODES: u32 = 1;

/// A triangle of a patch, by local vertices, and the original face it is part of.
type Part = ([u32; 3], FaceId);

/// Removes what can be removed from all patches of the first mesh; the second one, relaxed against it, stays.
///
/// `scale` brings either mesh to unit area.
pub fn purge(
    meshes: [&TriMesh; 2],
    [embedded, other]: [&mut EmbeddedMesh; 2],
    base: &BaseComplex,
    scale: [f64; 2],
) -> Result<()> {
    let mesh = meshes[0];
    let thin = |p: PatchId| {
        let below = Domain::of_patch(&other.discs[p], &|v| other.cut.positions[v] * scale[1]);
        let ground = Ground::new(&below);
        let own = Domain::of_patch(&embedded.discs[p], &|v| embedded.cut.positions[v] * scale[0]);
        let floor = least_area(&own);
        Thinning { mesh, cut: &embedded.cut, disc: &embedded.discs[p], own: &own, floor, ground: &ground }.thin_out()
    };
    let patches: Vec<PatchId> = base.patches.ids().collect();
    let parts: Vec<Vec<Part>> = patches.into_par_iter().map(thin).collect();
    let (cut, number) = assemble(mesh, embedded, &parts)?;
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
    embedded.cut = cut;
    embedded.discs = discs;
    Ok(())
}

/// Builds the cut mesh from the remaining triangles; also returns the new number of every old vertex.
fn assemble(
    mesh: &TriMesh,
    embedded: &EmbeddedMesh,
    parts: &[Vec<Part>],
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
    let cut = CutMesh::assemble(mesh, &faces, origin, face_origin, &old.landmarks.raw, EDGE_NODES)?;
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

/// A patch that vertices are merged in.
struct Thinning<'a> {
    mesh: &'a TriMesh,
    cut: &'a CutMesh,
    disc: &'a PatchDisc,
    own: &'a Domain,
    /// Triangles of less area have no say.
    floor: f64,
    ground: &'a Ground<'a>,
}

impl Thinning<'_> {
    /// The triangles after merging all free vertices that can be merged.
    fn thin_out(&self) -> Vec<Part> {
        let disc = self.disc;
        let mut parts: Vec<Option<Part>> =
            disc.triangles.iter().zip(&disc.faces).map(|(&t, &f)| Some((t, self.cut.face_origin[f]))).collect();
        let mut around: Vec<Vec<u32>> = vec![Vec::new(); disc.vertices.len()];
        for (k, t) in (0u32..).zip(&disc.triangles) {
            t.iter().for_each(|&v| around[v as usize].push(k));
        }
        let mut overlay = self.ground.overlay();
        for v in disc.boundary..disc.vertices.len() {
            if disc.vertices[v].index() >= self.mesh.positions.len() {
                self.merge(v as u32, &mut parts, &mut around, &mut overlay);
            }
        }
        parts.into_iter().flatten().collect()
    }

    /// Merges `v` into the first neighbour that allows it.
    fn merge(&self, v: u32, parts: &mut [Option<Part>], around: &mut [Vec<u32>], overlay: &mut Overlay) {
        let ring: Vec<(u32, Part)> = around[v as usize].iter().filter_map(|&k| Some((k, parts[k as usize]?))).collect();
        let neighbours: Vec<u32> = ring.iter().map(|(_, (t, _))| after(t, v)).collect();
        let mut before = None;
        let into = neighbours.iter().copied().find(|&w| {
            let shared =
                |u: &u32| around[w as usize].iter().any(|&k| parts[k as usize].is_some_and(|(t, _)| t.contains(u)));
            let link = neighbours.iter().filter(|&&u| u != w && shared(&u)).count();
            if link != 2 || !self.keeps_shape(&ring, v, w) {
                return false;
            }
            let before = *before.get_or_insert_with(|| self.energy(&ring, v, v, overlay));
            self.energy(&ring, v, w, overlay) <= before * (1.0 + MOST_RISE)
        });
        let Some(w) = into else { return };
        for (k, (t, f)) in ring {
            if t.contains(&w) {
                parts[k as usize] = None;
            } else {
                parts[k as usize] = Some((redrawn(t, v, w), f));
                around[w as usize].push(k);
            }
        }
        around[v as usize].clear();
    }

    /// Energy of the ring of `v`, drawn to `w` instead.
    fn energy(&self, ring: &[(u32, Part)], v: u32, w: u32, overlay: &mut Overlay) -> f64 {
        let stays = |t: &[u32; 3]| v == w || !t.contains(&w);
        let one = |t: [u32; 3]| {
            let corners = redrawn(t, v, w);
            let above = Above::new(corners.map(|u| self.own.positions[u as usize]), self.own.spatial(&corners));
            if above.area > self.floor { self.ground.energy(overlay, &above) } else { 0.0 }
        };
        ring.iter().map(|(_, (t, _))| *t).filter(|t| stays(t)).map(one).sum()
    }

    /// True if the ring of `v`, drawn to `w` instead, stays inside the original faces and embedded.
    fn keeps_shape(&self, ring: &[(u32, Part)], v: u32, w: u32) -> bool {
        let Thinning { mesh, cut, disc, .. } = self;
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
            let moved = redrawn(*t, v, w);
            let whole: f64 = ring.iter().filter(|(_, (_, g))| g == f).filter_map(|(_, (t, _))| on_face(*t, *f)).sum();
            let stays =
                || on_face(moved, *f).is_some_and(|x| x > LEAST_SHARE * whole) && planar(moved) > LEAST_SHARE * total;
            if t.contains(&w) { on_face([w; 3], *f).is_some() } else { stays() }
        })
    }
}

/// The corner of `t` that follows `v`.
fn after(t: &[u32; 3], v: u32) -> u32 {
    let i = t.iter().position(|&u| u == v).unwrap_or(0);
    t[(i + 1) % 3]
}

/// The triangle with its corner `v` at `w`.
fn redrawn(t: [u32; 3], v: u32, w: u32) -> [u32; 3] {
    t.map(|u| if u == v { w } else { u })
}
