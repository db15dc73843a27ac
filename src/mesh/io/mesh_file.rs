//! What a mesh file holds, in the order of the file: nothing renumbered, dropped or merged.

use crate::mesh::{TriMesh, VertexId};
use crate::{Error, Result};
use glam::{DVec2, DVec3};
use std::path::PathBuf;

/// Marks a corner without an attribute.
pub const NO_INDEX: u32 = u32::MAX;

/// Values that corners of polygons refer to, such as texture coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attribute<T> {
    /// The values in the order of the file.
    pub values: Vec<T>,
    /// For every corner the index of its value or [`NO_INDEX`]; empty if no corner has one.
    pub corners: Vec<u32>,
}

impl<T: Copy> Attribute<T> {
    /// The value at a corner.
    pub fn at(&self, corner: usize) -> Option<T> {
        self.index(corner).map(|i| self.values[i as usize])
    }

    /// The index of a corner's value.
    pub fn index(&self, corner: usize) -> Option<u32> {
        self.corners.get(corner).copied().filter(|&i| i != NO_INDEX)
    }

    /// Lets every corner take the value of its vertex, if there are values.
    pub(super) fn spread(&mut self, corners: &[VertexId]) {
        if !self.values.is_empty() {
            self.corners = corners.iter().map(|v| v.0).collect();
        }
    }
}

/// What an OBJ statement between the faces sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keyword {
    /// `o`: the object's name.
    Object,
    /// `g`: group names.
    Group,
    /// `s`: the smoothing group.
    Smoothing,
    /// `usemtl`: the material of the faces that follow.
    Material,
}

impl Keyword {
    /// The word in the file.
    pub fn word(self) -> &'static str {
        match self {
            Keyword::Object => "o",
            Keyword::Group => "g",
            Keyword::Smoothing => "s",
            Keyword::Material => "usemtl",
        }
    }
}

/// An OBJ statement that applies from a polygon on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// The first polygon it applies to.
    pub polygon: usize,
    /// What it sets.
    pub keyword: Keyword,
    /// Its text after the keyword.
    pub text: String,
}

/// The content of a mesh file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    /// Where it was read from.
    pub path: PathBuf,
    /// Vertex positions; vertex `i` is the file's vertex `i`.
    pub positions: Vec<DVec3>,
    /// Where each polygon's corners start in `corners`, and one more entry for the end.
    pub offsets: Vec<u32>,
    /// The polygons' corners, one polygon after the other.
    pub corners: Vec<VertexId>,
    /// Texture coordinates, v up.
    pub uv: Attribute<DVec2>,
    /// Normals as the file has them.
    pub normals: Attribute<DVec3>,
    /// Names of the material libraries, relative to the file.
    pub material_libraries: Vec<String>,
    /// Objects, groups and materials in the order of the file.
    pub statements: Vec<Statement>,
    /// Oddities that were survived, as sentences.
    pub warnings: Vec<String>,
}

impl MeshFile {
    /// What a file of this mesh would hold, without a path.
    pub fn of(mesh: &TriMesh) -> Self {
        let corners: Vec<VertexId> = mesh.faces().into_iter().flatten().collect();
        let offsets = (0..=corners.len() as u32).step_by(3).collect();
        MeshFile { positions: mesh.positions.raw.clone(), offsets, corners, ..MeshFile::default() }
    }

    /// Number of polygons.
    pub fn polygon_count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// The corner numbers of a polygon.
    pub fn polygon(&self, p: usize) -> std::ops::Range<usize> {
        self.offsets[p] as usize..self.offsets[p + 1] as usize
    }

    /// Number of triangles after triangulation.
    pub fn triangle_count(&self) -> usize {
        self.corners.len() - 2 * self.polygon_count()
    }

    /// The triangles: every polygon as the fan (p0, pj, pj+1), in the order of the file.
    pub fn triangles(&self) -> Vec<[VertexId; 3]> {
        self.triangle_corners().map(|t| t.map(|c| self.corners[c])).collect()
    }

    /// The corner numbers of every triangle, with which its attributes are found.
    pub fn triangle_corners(&self) -> impl Iterator<Item = [usize; 3]> {
        (0..self.polygon_count()).flat_map(|p| self.polygon_triangles(p))
    }

    /// The corner numbers of a polygon's triangles.
    pub fn polygon_triangles(&self, p: usize) -> impl Iterator<Item = [usize; 3]> + use<> {
        let corners = self.polygon(p);
        (corners.start + 1..corners.end - 1).map(move |j| [corners.start, j, j + 1])
    }

    /// The polygon of every triangle.
    pub fn triangle_polygons(&self) -> Vec<u32> {
        let polygons = 0..self.polygon_count();
        polygons.flat_map(|p| std::iter::repeat_n(p as u32, self.polygon(p).len() - 2)).collect()
    }

    /// Appends a polygon by its vertices.
    pub fn push_polygon(&mut self, corners: impl IntoIterator<Item = u32>) {
        if self.offsets.is_empty() {
            self.offsets.push(0);
        }
        self.corners.extend(corners.into_iter().map(VertexId));
        self.offsets.push(self.corners.len() as u32);
    }

    /// Refuses meshes without faces and meshes whose elements 32-bit ids cannot number.
    pub(super) fn check_size(&self) -> Result<()> {
        const LIMIT: usize = u32::MAX as usize;
        if self.polygon_count() == 0 {
            return Err(Error::input(format!("no faces, {} vertices", self.positions.len()))
                .at("end of file")
                .remedy("export the mesh with its faces; the file may be cut short"));
        }
        if self.positions.len() >= LIMIT || 3 * self.triangle_count() >= LIMIT {
            return Err(Error::input("more elements than 32-bit indices can number").remedy("split the mesh"));
        }
        Ok(())
    }
}
