//! Stage: every patch of both meshes embedded in its base triangle.
//!
//! Input: a layout. Output: positions for every vertex of every patch, boundary vertices by arc length, free ones by
//! mean value weights re-weighted by stretch. Invariant: every triangle is exactly positively oriented.

use super::layout::Layout;
use crate::error::{Error, Result};
use crate::map::embedding::{EmbeddedMesh, Embedding};
use crate::mesh::{ArcId, Id, IdVec, PatchId, TriMesh, VertexId};
use crate::path::base_complex::BaseComplex;
use crate::path::cut_mesh::CutMesh;
use crate::plane::convex::{Weights, embed_patch, is_embedded};
use crate::plane::divide::split_dividing_edges;
use crate::plane::domain::Domain;
use crate::plane::newton::newton;
use crate::plane::patch_disc::{PatchDisc, arc_shares, patch_discs};
use crate::plane::smooth::Smoother;
use crate::plane::stretch::Frame;
use glam::DVec3;
use rayon::prelude::*;

/// Embeds both meshes; also returns what the user should know.
pub fn embed(meshes: [&TriMesh; 2], layout: Layout) -> Result<(Embedding, Vec<String>)> {
    faer::set_global_parallelism(faer::Par::Seq);
    let Layout { base, cuts: [source, target], .. } = layout;
    let (a, b) = rayon::join(|| cut_out(meshes[0], source, &base), || cut_out(meshes[1], target, &base));
    let mut embedded = [a?, b?];
    let frames = frames(&base, &embedded);
    let mut notes = Vec::new();
    for (mesh, name) in embedded.iter_mut().zip(["source", "target"]) {
        let uniform = embed_all(mesh, &frames)?;
        if uniform > 0 {
            notes.push(format!("{uniform} patches of the {name} have slivers and were embedded with uniform weights"));
        }
    }
    Ok((Embedding { base, meshes: embedded, frames }, notes))
}

fn cut_out(mesh: &TriMesh, mut cut: CutMesh, base: &BaseComplex) -> Result<EmbeddedMesh> {
    split_dividing_edges(&mut cut, mesh);
    let shares = arc_shares(&cut, base)?;
    let discs = patch_discs(&cut, base, &shares)?;
    Ok(EmbeddedMesh { cut, shares, discs })
}

/// Triangles whose sides are the arcs' lengths, each mesh's scaled to a mean of one, averaged over both meshes.
fn frames(base: &BaseComplex, meshes: &[EmbeddedMesh; 2]) -> IdVec<PatchId, Frame> {
    let mut lengths: IdVec<ArcId, f64> = IdVec::filled(0.0, base.arcs.len());
    for mesh in meshes {
        let own: Vec<f64> = base.arcs.iter_ids().map(|(a, ends)| arc_length(mesh, a, ends[0])).collect();
        let mean = own.iter().sum::<f64>() / own.len() as f64;
        lengths.raw.iter_mut().zip(own).for_each(|(sum, l)| *sum += l / mean);
    }
    base.patches.iter().map(|sides| Frame::with_sides(sides.map(|s| lengths[s.arc]))).collect()
}

fn arc_length(mesh: &EmbeddedMesh, arc: ArcId, first: crate::mesh::LandmarkId) -> f64 {
    mesh.cut.arc_path(arc, first).into_iter().map(|h| mesh.cut.length(h)).sum()
}

/// Embeds all patches of a mesh; returns how many needed uniform weights.
fn embed_all(mesh: &mut EmbeddedMesh, frames: &IdVec<PatchId, Frame>) -> Result<usize> {
    let EmbeddedMesh { cut, discs, .. } = mesh;
    let kinds: Vec<Option<Weights>> = discs
        .raw
        .par_iter_mut()
        .zip(&frames.raw)
        .map(|(disc, frame)| {
            let points: Vec<_> = disc.vertices.iter().map(|&v| cut.positions[v]).collect();
            let kind = embed_patch(disc, &points, frame)?;
            unfold(disc, frame, &|v| cut.positions[v]);
            Some(kind)
        })
        .collect();
    if let Some(p) = kinds.iter().position(Option::is_none) {
        return Err(Error::bug("a patch cannot be embedded in double precision").at(PatchId::new(p)));
    }
    Ok(kinds.iter().filter(|k| **k == Some(Weights::Uniform)).count())
}

/// Newton steps on an embedding before the meshes meet; limbs that the convex embedding crushed have room after these.
const UNFOLDING: usize = 8;

/// Lowers the symmetric Dirichlet energy of a patch against its flat frame; keeps it as it was if rounding spoils it.
fn unfold(disc: &mut PatchDisc, frame: &Frame, points: &dyn Fn(VertexId) -> DVec3) {
    let mut domain = Domain::of_patch(disc, points);
    let mut smoother = Smoother::flat(&mut domain, frame);
    for _ in 0..UNFOLDING {
        if !newton(&mut smoother) {
            break;
        }
    }
    if is_embedded(disc, &domain.positions) {
        disc.positions = domain.positions;
    }
}
