//! Stage 1: reads both meshes, their landmarks and the hint.

use crate::Result;
use crate::mesh::io::{Hint, Landmarks, MeshFile, read_hint, read_landmarks, read_mesh};
use crate::mesh::{TriMesh, VertexId};
use std::path::PathBuf;

/// The files of a pair.
#[derive(Clone, Debug)]
pub struct LoadOptions {
    /// The source mesh.
    pub source: PathBuf,
    /// The target mesh.
    pub target: PathBuf,
    /// Landmarks of both meshes, or of the source if there is a second file.
    pub landmarks: PathBuf,
    /// Landmarks of the target.
    pub target_landmarks: Option<PathBuf>,
    /// Closed curves that must correspond.
    pub hint: Option<PathBuf>,
}

/// A pair as it stands in its files.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The source mesh.
    pub source: MeshFile,
    /// The target mesh.
    pub target: MeshFile,
    /// The landmarks, all of them vertices of the meshes; or why they are none. A fault of the meshes counts for more,
    /// so the check stage has the last word.
    pub landmarks: Result<Landmarks>,
    /// Closed curves that must correspond, if there are any; or why they are none.
    pub hint: Result<Option<Hint>>,
}

impl Loaded {
    /// A pair in memory; landmarks run in parallel and are named by number.
    pub fn of(meshes: [&TriMesh; 2], landmarks: [&[VertexId]; 2]) -> Self {
        let [source, target] = meshes.map(MeshFile::of);
        let [on_source, on_target] = landmarks.map(<[VertexId]>::to_vec);
        let names = (1..=on_source.len()).map(|i| format!("landmark {i}")).collect();
        let landmarks = Landmarks { names, source: on_source, target: on_target, ..Landmarks::default() };
        Loaded { source, target, landmarks: Ok(landmarks), hint: Ok(None) }
    }
}

/// Reads a pair; fails if a mesh is unreadable. If both are, the error is the source's.
pub fn load(options: LoadOptions) -> Result<Loaded> {
    load_with(options, None)
}

/// The same where the source may be at hand.
pub fn load_with(options: LoadOptions, source: Option<Result<MeshFile>>) -> Result<Loaded> {
    let read_source = || source.unwrap_or_else(|| read_mesh(&options.source));
    let (source, target) = rayon::join(read_source, || read_mesh(&options.target));
    let (source, target) = (source?, target?);
    let landmarks = read_landmarks(&options.landmarks, options.target_landmarks.as_deref(), &source, &target);
    let hint = options.hint.map(|path| read_hint(&path, &source, &target)).transpose();
    Ok(Loaded { source, target, landmarks, hint })
}
