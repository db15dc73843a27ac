//! Everything that is written out about a finished map, as references to what the stages made.

use super::base_complex::BaseComplex;
use super::certificate::Certificate;
use super::distortion::{Distortion, distortion};
use super::divided::Divided;
use super::flips::flips_on_target;
use super::refined::RefinedMesh;
use super::report::{LayoutSummary, MeshSummary, RelaxationSummary};
use super::tile_table::TileTable;
use crate::mesh::io::{Landmarks, MeshFile};
use crate::mesh::{ArcId, FaceId, IdVec, SurfacePoint, TriMesh, VertexId};
use glam::DVec3;
use std::path::Path;

/// One mesh of the pair, with where its vertices go.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// The mesh as it was read: polygons, texture coordinates, order.
    pub file: &'a MeshFile,
    /// The same as an oriented manifold; vertex and triangle numbers are the file's, while the corners of triangles that
    /// had to be turned over stand in another order.
    pub mesh: &'a TriMesh,
    /// The file's triangles that the mesh lacks because they are left out of the map, in order.
    pub omitted: &'a [FaceId],
    /// The arcs of the layout on this mesh, each from its first end to its second.
    pub arcs: &'a IdVec<ArcId, Vec<SurfacePoint>>,
    /// Where each of this mesh's vertices lies on the other mesh; None for vertices that no face uses.
    pub image: &'a IdVec<VertexId, Option<SurfacePoint>>,
    /// The same mesh with vertices inserted, if that was asked for: then the compatible mesh has its connectivity.
    pub refined: Option<&'a RefinedMesh>,
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
    /// How the distortion was lowered.
    pub relaxation: RelaxationSummary,
    /// Why the map is a homeomorphism.
    pub certificate: Certificate,
    /// Names and contents of further files: the map at every point, textures.
    pub files: &'a [NamedFile],
    /// Geometry images, unless they were not wanted.
    pub images: Option<&'a GeometryImages>,
    /// The compute device, in words.
    pub device: &'a str,
    /// What a user should know about this result.
    pub warnings: Vec<String>,
    /// What is needed to show the map; none if neither preview nor page is wanted.
    pub shown: Option<Shown<'a>>,
}

/// What the preview and the page of a map show besides.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// Both meshes divided along the arcs.
    pub divided: [&'a Divided; 2],
    /// Captions and PNG files of geometry images.
    pub figures: &'a [NamedFile],
    /// The source's texture as it was asked for; none for that of its materials.
    pub texture: Option<&'a Path>,
    /// The command as it was typed; empty if it is not known.
    pub command: &'a str,
}

/// Name and content of a file.
pub type NamedFile = (String, Vec<u8>);

/// Geometry images over one atlas.
#[derive(Clone, Debug)]
pub struct GeometryImages {
    /// The atlas.
    pub table: TileTable,
    /// File name and content of each image.
    pub files: Vec<NamedFile>,
}

impl Side<'_> {
    /// The mesh in numbers.
    pub fn summary(&self) -> MeshSummary {
        MeshSummary {
            file: self.file.path.display().to_string(),
            vertices: self.mesh.conn.vertex_count(),
            faces: self.file.triangle_count(),
            genus: self.mesh.genus(),
            boundary_loops: self.mesh.conn.boundary_loops().len(),
        }
    }

    /// What the compatible mesh is made of: the mesh as it came, or refined.
    pub fn finest(&self) -> Finest<'_> {
        match self.refined {
            None => Finest { file: self.file, mesh: self.mesh, omitted: self.omitted, image: self.image },
            Some(r) => Finest { file: &r.file, mesh: &r.mesh, omitted: &r.omitted, image: &r.images },
        }
    }

    /// The positions of the vertices' images on the mesh of `other`: the compatible mesh.
    ///
    /// A vertex that no face uses has no image; it is put at the first vertex's, where it does no harm.
    pub fn image_positions(&self, other: &Side) -> IdVec<VertexId, DVec3> {
        let image = self.finest().image;
        let anywhere = image.iter().flatten().next().map_or(DVec3::ZERO, |p| p.position(other.mesh));
        image.iter().map(|p| p.map_or(anywhere, |p| p.position(other.mesh))).collect()
    }

    /// The measures of the compatible mesh on the mesh of `other`, and its collapsed or turned-over triangles.
    pub fn distortion(&self, other: &Side) -> (Distortion, Vec<FaceId>) {
        let positions = self.image_positions(other);
        let Finest { mesh, image, .. } = self.finest();
        let flips = flips_on_target(mesh, other.mesh, image, &positions);
        (distortion(&mesh.faces(), &mesh.positions, &positions, flips.len()), flips)
    }
}

/// The mesh that a compatible mesh shares its connectivity with.
#[derive(Clone, Copy, Debug)]
pub struct Finest<'a> {
    /// What its file holds.
    pub file: &'a MeshFile,
    /// The same as an oriented manifold.
    pub mesh: &'a TriMesh,
    /// The file's triangles that the mesh lacks, in order.
    pub omitted: &'a [FaceId],
    /// Where each vertex lies on the other mesh.
    pub image: &'a IdVec<VertexId, Option<SurfacePoint>>,
}
