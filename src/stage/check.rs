//! Stage 2: makes sure that both meshes are manifolds of the same kind, so that a map can exist.

mod counterparts;
mod guides;
mod mirrored;
mod trim;

use super::load::Loaded;
use crate::mesh::check::{Report, check as check_mesh};
use crate::mesh::io::{Hint, Landmarks, MeshFile};
use crate::mesh::{Canonical, FaceId, TriMesh, VertexId};
use crate::{Error, Result};
pub use guides::Guides;

use counterparts::{match_components, same_loops, same_numbers};
use guides::Guiding;
use mirrored::refuse_mirrored;
use std::path::Path;
use trim::trim;

/// What the two meshes are called in messages.
const SIDES: [&str; 2] = ["source", "target"];

/// A mesh with its file and what the check said about it.
#[derive(Clone, Debug)]
pub struct LoadedMesh {
    /// The file's content.
    pub file: MeshFile,
    /// The manifold; vertices are the file's, triangles those of [`MeshFile::triangles`] with repairs as reported, and
    /// without those left out.
    pub mesh: TriMesh,
    /// The file's triangles that are left out of the map, in order.
    pub omitted: Vec<FaceId>,
    /// What the check said.
    pub report: Report,
    /// The manifold in the order that the stages work in.
    pub canonical: Canonical,
}

/// A pair that a map exists for.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The source mesh.
    pub source: LoadedMesh,
    /// The target mesh.
    pub target: LoadedMesh,
    /// The landmarks, as the file has them.
    pub landmarks: Landmarks,
    /// The landmarks in the order that the stages work in, by their numbers in the file.
    pub landmark_order: Vec<usize>,
    /// Closed curves that the map takes to each other.
    pub guides: Guides,
    /// Everything odd about the input, as sentences.
    pub warnings: Vec<String>,
}

impl Checked {
    /// Both meshes in the order that the stages work in: it depends on positions alone, not on the files' orders.
    pub fn meshes(&self) -> [&TriMesh; 2] {
        [&self.source.canonical.mesh, &self.target.canonical.mesh]
    }

    /// The landmarks as vertices of [`Checked::meshes`], in the order of [`Checked::landmark_order`].
    pub fn sites(&self) -> [Vec<VertexId>; 2] {
        let sites = |mesh: &LoadedMesh, vertices: &[VertexId]| {
            self.landmark_order.iter().map(|&l| mesh.canonical.vertex(vertices[l])).collect()
        };
        [sites(&self.source, &self.landmarks.source), sites(&self.target, &self.landmarks.target)]
    }
}

/// Checks both meshes, then what they must have in common, then the landmarks: of several faults the most fundamental is
/// reported.
pub fn check(loaded: Loaded) -> Result<Checked> {
    check_with(loaded, None)
}

/// The same where the source may have been checked before.
pub fn check_with(loaded: Loaded, inspected: Option<Result<LoadedMesh>>) -> Result<Checked> {
    let Loaded { source, target, landmarks, hint } = loaded;
    let (source, target) = rayon::join(|| inspected.unwrap_or_else(|| inspect(source)), || inspect(target));
    let (mut source, mut target) = (source?, target?);
    same_numbers([&source.report, &target.report]).map_err(|e| e.file(&target.file.path))?;
    let landmarks = landmarks?;
    let hint = hint?;
    let doubt = check_landmarks([&source.mesh, &target.mesh], &landmarks)?;
    match_components([&source, &target], &landmarks).map_err(|e| e.file(&target.file.path))?;
    let trimmed = trim([&mut source, &mut target], &landmarks);
    same_loops([&source.mesh, &target.mesh], &landmarks).map_err(|e| e.file(&target.file.path))?;
    let mut warnings = warnings(&source, &target, &landmarks);
    warnings.extend(trimmed.into_iter().chain(doubt));
    if source.mesh.faces() == target.mesh.faces() {
        // Two poses of one mesh: in one order, ties are decided alike on both.
        target.canonical = Canonical::like(&target.mesh, &source.canonical);
    }
    let mut landmark_order: Vec<usize> = (0..landmarks.names.len()).collect();
    landmark_order.sort_by_key(|&l| source.canonical.vertex(landmarks.source[l]));
    let mut checked = Checked { source, target, landmarks, landmark_order, guides: Guides::default(), warnings };
    if let Some(hint) = hint {
        checked.guides = find_guides(&checked, &hint).map_err(|e| e.file(&hint.path))?;
    }
    let open = open_class(&checked);
    checked.warnings.extend(open);
    Ok(checked)
}

fn find_guides(checked: &Checked, hint: &Hint) -> Result<Guides> {
    let Checked { source, target, landmarks, landmark_order, .. } = checked;
    let [on_source, on_target] = checked.sites();
    let sites = [on_source.as_slice(), &on_target];
    Guiding { loaded: [source, target], landmarks, order: landmark_order, sites, hint }.find()
}

/// Checks one mesh; refuses it, naming the faults, if it is not an orientable manifold.
pub fn inspect(file: MeshFile) -> Result<LoadedMesh> {
    let mut report = check_mesh(&file.positions, &file.triangles());
    let mesh = report.take_mesh().map_err(|e| e.file(&file.path))?;
    let canonical = Canonical::new(&mesh);
    Ok(LoadedMesh { file, mesh, omitted: Vec::new(), report, canonical })
}

/// Refuses landmarks on vertices that no face uses and landmarks that ask for a mirrored map; returns a warning if they
/// might.
pub fn check_landmarks(meshes: [&TriMesh; 2], landmarks: &Landmarks) -> Result<Option<String>> {
    for (side, mesh, vertices) in [("source", meshes[0], &landmarks.source), ("target", meshes[1], &landmarks.target)] {
        refuse_unreferenced(side, mesh, &landmarks.names, vertices).map_err(|e| e.file(&landmarks.path))?;
    }
    refuse_mirrored(meshes, landmarks)
}

fn refuse_unreferenced(side: &str, mesh: &TriMesh, names: &[String], vertices: &[VertexId]) -> Result<()> {
    let unused = |v: &VertexId| mesh.conn.leaving(*v).is_none();
    let Some(i) = vertices.iter().position(unused) else { return Ok(()) };
    Err(Error::input(format!("landmark \"{}\" sits on {side} {}, which no face uses", names[i], vertices[i]))
        .at(format_args!("landmark {i}"))
        .remedy("move it to a vertex of the surface"))
}

fn warnings(source: &LoadedMesh, target: &LoadedMesh, landmarks: &Landmarks) -> Vec<String> {
    let mut warnings = Vec::new();
    for one in [source, target] {
        let name = file_name(&one.file.path);
        let notes = one.file.warnings.iter().cloned().chain(one.report.notes());
        warnings.extend(notes.map(|note| format!("{name}: {note}")));
    }
    warnings.extend(landmarks.notes.iter().cloned());
    warnings
}

/// What landmarks and guides leave open on a surface with handles.
fn open_class(Checked { source, guides, .. }: &Checked) -> Option<String> {
    let genus = source.report.genus.filter(|&genus| genus > 0)?;
    let who = match (guides.is_empty(), guides.open) {
        (true, _) => "landmarks leave",
        (false, true) => "landmarks and hint leave",
        (false, false) => return None,
    };
    Some(format!(
        "genus {genus}: {who} open how often the map winds around a handle; of the ways that were tried the one with \
         short arcs and little distortion was taken (--hint decides it)"
    ))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
