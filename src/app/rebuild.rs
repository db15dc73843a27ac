//! Reads a geometry image of a finished map back as a mesh, from the file alone.
//!
//! The position image and the tile table in its attribute say everything: which pixels sample the same point, and how
//! patches meet. The mesh has one vertex for every sample of the atlas and two triangles for every cell of the grid. Its
//! texture coordinates are the places of its pixels, so every other image over the same atlas is a texture for it.

mod glued;
mod read;
mod sew;

pub use read::{Layer, PositionImage, RGB};
pub use sew::rebuild;

use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::mesh::io::{Attribute, MeshFile, write_obj};
use crate::stage::write::OutputFile;
use glam::DVec2;
use std::path::Path;

/// A mesh that a geometry image holds.
#[derive(Clone, Debug)]
pub struct Rebuilt {
    /// The mesh: closed if the surface is, with its genus, boundary loops and orientation.
    pub mesh: TriMesh,
    /// For every corner of its faces the place in the image, v up; a vertex that several tiles sample has one in each.
    pub uv: Attribute<DVec2>,
}

impl Rebuilt {
    /// Writes an OBJ file, which appears complete or not at all; positions are those of the pixels, exactly.
    ///
    /// # Errors
    /// Usage, if the path names no file; input, if the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let file = MeshFile { uv: self.uv.clone(), ..MeshFile::of(&self.mesh) };
        let folder = path.parent().unwrap_or(path);
        let mut out = OutputFile::create(path)?;
        write_obj(out.writer(), folder, &file, &file.positions).map_err(|e| Error::io(path, &e))?;
        out.commit()
    }
}
