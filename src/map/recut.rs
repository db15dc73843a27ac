//! Moves an arc of one mesh to where a relaxed domain says it runs, and cuts its two patches out again.

use super::embedding::EmbeddedMesh;
use crate::error::{Error, Result};
use crate::mesh::{ArcId, PatchId, TriMesh, VertexId};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::plane::convex::{embed_patch, is_embedded};
use crate::plane::diagonal::{Place, Segment};
use crate::plane::domain::{Domain, Placement};
use crate::plane::patch_disc::{PatchDisc, Scratch, on_grid, patch_disc};
use crate::plane::stretch::Frame;
use glam::DVec2;
use std::collections::HashMap;

/// The two patches at an arc: left of it, then right of it.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// The arc.
    pub arc: ArcId,
    /// The patches.
    pub patches: [PatchId; 2],
    /// How they lie in the domain.
    pub placements: [Placement; 2],
    /// Their frames.
    pub frames: [Frame; 2],
}

/// Moves the arc of `pair` onto `segment` and takes all positions from `domain`.
pub fn recut(
    mesh: &TriMesh,
    embedded: &mut EmbeddedMesh,
    base: &BaseComplex,
    pair: &Pair,
    domain: &Domain,
    segment: &Segment,
) -> Result<()> {
    let first = base.arcs[pair.arc][0];
    embedded.cut.unmark(pair.arc, first);
    let mut position: HashMap<VertexId, DVec2> =
        domain.vertices.iter().copied().zip(domain.positions.iter().copied()).collect();
    let mut vertices = Vec::with_capacity(segment.len());
    for &(place, x) in segment {
        let v = match place {
            Place::Vertex(v) => domain.vertices[v as usize],
            Place::Edge(a, b, t) => {
                let [a, b] = [a, b].map(|v| domain.vertices[v as usize]);
                let h = embedded.cut.conn.find(a, b).ok_or_else(|| lost(pair, a, b))?;
                embedded.cut.split_edge(mesh, h, t)
            }
        };
        position.insert(v, DVec2::new(x, 0.0));
        vertices.push(v);
    }
    for ends in vertices.windows(2) {
        let h = embedded.cut.conn.find(ends[0], ends[1]).ok_or_else(|| lost(pair, ends[0], ends[1]))?;
        embedded.cut.mark(h, DirectedArc { arc: pair.arc, reversed: false });
    }
    embedded.shares[pair.arc] = segment.iter().map(|&(_, x)| on_grid(x)).collect();
    let mut scratch = Scratch::default();
    for k in 0..2 {
        let disc = patch_disc(&embedded.cut, base, pair.patches[k], &embedded.shares, &mut scratch)?;
        embedded.discs[pair.patches[k]] = place_free(embedded, disc, pair, k, &position)?;
    }
    Ok(())
}

fn lost(pair: &Pair, a: VertexId, b: VertexId) -> Error {
    Error::bug("a relaxed arc leaves its domain").at(format!("{}, {a} to {b}", pair.arc))
}

/// Takes the positions of free vertices from the domain; where rounding spoils a triangle the patch is embedded anew.
fn place_free(
    embedded: &EmbeddedMesh,
    mut disc: PatchDisc,
    pair: &Pair,
    k: usize,
    position: &HashMap<VertexId, DVec2>,
) -> Result<PatchDisc> {
    for i in disc.boundary..disc.vertices.len() {
        let q = position.get(&disc.vertices[i]).ok_or_else(|| lost(pair, disc.vertices[i], disc.vertices[i]))?;
        disc.positions[i] = pair.placements[k].reference(*q);
    }
    if !is_embedded(&disc, &disc.positions) {
        let points: Vec<_> = disc.vertices.iter().map(|&v| embedded.cut.positions[v]).collect();
        embed_patch(&mut disc, &points, &pair.frames[k])
            .ok_or_else(|| Error::bug("a relaxed patch cannot be embedded").at(pair.patches[k]))?;
    }
    Ok(disc)
}
