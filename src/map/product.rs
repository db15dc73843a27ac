//! Everything that is written out about a finished map, as references to what the stages made.

use super::base_complex::BaseComplex;
use super::distortion::{Distortion, distortion};
use super::flips::flips_on_target;
use super::report::{Certificate, LayoutSummary, MeshSummary};
use crate::mesh::io::{Landmarks, MeshFile};
use crate::mesh::{ArcId, IdVec, SurfacePoint, TriMesh, VertexId};

/// One mesh of the pair, with where its vertices go.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// The mesh as it was read: polygons, texture coordinates, order.
    pub file: &'a MeshFile,
    /// The same as an oriented manifold; vertex and triangle numbers are the file's.
    pub mesh: &'a TriMesh,
    /// The arcs of the layout on this mesh, each from its first end to its second.
    pub arcs: &'a IdVec<ArcId, Vec<SurfacePoint>>,
    /// Where each of this mesh's vertices lies on the other mesh.
    pub image: &'a IdVec<VertexId, SurfacePoint>,
}

/// A finished map.
#[derive(Clone, Debug)]
pub struct Product<'a> {
    /// The source and its image on the target.
    pub source: Side<'a>,
    /// The target and its image on the source.
    pub target: Side<'a>,
    /// The landmarks, in the order of the base complex.
    pub landmarks: &'a Landmarks,
    /// The base complex that both layouts carry.
    pub base: &'a BaseComplex,
    /// The layout in numbers.
    pub layout: LayoutSummary,
    /// Why the map is a homeomorphism.
    pub certificate: Certificate,
    /// Geometry images: file name and content of each.
    pub images: &'a [(String, Vec<u8>)],
    /// The compute device, in words.
    pub device: &'a str,
    /// What a user should know about this result.
    pub warnings: &'a [String],
}

impl Side<'_> {
    /// The mesh in numbers.
    pub fn summary(&self) -> MeshSummary {
        MeshSummary {
            file: self.file.path.display().to_string(),
            vertices: self.mesh.conn.vertex_count(),
            faces: self.mesh.conn.face_count(),
            genus: self.mesh.genus(),
            boundary_loops: self.mesh.conn.boundary_loops().len(),
        }
    }

    /// The positions of the vertices' images on the mesh of `other`: the compatible mesh.
    pub fn image_positions(&self, other: &Side) -> IdVec<VertexId, glam::DVec3> {
        self.image.iter().map(|p| p.position(other.mesh)).collect()
    }

    /// The measures of the compatible mesh on the mesh of `other`.
    pub fn distortion(&self, other: &Side) -> Distortion {
        let flips = flips_on_target(self.mesh, other.mesh, self.image).len();
        distortion(&self.mesh.faces(), &self.mesh.positions, &self.image_positions(other), flips)
    }
}
