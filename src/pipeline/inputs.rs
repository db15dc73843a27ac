//! The files behind the path of an input.

use crate::app::udim::{is_pattern, tiles_of};
use crate::error::Result;
use crate::mesh::io::companions;
use std::path::{Path, PathBuf};

/// The files that are read for `path`: the tiles of a pattern, a mesh with what it refers to, else itself.
///
/// # Errors
/// Input, if a pattern has no tile.
pub fn files_behind(path: &Path) -> Result<Vec<PathBuf>> {
    if is_pattern(path) {
        return tiles_of(path);
    }
    let mut files = vec![path.to_owned()];
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if ["obj", "gltf", "glb"].contains(&extension.as_str()) {
        files.extend(companions(path));
    }
    Ok(files)
}
