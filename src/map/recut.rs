//! Moves arcs of one mesh to where a relaxed domain says they run, and cuts the patches out again.

use super::embedding::{EmbeddedMesh, Embedding};
use crate::error::{Error, Result};
use crate::mesh::{IdVec, PatchId, TriMesh, VertexId};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::plane::convex::{embed_patch, is_embedded};
use crate::plane::domain::Domain;
use crate::plane::patch_disc::{PatchDisc, Scratch, on_grid, patch_disc};
use crate::plane::straighten::Straightened;
use crate::plane::stretch::Frame;
use crate::plane::tiling::{Placement, Tiling};
use glam::DVec2;
use rayon::prelude::*;
use std::collections::HashMap;

/// A relaxed domain of one mesh whose seams are straight again.
pub struct Relaxed {
    /// The domain.
    pub domain: Domain,
    /// How its seams run.
    pub straight: Straightened,
}

/// Writes the results of domains that share no patch into both meshes, side by side.
pub fn recut_all(
    meshes: [&TriMesh; 2],
    embedding: &mut Embedding,
    tilings: &[Tiling],
    relaxed: &[Option<[Relaxed; 2]>],
) -> Result<()> {
    let Embedding { base, meshes: embedded, frames } = embedding;
    let write = |(k, mesh): (usize, &mut EmbeddedMesh)| {
        for (tiling, result) in tilings.iter().zip(relaxed) {
            if let Some(sides) = result {
                recut(meshes[k], mesh, base, frames, tiling, &sides[k])?;
            }
        }
        Ok(())
    };
    let results: Vec<Result<()>> = embedded.par_iter_mut().enumerate().map(write).collect();
    results.into_iter().collect()
}

/// Moves the seams of `tiling` and takes all positions from the relaxed domain.
fn recut(
    mesh: &TriMesh,
    embedded: &mut EmbeddedMesh,
    base: &BaseComplex,
    frames: &IdVec<PatchId, Frame>,
    tiling: &Tiling,
    Relaxed { domain, straight }: &Relaxed,
) -> Result<()> {
    for seam in &tiling.seams {
        embedded.cut.unmark(seam.arc, base.arcs[seam.arc][0]);
    }
    let vertices = replay(mesh, embedded, domain, straight)?;
    for (seam, way) in tiling.seams.iter().zip(&straight.seams) {
        for ends in way.windows(2) {
            let [a, b] = [ends[0].0, ends[1].0].map(|v| vertices[v as usize]);
            let h = embedded.cut.conn.find(a, b).ok_or_else(|| lost(a, b))?;
            embedded.cut.mark(h, DirectedArc { arc: seam.arc, reversed: false });
        }
        embedded.shares[seam.arc] = way.iter().map(|&(_, share)| on_grid(share)).collect();
    }
    let position: HashMap<VertexId, DVec2> = vertices.into_iter().zip(domain.positions.iter().copied()).collect();
    let mut scratch = Scratch::default();
    for tile in &tiling.tiles {
        let disc = patch_disc(&embedded.cut, base, tile.patch, &embedded.shares, &mut scratch)?;
        let placed = place_free(embedded, disc, &tiling.placement(tile), &frames[tile.patch], &position)?;
        embedded.discs[tile.patch] = placed;
    }
    Ok(())
}

/// Splits the edges of the cut mesh that were split in the domain; returns the mesh's vertex of every domain vertex.
fn replay(
    mesh: &TriMesh,
    embedded: &mut EmbeddedMesh,
    domain: &Domain,
    straight: &Straightened,
) -> Result<Vec<VertexId>> {
    let mut vertices = domain.vertices.clone();
    let first = vertices.len() - straight.splits.len();
    for (k, &(a, b, t)) in straight.splits.iter().enumerate() {
        let [a, b] = [a, b].map(|v| vertices[v as usize]);
        let h = embedded.cut.conn.find(a, b).ok_or_else(|| lost(a, b))?;
        vertices[first + k] = embedded.cut.split_edge(mesh, h, t);
    }
    Ok(vertices)
}

fn lost(a: VertexId, b: VertexId) -> Error {
    Error::bug("a relaxed arc leaves its domain").at(format!("{a} to {b}"))
}

/// Takes the positions of free vertices from the domain; where rounding spoils a triangle the patch is embedded anew.
fn place_free(
    embedded: &EmbeddedMesh,
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
        let points: Vec<_> = disc.vertices.iter().map(|&v| embedded.cut.positions[v]).collect();
        embed_patch(&mut disc, &points, frame).ok_or_else(|| Error::bug("a relaxed patch cannot be embedded"))?;
    }
    Ok(disc)
}
