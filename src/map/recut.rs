//! Moves arcs of one mesh to where relaxed domains say they run, and cuts the patches out again.

use super::embedding::{EmbeddedMesh, Embedding};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, Id, IdVec, LandmarkId, PatchId, SurfacePoint, TriMesh, VertexId};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cut_mesh::CutMesh;
use crate::plane::convex::{embed_patch, is_embedded};
use crate::plane::domain::Domain;
use crate::plane::patch_disc::{PatchDisc, Scratch, on_grid, patch_disc};
use crate::plane::straighten::{Split, Straightened};
use crate::plane::stretch::Frame;
use crate::plane::tiling::{Placement, Tiling};
use glam::DVec2;
use rayon::prelude::*;
use std::collections::HashMap;

/// Least edge nodes of a rebuilt cut mesh; no arc is traced on it any more.
const EDGE_NODES: u32 = 1;

/// A relaxed domain of one mesh whose seams are straight again.
pub struct Relaxed {
    /// The domain.
    pub domain: Domain,
    /// How its seams run.
    pub straight: Straightened,
}

/// Writes the results of domains that share no patch into both meshes, side by side.
///
/// The base complex may have other arcs than the cut meshes where a domain holds all that differs.
pub fn recut_all(meshes: [&TriMesh; 2], embedding: &mut Embedding, relaxed: &[(&Tiling, &[Relaxed; 2])]) -> Result<()> {
    if relaxed.is_empty() {
        return Ok(());
    }
    let Embedding { base, meshes: embedded, frames } = embedding;
    let recut = |(k, old): (usize, &mut EmbeddedMesh)| {
        let changed: Vec<(&Tiling, &Relaxed)> = relaxed.iter().map(|(tiling, sides)| (*tiling, &sides[k])).collect();
        *old = Recut::new(meshes[k], old, base, &changed).finish(frames)?;
        Ok(())
    };
    let results: Vec<Result<()>> = embedded.par_iter_mut().enumerate().map(recut).collect();
    results.into_iter().collect()
}

/// A mesh that is cut anew.
struct Recut<'a> {
    mesh: &'a TriMesh,
    old: &'a EmbeddedMesh,
    base: &'a BaseComplex,
    changed: &'a [(&'a Tiling, &'a Relaxed)],
    /// Whether a patch lies in a relaxed domain.
    is_changed: IdVec<PatchId, bool>,
    /// The new number of every old vertex that is still needed.
    number: IdVec<VertexId, VertexId>,
    /// Where the new vertices lie.
    origin: Vec<SurfacePoint>,
    /// The new numbers of every relaxed domain's vertices.
    of_domain: Vec<Vec<VertexId>>,
}

impl<'a> Recut<'a> {
    fn new(
        mesh: &'a TriMesh,
        old: &'a EmbeddedMesh,
        base: &'a BaseComplex,
        changed: &'a [(&'a Tiling, &'a Relaxed)],
    ) -> Self {
        let mut is_changed = IdVec::filled(false, base.patches.len());
        changed.iter().flat_map(|(tiling, _)| &tiling.tiles).for_each(|tile| is_changed[tile.patch] = true);
        let mut recut = Recut {
            mesh,
            old,
            base,
            changed,
            is_changed,
            number: IdVec::filled(VertexId(u32::MAX), old.cut.conn.vertex_count()),
            origin: Vec::new(),
            of_domain: Vec::new(),
        };
        recut.number_old();
        recut.number_new();
        recut
    }

    /// Numbers the vertices that stay: all original ones, and those of arcs that stay.
    fn number_old(&mut self) {
        let mut used = IdVec::filled(false, self.number.len());
        used.raw[..self.mesh.positions.len()].fill(true);
        for (p, disc) in self.old.discs.iter_ids() {
            if !self.is_changed[p] {
                disc.vertices.iter().for_each(|&v| used[v] = true);
            }
        }
        for (_, Relaxed { domain, straight }) in self.changed {
            let kept = domain.vertices.len() - straight.splits.len();
            domain.vertices[..kept].iter().for_each(|&v| used[v] = true);
        }
        for v in self.old.cut.conn.vertices().filter(|&v| used[v]) {
            self.number[v] = VertexId::new(self.origin.len());
            self.origin.push(self.old.cut.origin[v]);
        }
    }

    /// Numbers the vertices that splits made.
    fn number_new(&mut self) {
        for (_, Relaxed { domain, straight }) in self.changed {
            let kept = domain.vertices.len() - straight.splits.len();
            let mut ids: Vec<VertexId> = domain.vertices[..kept].iter().map(|&v| self.number[v]).collect();
            for &Split { ends, share, face } in &straight.splits {
                let f = self.old.cut.face_origin[face];
                let [a, b] = ends.map(|v| {
                    let origin = self.origin[ids[v as usize].index()].barycentric_in(self.mesh, f);
                    origin.expect("the ends of an edge lie in the original face at its side")
                });
                let between = std::array::from_fn(|i| a[i] * (1.0 - share) + b[i] * share);
                ids.push(VertexId::new(self.origin.len()));
                self.origin.push(SurfacePoint::from_barycentric(self.mesh, f, between));
            }
            self.of_domain.push(ids);
        }
    }

    fn finish(self, frames: &IdVec<PatchId, Frame>) -> Result<EmbeddedMesh> {
        let Recut { old, base, changed, .. } = self;
        let (mut faces, mut face_origin) = (Vec::new(), Vec::new());
        let mut discs = old.discs.clone();
        for p in base.patches.ids().filter(|&p| !self.is_changed[p]) {
            let disc = &mut discs[p];
            disc.vertices.iter_mut().for_each(|v| *v = self.number[*v]);
            for (t, f) in disc.triangles.iter().zip(&mut disc.faces) {
                face_origin.push(old.cut.face_origin[*f]);
                *f = FaceId::new(faces.len());
                faces.push(t.map(|v| disc.vertices[v as usize]));
            }
        }
        for ((_, Relaxed { domain, .. }), ids) in changed.iter().zip(&self.of_domain) {
            faces.extend(domain.triangles.iter().map(|t| t.map(|v| ids[v as usize])));
            face_origin.extend(domain.faces.iter().map(|&f| old.cut.face_origin[f]));
        }
        let (ways, shares) = self.arcs();
        let landmarks = &old.cut.landmarks.raw;
        let mut cut = CutMesh::assemble(self.mesh, &faces, self.origin, face_origin, landmarks, EDGE_NODES)?;
        for (arc, way) in ways.iter_ids() {
            for ends in way.windows(2) {
                let h = cut.conn.find(ends[0], ends[1]).ok_or_else(|| lost(ends[0], ends[1]))?;
                cut.mark(h, DirectedArc { arc, reversed: false });
            }
        }
        let mut scratch = Scratch::default();
        for ((tiling, Relaxed { domain, .. }), ids) in changed.iter().zip(&self.of_domain) {
            let position: HashMap<VertexId, DVec2> =
                ids.iter().copied().zip(domain.positions.iter().copied()).collect();
            for tile in &tiling.tiles {
                let disc = patch_disc(&cut, base, tile.patch, &shares, &mut scratch)?;
                let placement = tiling.placement(tile);
                discs[tile.patch] = place_free(&cut, disc, &placement, &frames[tile.patch], &position)?;
            }
        }
        Ok(EmbeddedMesh { cut, shares, discs })
    }

    /// The vertices of every arc, and their shares of its length.
    fn arcs(&self) -> (IdVec<ArcId, Vec<VertexId>>, IdVec<ArcId, Vec<f64>>) {
        let mut shares = self.old.shares.clone();
        let cut = &self.old.cut;
        let mut is_moved = IdVec::filled(false, self.base.arcs.len());
        self.changed.iter().flat_map(|(tiling, _)| &tiling.seams).for_each(|seam| is_moved[seam.arc] = true);
        let way = |(arc, ends): (ArcId, &[LandmarkId; 2])| {
            if is_moved[arc] {
                return Vec::new();
            }
            let first = std::iter::once(cut.landmarks[ends[0]]);
            let path = first.chain(cut.arc_path(arc, ends[0]).into_iter().map(|h| cut.conn.to(h)));
            path.map(|v| self.number[v]).collect()
        };
        let mut ways: IdVec<ArcId, Vec<VertexId>> = self.base.arcs.iter_ids().map(way).collect();
        for ((tiling, Relaxed { straight, .. }), ids) in self.changed.iter().zip(&self.of_domain) {
            for (seam, way) in tiling.seams.iter().zip(&straight.seams) {
                ways[seam.arc] = way.iter().map(|&(v, _)| ids[v as usize]).collect();
                shares[seam.arc] = way.iter().map(|&(_, share)| on_grid(share)).collect();
            }
        }
        (ways, shares)
    }
}

fn lost(a: VertexId, b: VertexId) -> Error {
    Error::bug("a relaxed arc leaves its domain").at(format!("{a} to {b}"))
}

/// Takes the positions of free vertices from the domain; where rounding spoils a triangle the patch is embedded anew.
fn place_free(
    cut: &CutMesh,
    mut disc: PatchDisc,
    placement: &Placement,
    frame: &Frame,
    position: &HashMap<VertexId, DVec2>,
) -> Result<PatchDisc> {
    for i in disc.boundary..disc.vertices.len() {
        let q = position.get(&disc.vertices[i]).ok_or_else(|| lost(disc.vertices[i], disc.vertices[i]))?;
        disc.positions[i] = placement.reference(*q);
    }
    if !is_embedded(&disc, &disc.positions) {
        let points: Vec<_> = disc.vertices.iter().map(|&v| cut.positions[v]).collect();
        embed_patch(&mut disc, &points, frame).ok_or_else(|| Error::bug("a relaxed patch cannot be embedded"))?;
    }
    Ok(disc)
}
