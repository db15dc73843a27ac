//! Rebuilds a mesh from a geometry image: a regular grid per patch, sewn along the arcs by the tile table.
//!
//! Borders are sewn by number, never by position, so the mesh is closed wherever the base complex is. A base complex may
//! have patches that meet themselves or each other along several arcs; near landmarks with one or two arcs the grid then
//! has edges with common ends, which a triangle mesh cannot tell apart. Such edges are split at their midpoints.

use super::exr::FloatImage;
use crate::error::{Error, Result};
use crate::map::atlas::{Atlas, BaseSample, Pixel};
use crate::map::base_complex::BaseComplex;
use crate::mesh::{Id, TriMesh, VertexId};
use glam::DVec3;

/// Marks a missing twin, vertex or slot.
const NONE: usize = usize::MAX;

/// Rounds of splitting before the search for edges with common ends is called endless. Two barycentric subdivisions
/// make any triangulation simplicial, and a round splits at least as much where it matters.
const MAX_ROUNDS: usize = 16;

/// The mesh that a position image holds; watertight if the base complex is closed, with its Euler characteristic.
///
/// Every patch becomes `steps^2` triangles. Vertices appear tile by tile, each at its first pixel.
///
/// # Errors
/// Input, if the image has not the atlas's size, lacks a channel, or two pixels of one place on an arc differ.
pub fn rebuild(image: &FloatImage, atlas: &Atlas, base: &BaseComplex) -> Result<TriMesh> {
    let pixels = image.rgb_pixels().ok_or_else(|| Error::input("the image lacks channel R, G or B"))?;
    if (image.width, image.height) != (atlas.width(), atlas.height()) {
        let what = format!("{} x {} pixels do not fit the tile table", image.width, image.height);
        return Err(Error::input(what).remedy("write the geometry image again"));
    }
    let mut sewing = Sewing::new(atlas, base);
    for (tile, entry) in atlas.tiles.iter().enumerate() {
        for (corner, half) in entry.halves() {
            let pixel_at = |coords| atlas.pixel(tile, corner, half, coords);
            sewing.add_patch(&Patch { base, sides: base.patches[half.patch], pixel_at: &pixel_at }, atlas, &pixels)?;
        }
    }
    let mut glued = sewing.glued;
    glued.separate_edges()?;
    let faces: Vec<[VertexId; 3]> = glued.tip.as_chunks::<3>().0.iter().map(|face| face.map(VertexId::new)).collect();
    TriMesh::new(glued.positions, &faces).map_err(|fault| Error::bug(format!("the mesh is not sewn up: {fault:?}")))
}
