//! Mesh, landmark and hint files.
//!
//! The readers are strict: whatever is not understood is an error that names file, place and remedy, and what comes out
//! has the vertices of the file in their order. The format is chosen by extension, then by content.

mod companions;
pub mod constraints;
mod gltf;
pub mod hint;
pub mod landmarks;
mod library_path;
pub mod materials;
pub mod mesh_file;
mod normals;
mod obj;
mod obj_block;
pub mod obj_write;
mod off;
mod off_binary;
mod ply;
mod regions;
mod scan;
mod stl;
pub mod vertex_table;

pub use companions::companions;
pub use constraints::{Constraint, read_constraints};
pub use gltf::{Morph, MorphTarget, MorphedMesh, TextureImage, write_morph};
pub use hint::{Hint, HintLoop, parse_hint, read_hint};
pub use landmarks::{Landmarks, parse_landmarks, read_landmarks, split_fields};
pub use mesh_file::{Attribute, Keyword, MeshFile, NO_INDEX, Statement};
pub use normals::vertex_normals;
pub use obj_write::write_obj;
pub use regions::{Region, Regions, SIDES, parse_regions, read_regions};
pub use vertex_table::{VertexTable, read_vertex_table, write_vertex_table};

use crate::{Error, Result};
use scan::Scanner;
use std::path::Path;

/// The mesh formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Gltf,
    Obj,
    Off,
    Ply,
    Stl,
}

/// Reads a mesh file: OBJ, OFF, PLY, STL or glTF.
pub fn read_mesh(path: &Path) -> Result<MeshFile> {
    let bytes = read_bytes(path)?;
    let parsed = parse_mesh(path, &bytes).map_err(|e| e.file(path))?;
    Ok(MeshFile { path: path.to_owned(), ..parsed })
}

/// Parses the bytes of a mesh file; `path` serves to choose the format and to find a glTF file's buffers.
pub fn parse_mesh(path: &Path, bytes: &[u8]) -> Result<MeshFile> {
    if bytes.trim_ascii().is_empty() {
        return Err(Error::input("the file is empty").remedy("export the mesh again"));
    }
    let text = plain_text(bytes)?;
    let mesh = match format_of(path, text)? {
        Format::Gltf => gltf::parse(path, text),
        Format::Obj => obj::parse(text),
        Format::Off => off::parse(text),
        Format::Ply => ply::parse(text),
        Format::Stl => stl::parse(bytes),
    }?;
    mesh.check_size()?;
    Ok(mesh)
}

/// The bytes of a file.
fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|e| Error::io(path, &e))
}

/// Drops a UTF-8 byte-order mark; refuses UTF-16.
fn plain_text(bytes: &[u8]) -> Result<&[u8]> {
    if let [0xff, 0xfe, _, 0, ..] | [0xfe, 0xff, 0, ..] = bytes {
        return Err(Error::input("the file is UTF-16 text").remedy("save it as UTF-8 or ASCII"));
    }
    Ok(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

fn format_of(path: &Path, bytes: &[u8]) -> Result<Format> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("gltf" | "glb") => Ok(Format::Gltf),
        Some("obj") => Ok(Format::Obj),
        Some("off" | "coff" | "noff" | "cnoff") => Ok(Format::Off),
        Some("ply") => Ok(Format::Ply),
        Some("stl" | "stla" | "stlb") => Ok(Format::Stl),
        _ => format_by_content(bytes).ok_or_else(|| {
            Error::input("unknown mesh format").remedy("use OBJ, OFF, PLY, STL or glTF, with that extension")
        }),
    }
}

fn format_by_content(bytes: &[u8]) -> Option<Format> {
    if gltf::is_binary(bytes) || gltf::is_document(bytes) {
        return Some(Format::Gltf);
    }
    if stl::is_binary(bytes) {
        return Some(Format::Stl);
    }
    let mut scan = Scanner::new(bytes);
    scan.next_line();
    let word = scan.field()?;
    match word {
        b"ply" => Some(Format::Ply),
        b"solid" => Some(Format::Stl),
        _ if word.ends_with(b"OFF") => Some(Format::Off),
        _ if obj_block::is_keyword(word) => Some(Format::Obj),
        _ => None,
    }
}
