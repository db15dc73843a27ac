//! What a textured mesh is written as: the mesh with its new texture coordinates, and where vertices were added.

use super::disc::Disc;
use super::refined::Refined;
use crate::mesh::VertexId;
use crate::mesh::io::{Keyword, MeshFile, NO_INDEX, Statement};
use glam::DVec2;
use std::io::{Result, Write};
use std::path::Path;

/// The material's name.
const MATERIAL: &str = "texture";
/// The material library's name.
pub const LIBRARY: &str = "mesh.mtl";

/// A mesh with texture coordinates.
pub struct Textured {
    /// The given vertices, polygons and groups, the added vertices at the end; polygons that hold some are triangles.
    pub file: MeshFile,
    /// For every added vertex of the file where it lies: the given face and its barycentric coordinates there.
    pub added: Vec<(u32, [f64; 3])>,
}

/// Joins a mesh file and the disc that was made from it, laid out; `place` is where the mesh will lie.
pub fn textured(given: &MeshFile, disc: &Disc, refined: &Refined, place: &Path) -> Textured {
    let mut parts: Vec<Vec<[u32; 3]>> = vec![Vec::new(); disc.real];
    for (corners, &part) in refined.sheet.triangles.iter().zip(&refined.part_of).take(refined.sheet.real) {
        parts[part as usize].push(*corners);
    }
    let mut writer = Writer::new(given, disc, refined, place);
    let mut triangle = 0;
    let mut statements = given.statements.iter().filter(|s| s.keyword != Keyword::Material).peekable();
    for p in 0..given.polygon_count() {
        let polygon = writer.file.polygon_count();
        while let Some(s) = statements.next_if(|s| s.polygon <= p) {
            writer.file.statements.push(Statement { polygon, ..s.clone() });
        }
        let corners = given.polygon(p);
        let triangles = triangle..triangle + corners.len() - 2;
        triangle = triangles.end;
        let is_whole = |t: usize| parts[t].len() == 1 && parts[t][0].iter().all(|&v| (v as usize) < refined.given());
        if triangles.clone().all(is_whole) {
            let uv = |v: VertexId| {
                let mut own = triangles.clone().flat_map(|t| parts[t][0]);
                own.find(|&d| disc.vertex_of[d as usize] == Some(v)).unwrap_or(NO_INDEX)
            };
            writer.polygon(corners.map(|c| (given.corners[c].0, uv(given.corners[c]))).collect());
        } else {
            for corners in triangles.flat_map(|t| &parts[t]) {
                let corners = corners.map(|v| (writer.vertex(v), v));
                writer.polygon(corners.to_vec());
            }
        }
    }
    writer.finish()
}

struct Writer<'a> {
    disc: &'a Disc,
    refined: &'a Refined,
    file: MeshFile,
    /// The file's number of every added vertex that is used.
    number: Vec<Option<u32>>,
    /// The file's texture coordinate of every vertex of the disc that is used.
    uv: Vec<Option<u32>>,
    added: Vec<(u32, [f64; 3])>,
}

impl<'a> Writer<'a> {
    fn new(given: &MeshFile, disc: &'a Disc, refined: &'a Refined, place: &Path) -> Self {
        let file = MeshFile {
            path: place.join("mesh.obj"),
            positions: given.positions.clone(),
            normals: given.normals.clone(),
            material_libraries: vec![LIBRARY.to_owned()],
            statements: vec![Statement { polygon: 0, keyword: Keyword::Material, text: MATERIAL.to_owned() }],
            ..MeshFile::default()
        };
        let (number, uv) = (vec![None; refined.steiner.len()], vec![None; refined.sheet.uv.len()]);
        Writer { disc, refined, file, number, uv, added: Vec::new() }
    }

    /// The file's number of a vertex of the refined disc.
    fn vertex(&mut self, v: u32) -> u32 {
        let Some(i) = (v as usize).checked_sub(self.refined.given()) else {
            return self.disc.vertex_of[v as usize].map_or(NO_INDEX, |v| v.0);
        };
        *self.number[i].get_or_insert_with(|| {
            let steiner = self.refined.steiner[i];
            self.added.push((steiner.triangle, steiner.weights));
            self.file.positions.push(self.refined.sheet.points[v as usize]);
            self.file.positions.len() as u32 - 1
        })
    }

    /// Appends a polygon by its vertices in the file and in the refined disc.
    fn polygon(&mut self, corners: Vec<(u32, u32)>) {
        self.file.push_polygon(corners.iter().map(|c| c.0));
        for (_, v) in corners {
            let index = *self.uv[v as usize].get_or_insert_with(|| {
                let DVec2 { x, y } = self.refined.sheet.uv[v as usize];
                self.file.uv.values.push(DVec2::new(x, y));
                self.file.uv.values.len() as u32 - 1
            });
            self.file.uv.corners.push(index);
        }
    }

    fn finish(self) -> Textured {
        Textured { file: self.file, added: self.added }
    }
}

/// Writes the material that shows an image in the same folder.
pub fn write_material(out: &mut dyn Write, image: &str) -> Result<()> {
    writeln!(out, "newmtl {MATERIAL}\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd {image}")
}

/// Writes where vertices were added: `vertex,face,b0,b1,b2`, faces being the given mesh's triangles.
pub fn write_added(out: &mut dyn Write, given: usize, added: &[(u32, [f64; 3])]) -> Result<()> {
    writeln!(out, "vertex,face,b0,b1,b2")?;
    for (i, (face, [a, b, c])) in added.iter().enumerate() {
        writeln!(out, "{},{face},{a},{b},{c}", given + i)?;
    }
    Ok(())
}
