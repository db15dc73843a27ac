//! A finished map's folder, as `homeo map` wrote it, read back.

use crate::error::{Error, Result};
use crate::map::charts::{Charts, MAP_FILE, fingerprint};
use crate::mesh::io::{MeshFile, read_mesh};
use crate::mesh::{FaceId, Id};
use crate::stage::write::folder::REPORT_FILE;
use serde::Deserialize;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The source with vertices appended; there only if the map was refined.
const REFINED_SOURCE: &str = "source_refined.obj";
/// The source's vertices and faces at the target's shape.
const SOURCE_ON_TARGET: &str = "source_on_target.obj";

/// The folder of a finished map.
#[derive(Clone, Debug)]
pub struct MapFolder {
    dir: PathBuf,
    report: Report,
}

/// What is needed of `report.json`.
#[derive(Clone, Debug, Deserialize)]
struct Report {
    source: Mapped,
    target: Mapped,
}

/// One of the two meshes.
#[derive(Clone, Debug, Deserialize)]
struct Mapped {
    file: PathBuf,
    vertices: usize,
    faces: usize,
}

impl MapFolder {
    /// Reads the report of a finished map. Fails if `dir` is no such folder.
    pub fn open(dir: &Path) -> Result<Self> {
        let path = dir.join(REPORT_FILE);
        let no_map = |what: String| Err(Error::input(what).file(dir).remedy("name a folder that `homeo map` wrote"));
        let text = match fs::read(&path) {
            Ok(text) => text,
            Err(e) if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                return no_map(format!("not a finished map: there is no {REPORT_FILE}"));
            }
            Err(e) => return Err(Error::io(&path, &e)),
        };
        match serde_json::from_slice(&text) {
            Ok(report) => Ok(MapFolder { dir: dir.to_owned(), report }),
            Err(e) => no_map(format!("not a finished map: {REPORT_FILE} says something else: {e}")),
        }
    }

    /// The file of the source, 0, or of the target, 1, as it was named.
    pub fn mesh(&self, k: usize) -> &Path {
        if k == 0 { &self.report.source.file } else { &self.report.target.file }
    }

    /// The name of the target's file, without folder and extension.
    pub fn target_name(&self) -> String {
        let stem = self.report.target.file.file_stem();
        stem.map_or_else(|| "target".to_owned(), |stem| stem.to_string_lossy().into_owned())
    }

    /// The map at every point.
    pub fn read_charts(&self) -> Result<Charts> {
        let path = self.dir.join(MAP_FILE);
        let bytes = fs::read(&path).map_err(|e| Error::io(&path, &e).remedy("map the pair again"))?;
        Charts::decode(&bytes).map_err(|e| e.file(&path))
    }

    /// The source as the map has it: its file, or what refinement made of it; `moved` says where the file is now, if not where
    /// the report has it.
    ///
    /// Fails if the file is gone or has other numbers of vertices or faces than the one that was mapped; one that was moved
    /// must be that one by its checksum.
    pub fn read_source(&self, moved: Option<&Path>) -> Result<MeshFile> {
        let moved = moved.map(|file| read_mapped(file, self.read_charts()?.meshes[0].fingerprint, "--source"));
        let moved = moved.transpose()?;
        let refined = self.dir.join(REFINED_SOURCE);
        if refined.is_file() {
            return read_mesh(&refined);
        }
        moved.map_or_else(|| self.read_source_in_place(), Ok)
    }

    fn read_source_in_place(&self) -> Result<MeshFile> {
        let Mapped { file, vertices, faces } = &self.report.source;
        if !file.is_file() {
            return Err(Error::input("the source of the map is not there any more")
                .file(file)
                .at(format_args!("named in {}", self.dir.join(REPORT_FILE).display()))
                .remedy("say where it is with --source"));
        }
        let mesh = read_mesh(file)?;
        let counts = (mesh.positions.len(), mesh.triangle_count());
        if counts == (*vertices, *faces) {
            return Ok(mesh);
        }
        let what = format!(
            "{} vertices and {} triangles, but the map in {} was made from {vertices} and {faces}",
            counts.0,
            counts.1,
            self.dir.display()
        );
        Err(Error::input(what).file(file).remedy("the file has changed since: put the old one back, or map again"))
    }

    /// The source's vertices and faces at the target's shape. Fails if they are not those of `source`.
    pub fn read_source_on_target(&self, source: &MeshFile) -> Result<MeshFile> {
        let mesh = read_mesh(&self.dir.join(SOURCE_ON_TARGET))?;
        match difference(&mesh, source) {
            None => Ok(mesh),
            Some(error) => Err(error
                .file(&mesh.path)
                .remedy(format!("all maps must come from {}, refined alike: map again", source.path.display()))),
        }
    }
}

/// Reads a mesh, which must be the one that was mapped, by its checksum; `flag` names another one.
///
/// # Errors
/// Input, if the file is not there, is no sound mesh, or not that one.
pub fn read_mapped(file: &Path, checksum: u32, flag: &str) -> Result<MeshFile> {
    if !file.is_file() {
        let what = "the mesh that was mapped is not there";
        return Err(Error::input(what).file(file).remedy(format!("say where it is with {flag}")));
    }
    let mesh = read_mesh(file)?;
    if fingerprint(&mesh) != checksum {
        let what = "the mesh is not the one that was mapped";
        return Err(Error::input(what).file(file).remedy(format!("map it again, or name the other with {flag}")));
    }
    Ok(mesh)
}

/// The first difference between a mesh and the one whose vertices and faces it should have.
fn difference(mesh: &MeshFile, expected: &MeshFile) -> Option<Error> {
    let counts = |m: &MeshFile| [m.positions.len(), m.polygon_count()];
    let ([vertices, faces], [all_vertices, all_faces]) = (counts(mesh), counts(expected));
    if (vertices, faces) != (all_vertices, all_faces) {
        let what = format!("{vertices} vertices and {faces} faces, but the source has {all_vertices} and {all_faces}");
        return Some(Error::input(what));
    }
    let corners = |m: &MeshFile, p| m.corners[m.polygon(p)].to_vec();
    let other = (0..faces).find(|&p| corners(mesh, p) != corners(expected, p));
    other.map(|p| Error::input("not the source's faces in their order").at(FaceId::new(p)))
}
