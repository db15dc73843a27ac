//! A mesh with the common atlas as its texture coordinates.

use super::destination::AtlasPlaces;
use crate::map::atlas::Atlas;
use crate::map::embedding::EmbeddedMesh;
use crate::mesh::io::MeshFile;
use crate::mesh::{Canonical, VertexId};

/// The mesh cut along the arcs: its surface, its vertices in their order and behind them those on the arcs, with places in
/// the atlas as texture coordinates. `canonical` is the order that it was embedded in.
pub fn atlas_mesh(embedded: &EmbeddedMesh, file: &MeshFile, canonical: &Canonical, atlas: &Atlas) -> MeshFile {
    let own = file.positions.len();
    let there = |v: VertexId| if (v.0 as usize) < own { canonical.vertex_there(v).0 } else { v.0 };
    let mut mesh = MeshFile { path: file.path.clone(), positions: file.positions.clone(), ..MeshFile::default() };
    mesh.positions.extend(&embedded.cut.positions.raw[own..]);
    let places = AtlasPlaces::new(atlas, embedded.discs.len());
    for (p, disc) in embedded.discs.iter_ids() {
        let first = mesh.uv.values.len() as u32;
        mesh.uv.values.extend(disc.positions.iter().map(|&at| places.uv(p, at)));
        for triangle in &disc.triangles {
            mesh.push_polygon(triangle.map(|v| there(disc.vertices[v as usize])));
            mesh.uv.corners.extend(triangle.map(|v| first + v));
        }
    }
    mesh
}
