//! Stage 1: reads both meshes and their landmarks.

use crate::Result;
use crate::mesh::io::{Landmarks, MeshFile, read_landmarks, read_mesh};
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
}

/// A pair as it stands in its files.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The source mesh.
    pub source: MeshFile,
    /// The target mesh.
    pub target: MeshFile,
    /// The landmarks, all of them vertices of the meshes.
    pub landmarks: Landmarks,
    /// Where the landmarks come from, for messages.
    pub landmarks_path: PathBuf,
}

/// Reads a pair. If both meshes are unreadable, the error is the source's.
pub fn load(options: LoadOptions) -> Result<Loaded> {
    let (source, target) = rayon::join(|| read_mesh(&options.source), || read_mesh(&options.target));
    let (source, target) = (source?, target?);
    let landmarks = read_landmarks(&options.landmarks, options.target_landmarks.as_deref(), &source, &target)?;
    Ok(Loaded { source, target, landmarks, landmarks_path: options.landmarks })
}
