//! A mesh divided along the arcs of the layout, in terms of its file: what shows which patch a point lies in.

use super::embedding::EmbeddedMesh;
use crate::mesh::{Canonical, FaceId, Id, IdVec, PatchId, SurfacePoint, VertexId};

/// Triangles of which each lies in one face of a mesh and in one patch.
#[derive(Clone, Debug, Default)]
pub struct Divided {
    /// Where every vertex lies; the first ones are the mesh's own.
    pub places: IdVec<VertexId, SurfacePoint>,
    /// The triangles.
    pub triangles: Vec<[VertexId; 3]>,
    /// The face of the mesh that each triangle lies in.
    pub faces: Vec<FaceId>,
    /// The patch that each triangle lies in.
    pub patches: Vec<PatchId>,
}

impl Divided {
    /// Reads an embedded mesh; `canonical` leads back to the file's order.
    pub fn new(embedded: &EmbeddedMesh, canonical: &Canonical) -> Self {
        let cut = &embedded.cut;
        let own = canonical.mesh.positions.len();
        let there = |v: VertexId| if v.index() < own { canonical.vertex_there(v) } else { v };
        let mut places = IdVec::filled(SurfacePoint::Vertex(VertexId(0)), cut.origin.len());
        for (v, &origin) in cut.origin.iter_ids() {
            places[there(v)] = canonical.point_there(origin);
        }
        let mut divided = Divided { places, ..Divided::default() };
        for (patch, disc) in embedded.discs.iter_ids() {
            for &f in &disc.faces {
                divided.triangles.push(cut.conn.face(f).map(there));
                divided.faces.push(canonical.face_there(cut.face_origin[f]));
                divided.patches.push(patch);
            }
        }
        divided
    }
}
