//! A layout taken to a mesh with the same triangles, such as the same body in another pose: no arc has to be searched.

use super::trace::Traced;
use crate::error::Result;
use crate::mesh::{TriMesh, VertexId};
use crate::path::base_complex::DirectedArc;
use crate::path::cut_mesh::CutMesh;

/// Both meshes cut along the arcs, which pass the same places of the same faces; made alike, so that whatever is done to
/// both comes out alike on equal meshes.
///
/// None unless `meshes` have the same triangles and `landmarks` are the vertices the layout was traced between.
pub fn on_same_triangles(
    traced: &Traced,
    meshes: [&TriMesh; 2],
    landmarks: &[VertexId],
    edge_nodes: u32,
) -> Result<Option<[CutMesh; 2]>> {
    let [a, b] = meshes.map(|m| &m.conn);
    let same = a.face_count() == b.face_count() && a.faces().all(|f| a.face(f) == b.face(f));
    if !same || traced.cut.landmarks.raw != landmarks {
        return Ok(None);
    }
    Ok(Some([laid_on(&traced.cut, meshes[0], edge_nodes)?, laid_on(&traced.cut, meshes[1], edge_nodes)?]))
}

/// The same cuts on a mesh with the same triangles.
fn laid_on(cut: &CutMesh, mesh: &TriMesh, edge_nodes: u32) -> Result<CutMesh> {
    let faces: Vec<[VertexId; 3]> = cut.conn.faces().map(|f| cut.conn.face(f)).collect();
    let (origin, face_origin) = (cut.origin.raw.clone(), cut.face_origin.raw.clone());
    let mut over = CutMesh::assemble(mesh, &faces, origin, face_origin, &cut.landmarks.raw, edge_nodes)?;
    for h in cut.conn.halfedges() {
        if let Some(arc @ DirectedArc { reversed: false, .. }) = cut.arc_at(h) {
            over.mark(h, arc);
        }
    }
    Ok(over)
}
