//! glTF 2.0: a reader of `.gltf` with embedded or separate buffers and of `.glb`, and a writer of morphs as `.glb`.
//!
//! Read are the triangles of all meshes in the scene, each placed by its node, one after the other in the order in which
//! the nodes are met from the scene's roots downwards. Within a mesh, primitives that share their positions share vertices;
//! every other primitive brings vertices of its own. So vertices keep the order of their accessors, and none is merged:
//! most exporters double the vertices along seams of normals or texture coordinates, which leaves the surface cut open
//! there, and a warning says so. Skins, morph targets, points and lines are left out.
//! What is written keeps the order of the vertices as well: [`write_morph`].
//!
//! Source: Khronos, "glTF 2.0 Specification", 2021.

mod accessor;
mod chunks;
mod document;
mod morph;
mod scene;
mod seams;
mod texture_image;

pub use morph::{Morph, MorphTarget, MorphedMesh, write_morph};
pub use texture_image::TextureImage;

use super::mesh_file::{Attribute, MeshFile, NO_INDEX};
use crate::{Error, Result};
use accessor::{Buffers, percent_decoded};
use document::{Document, Primitive};
use glam::{DMat4, DVec2, DVec3};
use scene::placed_meshes;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Remedy for content that breaks the format's rules.
const AGAIN: &str = "export the file again";
/// First bytes of a binary file.
const MAGIC: &[u8] = b"glTF";

/// True for the first bytes of a binary file.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// True for JSON that can be a glTF document.
pub(super) fn is_document(bytes: &[u8]) -> bool {
    let window = |word: &[u8]| bytes.windows(word.len()).any(|w| w == word);
    bytes.trim_ascii_start().starts_with(b"{") && window(b"\"asset\"") && window(b"\"meshes\"")
}

/// The separate files of buffers that a document in a folder names; none if it is no glTF or cannot be read.
pub(super) fn buffer_files(bytes: &[u8], folder: &Path) -> Vec<PathBuf> {
    let json =
        if is_binary(bytes) { chunks(bytes).ok().map(|(json, _)| json) } else { is_document(bytes).then_some(bytes) };
    let document = json.and_then(|json| Document::parse(json).ok());
    let uris = document.into_iter().flat_map(|d| d.buffers).filter_map(|buffer| buffer.uri);
    uris.filter(|uri| !uri.starts_with("data:")).map(|uri| folder.join(percent_decoded(&uri))).collect()
}

/// Parses a file; separate buffers are read from its folder.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<MeshFile> {
    let (json, binary) = if is_binary(bytes) { chunks(bytes)? } else { (bytes, None) };
    let document = Document::parse(json)?;
    let buffers = Buffers::open(&document, path.parent().unwrap_or(Path::new("")), binary)?;
    let mut reader = Reader { document: &document, buffers, mesh: MeshFile::default(), left_out: 0 };
    for placed in placed_meshes(&document)? {
        reader.add_mesh(placed.mesh, placed.transform).map_err(|e| match e.element.is_empty() {
            true => e.at(format_args!("mesh {}", placed.mesh)),
            false => e,
        })?;
    }
    Ok(reader.finish())
}

/// The JSON chunk of a binary file and, if there is one, the binary chunk.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>)> {
    let cut = || {
        Error::input("the file ends inside a chunk").at("GLB header").remedy("the file is cut short: export it again")
    };
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    if word(4) != Some(2) {
        return Err(Error::input("not version 2 of binary glTF").at("GLB header").remedy("export it as glTF 2.0"));
    }
    let chunk = |at: usize| {
        let length = word(at)? as usize;
        bytes.get(at + 8..at.checked_add(8)?.checked_add(length)?)
    };
    let json = chunk(12).ok_or_else(cut)?;
    let next = 20 + json.len();
    Ok((json, if next < bytes.len() { Some(chunk(next).ok_or_else(cut)?) } else { None }))
}

/// A mesh file under construction.
struct Reader<'a> {
    document: &'a Document,
    buffers: Buffers<'a>,
    mesh: MeshFile,
    /// Primitives that are not triangles.
    left_out: usize,
}

impl Reader<'_> {
    fn add_mesh(&mut self, mesh: usize, transform: DMat4) -> Result<()> {
        let mut first_vertex = HashMap::new();
        let missing = || Error::input(format!("mesh {mesh} does not exist")).remedy(AGAIN);
        for primitive in &self.document.meshes.get(mesh).ok_or_else(missing)?.primitives {
            let Some(&positions) = primitive.attributes.get("POSITION").filter(|_| primitive.is_surface()) else {
                self.left_out += 1;
                continue;
            };
            let first = match first_vertex.get(&positions) {
                Some(&first) => first,
                None => *first_vertex.entry(positions).or_insert(self.add_vertices(positions, transform)?),
            };
            self.add_faces(primitive, first, transform)?;
        }
        Ok(())
    }

    /// Appends the vertices of an accessor; returns the number of the first.
    fn add_vertices(&mut self, accessor: usize, transform: DMat4) -> Result<usize> {
        let first = self.mesh.positions.len();
        for (i, p) in self.buffers.read::<3>(accessor)?.into_iter().enumerate() {
            let p = transform.transform_point3(DVec3::from_array(p));
            if !p.is_finite() {
                let place = format!("accessor {accessor}, element {i}");
                return Err(Error::input("a coordinate is not a finite number")
                    .at(place)
                    .remedy("correct or delete the vertex"));
            }
            self.mesh.positions.push(p);
        }
        Ok(first)
    }

    fn add_faces(&mut self, primitive: &Primitive, first: usize, transform: DMat4) -> Result<()> {
        let count = self.buffers.count(primitive.attributes["POSITION"])?;
        let indices = match primitive.indices {
            Some(accessor) => self.buffers.indices(accessor, count)?,
            None => (0..count as u32).collect(),
        };
        let uv = self.attribute::<2>(primitive, "TEXCOORD_0", count)?;
        let normals = self.attribute::<3>(primitive, "NORMAL", count)?;
        let to_normals = transform.inverse().transpose();
        let uv = append(&mut self.mesh.uv, uv.into_iter().map(|[u, v]| DVec2::new(u, 1.0 - v)));
        let turned = |n: [f64; 3]| to_normals.transform_vector3(DVec3::from_array(n)).normalize_or(DVec3::Z);
        let normals = append(&mut self.mesh.normals, normals.into_iter().map(turned));
        let is_mirrored = transform.determinant() < 0.0;
        for mut triangle in primitive.triangles(&indices) {
            if is_mirrored {
                triangle.swap(1, 2);
            }
            self.mesh.push_polygon(triangle.map(|i| first as u32 + i));
            self.mesh.uv.corners.extend(triangle.map(|i| uv.map_or(NO_INDEX, |first| first + i)));
            self.mesh.normals.corners.extend(triangle.map(|i| normals.map_or(NO_INDEX, |first| first + i)));
        }
        Ok(())
    }

    /// The values of an attribute, one per vertex, or none.
    fn attribute<const N: usize>(&self, primitive: &Primitive, name: &str, count: usize) -> Result<Vec<[f64; N]>> {
        let Some(&accessor) = primitive.attributes.get(name) else { return Ok(Vec::new()) };
        let values = self.buffers.read::<N>(accessor)?;
        let place = format!("accessor {accessor}");
        if values.len() != count {
            let what = format!("{} values of {name} for {count} vertices", values.len());
            return Err(Error::input(what).at(place).remedy(AGAIN));
        }
        if !values.iter().flatten().all(|x| x.is_finite()) {
            return Err(Error::input(format!("a value of {name} is not a finite number")).at(place).remedy(AGAIN));
        }
        Ok(values)
    }

    fn finish(mut self) -> MeshFile {
        let mesh = &mut self.mesh;
        if mesh.uv.values.is_empty() {
            mesh.uv.corners.clear();
        }
        if mesh.normals.values.is_empty() {
            mesh.normals.corners.clear();
        }
        if self.left_out > 0 {
            mesh.warnings.push(format!("{} primitives without triangles were left out", self.left_out));
        }
        if !mesh.uv.values.is_empty() || !mesh.normals.values.is_empty() {
            let note = "glTF doubles vertices along seams of normals and texture coordinates; they are kept apart, so the \
                        surface may be cut open there";
            mesh.warnings.push(note.to_owned());
        }
        self.mesh
    }
}

/// Appends values; returns the number of the first, unless there are none.
fn append<T>(attribute: &mut Attribute<T>, values: impl ExactSizeIterator<Item = T>) -> Option<u32> {
    let first = attribute.values.len() as u32;
    let some = values.len() > 0;
    attribute.values.extend(values);
    some.then_some(first)
}
