//! Vertices in the sense of glTF, where each has one texture coordinate.

use crate::mesh::io::mesh_file::MeshFile;
use std::collections::HashMap;

/// A mesh's vertices, doubled where texture coordinates differ.
#[derive(Debug, Default, PartialEq)]
pub struct SplitVertices {
    /// The mesh's vertex for every vertex here: `i` for `i` below the mesh's number of vertices, then the copies.
    pub origin: Vec<u32>,
    /// Texture coordinates in glTF's convention, v down, one per vertex; empty if the mesh has none.
    pub uv: Vec<[f32; 2]>,
    /// The triangles, three vertices each.
    pub indices: Vec<u32>,
}

/// Gives every vertex one texture coordinate.
///
/// The first one that a vertex has in the order of the faces stays with it; a copy for each other one is appended behind
/// all vertices, in that order. Vertices and corners without a coordinate get (0, 0).
pub fn split_at_seams(mesh: &MeshFile) -> SplitVertices {
    let corners = mesh.triangle_corners().flatten();
    let mut split = SplitVertices { origin: (0..mesh.positions.len() as u32).collect(), ..SplitVertices::default() };
    if mesh.uv.values.is_empty() {
        split.indices = corners.map(|c| mesh.corners[c].0).collect();
        return split;
    }
    let mut taken = vec![false; split.origin.len()];
    let mut copies = HashMap::new();
    split.uv = vec![[0.0; 2]; split.origin.len()];
    for c in corners {
        let (v, uv) = (mesh.corners[c].0, uv_at(mesh, c));
        let first = &mut split.uv[v as usize];
        if !std::mem::replace(&mut taken[v as usize], true) {
            *first = uv;
        }
        let vertex = if *first == uv { v } else { split.copy(v, uv, &mut copies) };
        split.indices.push(vertex);
    }
    split
}

/// The copy of a vertex with the bits of a texture coordinate.
type Copies = HashMap<(u32, [u32; 2]), u32>;

impl SplitVertices {
    fn copy(&mut self, v: u32, uv: [f32; 2], copies: &mut Copies) -> u32 {
        *copies.entry((v, uv.map(f32::to_bits))).or_insert_with(|| {
            self.origin.push(v);
            self.uv.push(uv);
            self.origin.len() as u32 - 1
        })
    }
}

/// Zero has one sign, so that equal coordinates have equal bits.
fn uv_at(mesh: &MeshFile, corner: usize) -> [f32; 2] {
    mesh.uv.at(corner).map_or([0.0; 2], |uv| [uv.x as f32 + 0.0, (1.0 - uv.y) as f32 + 0.0])
}
