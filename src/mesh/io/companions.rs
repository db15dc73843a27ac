//! The files that a mesh file refers to: buffers of glTF, material libraries and their textures.

use super::gltf::buffer_files;
use super::library_path::libraries_named;
use super::materials::read_library;
use std::path::{Path, PathBuf};

/// The files beside `path` that what is made of the mesh can depend on, those that are there, in the order of their mention.
/// What is wrong with the mesh itself is for its reader to say.
pub fn companions(path: &Path) -> Vec<PathBuf> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let Ok(bytes) = std::fs::read(path) else { return Vec::new() };
    let mut files = buffer_files(&bytes, folder);
    for library in libraries_named(&bytes).map(|name| folder.join(name)) {
        let textures = read_library(&library).unwrap_or_default().into_iter().filter_map(|m| m.texture);
        files.push(library);
        files.extend(textures);
    }
    files.retain(|file| file.is_file());
    files
}
