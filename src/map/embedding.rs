//! Both meshes embedded in the common base complex: the data a map is made of.

use crate::mesh::{FaceId, IdVec, LandmarkId, PatchId, SurfacePoint, TriMesh, VertexId};
use crate::path::base_complex::BaseComplex;
use crate::path::cut_mesh::CutMesh;
use crate::plane::patch_disc::{ArcShares, PatchDisc};
use crate::plane::stretch::Frame;

/// One mesh cut along its arcs, every patch embedded in the reference triangle.
#[derive(Clone, Debug)]
pub struct EmbeddedMesh {
    /// The cut mesh, without dividing edges.
    pub cut: CutMesh,
    /// The share of its arc at every vertex of every arc.
    pub shares: ArcShares,
    /// The patches.
    pub discs: IdVec<PatchId, PatchDisc>,
}

/// Both meshes over one base complex: the source, then the target.
#[derive(Clone, Debug)]
pub struct Embedding {
    /// The base complex.
    pub base: BaseComplex,
    /// The two meshes.
    pub meshes: [EmbeddedMesh; 2],
    /// The triangle in which the stretch of each patch is measured.
    pub frames: IdVec<PatchId, Frame>,
}

impl EmbeddedMesh {
    /// The positions in space of a patch's vertices.
    pub fn points(&self, p: PatchId) -> Vec<glam::DVec3> {
        self.discs[p].vertices.iter().map(|&v| self.cut.positions[v]).collect()
    }

    /// The point of the original mesh at the given weights of the corners of a face of the cut mesh.
    pub fn original_point(&self, mesh: &TriMesh, f: FaceId, weights: [f64; 3]) -> SurfacePoint {
        let corners = self.cut.corner_coordinates(mesh, f);
        let mixed: [f64; 3] = std::array::from_fn(|k| (0..3).map(|i| weights[i] * corners[i][k]).sum());
        let sum: f64 = mixed.iter().sum();
        SurfacePoint::from_barycentric(mesh, self.cut.face_origin[f], mixed.map(|x| x / sum))
    }

    /// The vertex of a landmark.
    pub fn landmark(&self, l: LandmarkId) -> VertexId {
        self.cut.landmarks[l]
    }
}
