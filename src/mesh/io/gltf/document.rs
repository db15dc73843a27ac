//! The JSON part of a glTF file, as far as triangles need it.

use super::AGAIN;
use crate::{Error, Result};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Extensions without which the triangles are the same.
const HARMLESS: [&str; 3] = ["KHR_mesh_quantization", "KHR_texture_transform", "EXT_texture_webp"];

/// The document.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Document {
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<BufferView>,
    pub buffers: Vec<Buffer>,
    pub extensions_required: Vec<String>,
}

/// Root nodes.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Scene {
    pub nodes: Vec<usize>,
}

/// A place in space, relative to its parent: a matrix by columns, or scaling, then rotation, then translation.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Node {
    pub mesh: Option<usize>,
    pub children: Vec<usize>,
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
}

/// A mesh.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Mesh {
    pub primitives: Vec<Primitive>,
}

/// A part of a mesh with one material.
#[derive(Debug, Deserialize)]
pub struct Primitive {
    #[serde(default)]
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    #[serde(default = "triangles")]
    mode: u32,
}

/// The number of the mode of separate triangles.
const fn triangles() -> u32 {
    4
}

/// Typed values in a buffer view.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: usize,
    pub component_type: u32,
    #[serde(default)]
    pub normalized: bool,
    pub count: usize,
    #[serde(rename = "type")]
    pub shape: String,
    pub sparse: Option<serde_json::Value>,
}

/// A part of a buffer.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct BufferView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: Option<usize>,
}

/// Where bytes come from; without a URI from the file's binary chunk.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Buffer {
    pub uri: Option<String>,
}

impl Document {
    /// Parses the JSON; refuses documents that other extensions change.
    pub fn parse(json: &[u8]) -> Result<Document> {
        let document: Document = serde_json::from_slice(json).map_err(|e| {
            let place = format!("line {}, column {} of the JSON", e.line(), e.column());
            Error::input(format!("not a glTF 2.0 document: {e}")).at(place).remedy(AGAIN)
        })?;
        match document.extensions_required.iter().find(|name| !HARMLESS.contains(&name.as_str())) {
            Some(name) => Err(Error::input(format!("the file needs the extension {name}"))
                .at("extensionsRequired")
                .remedy("export it without compression and extensions")),
            None => Ok(document),
        }
    }
}

impl Primitive {
    /// True for triangles, strips and fans.
    pub fn is_surface(&self) -> bool {
        (4..=6).contains(&self.mode)
    }

    /// The triangles over a list of indices.
    pub fn triangles(&self, indices: &[u32]) -> Vec<[u32; 3]> {
        let windows = indices.windows(3).map(|w| [w[0], w[1], w[2]]);
        match self.mode {
            5 => windows.zip([false, true].into_iter().cycle()).map(|(t, odd)| strip_triangle(t, odd)).collect(),
            6 => windows.map(|[_, b, c]| [indices[0], b, c]).collect(),
            _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        }
    }
}

/// Every second triangle of a strip runs the other way round.
fn strip_triangle([a, b, c]: [u32; 3], odd: bool) -> [u32; 3] {
    if odd { [b, a, c] } else { [a, b, c] }
}
