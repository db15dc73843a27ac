//! Stage 2: makes sure that both meshes are manifolds of the same kind, so that a map can exist.

use super::load::Loaded;
use crate::mesh::check::{Report, Warning, check as check_mesh};
use crate::mesh::io::{Landmarks, MeshFile};
use crate::mesh::{TriMesh, VertexId};
use crate::{Error, Result};
use std::path::Path;

/// A mesh with its file and what the check said about it.
#[derive(Clone, Debug)]
pub struct LoadedMesh {
    /// The file's content.
    pub file: MeshFile,
    /// The manifold; vertices are the file's, triangles those of [`MeshFile::triangles`] with repairs as reported.
    pub mesh: TriMesh,
    /// What the check said.
    pub report: Report,
}

/// A pair that a map exists for.
#[derive(Clone, Debug)]
pub struct Checked {
    /// The source mesh.
    pub source: LoadedMesh,
    /// The target mesh.
    pub target: LoadedMesh,
    /// The landmarks.
    pub landmarks: Landmarks,
    /// Everything odd about the input, as sentences.
    pub warnings: Vec<String>,
}

/// Checks both meshes, then what they must have in common.
pub fn check(loaded: Loaded) -> Result<Checked> {
    let Loaded { source, target, landmarks, landmarks_path } = loaded;
    let (source, target) = rayon::join(|| inspect(source), || inspect(target));
    let (source, target) = (source?, target?);
    for (side, mesh, vertices) in [("source", &source, &landmarks.source), ("target", &target, &landmarks.target)] {
        refuse_unreferenced(side, mesh, &landmarks.names, vertices).map_err(|e| e.file(&landmarks_path))?;
    }
    same_topology(&source.report, &target.report).map_err(|e| e.file(&target.file.path))?;
    supported(&source.report, landmarks.names.len()).map_err(|e| e.file(&source.file.path))?;
    let mut warnings = warnings(&source, &target, &landmarks);
    warnings.extend(open_class(&source.report));
    Ok(Checked { source, target, landmarks, warnings })
}

/// Checks one mesh; refuses it, naming the faults, if it is not an orientable manifold.
pub fn inspect(file: MeshFile) -> Result<LoadedMesh> {
    let mut report = check_mesh(&file.positions, &file.triangles());
    let mesh = report.take_mesh().map_err(|e| e.file(&file.path))?;
    Ok(LoadedMesh { file, mesh, report })
}

fn refuse_unreferenced(side: &str, mesh: &LoadedMesh, names: &[String], vertices: &[VertexId]) -> Result<()> {
    let unused = |v: &VertexId| mesh.mesh.conn.leaving(*v).is_none();
    let Some(i) = vertices.iter().position(unused) else { return Ok(()) };
    Err(Error::input(format!("landmark \"{}\" sits on {side} {}, which no face uses", names[i], vertices[i]))
        .at(format_args!("landmark {i}"))
        .remedy("move it to a vertex of the surface"))
}

/// Refuses pairs between which there is no homeomorphism.
fn same_topology(source: &Report, target: &Report) -> Result<()> {
    let loops = |report: &Report| report.boundary_loops.len() as i64;
    let genus = |report: &Report| report.genus.unwrap_or_default(); // both are manifolds by now
    let components = |report: &Report| report.components.len() as i64;
    let figures = [
        ("numbers of components", components(source), components(target), "map the components one by one"),
        ("genus", genus(source), genus(target), "look for unwanted tunnels, for instance where limbs touch"),
        ("numbers of boundary loops", loops(source), loops(target), "close the extra holes; `homeo check` lists them"),
    ];
    match figures.into_iter().find(|(_, s, t, _)| s != t) {
        Some((what, s, t, remedy)) => {
            Err(Error::unsolvable(format!("different {what}: {s} in the source, {t} in the target")).remedy(remedy))
        }
        None => Ok(()),
    }
}

/// What this version maps: closed, connected, with landmarks.
fn supported(source: &Report, landmarks: usize) -> Result<()> {
    if source.components.len() != 1 {
        let what = format!("the meshes are in pieces (components: {})", source.components.len());
        return Err(Error::unsolvable(what).remedy("map the components one by one"));
    }
    if !source.is_closed() {
        let what = format!("the meshes are open (boundary loops: {})", source.boundary_loops.len());
        return Err(Error::unsolvable(what).remedy("open meshes are not mapped yet: fill the holes"));
    }
    if landmarks == 0 {
        let what = "no landmarks: nothing tells which of the infinitely many maps is meant";
        return Err(Error::unsolvable(what).remedy("give at least one, better three or more"));
    }
    Ok(())
}

fn warnings(source: &LoadedMesh, target: &LoadedMesh, landmarks: &Landmarks) -> Vec<String> {
    let mut warnings = Vec::new();
    for one in [source, target] {
        let name = file_name(&one.file.path);
        let notes = one.file.warnings.iter().cloned().chain(one.report.notes());
        warnings.extend(notes.map(|note| format!("{name}: {note}")));
    }
    if is_inside_out(&source.report) != is_inside_out(&target.report) {
        warnings.push("one mesh is inside out and the other is not: the map mirrors the shape".to_owned());
    }
    warnings.extend(landmarks.notes.iter().cloned());
    warnings
}

/// What landmarks leave open on a surface with handles.
fn open_class(report: &Report) -> Option<String> {
    let genus = report.genus.filter(|&genus| genus > 0)?;
    Some(format!(
        "genus {genus}: landmarks leave open how often the map winds around a handle; of the ways that were tried the \
         one with short arcs and little distortion was taken"
    ))
}

fn is_inside_out(report: &Report) -> bool {
    report.warnings.iter().any(|w| matches!(w, Warning::InsideOut { .. }))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
