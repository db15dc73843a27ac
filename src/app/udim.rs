//! File names with `<UDIM>` in them: one image for every tile of texture space.

use super::uv::{Tile, udim_number};
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// Stands for the tile's number in a file name.
const PATTERN: &str = "<UDIM>";

/// True for a path that stands for one file per tile.
pub fn is_pattern(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().contains(PATTERN))
}

/// The file of a tile: the path itself unless it is a pattern.
///
/// # Errors
/// Input, if the tile has no UDIM number.
pub fn file_of(path: &Path, tile: Tile) -> Result<PathBuf> {
    if !is_pattern(path) {
        return Ok(path.to_owned());
    }
    let number = udim_number(tile).ok_or_else(|| {
        Error::input(format!(
            "texture coordinates in the tile at u = {}, v = {}, which has no UDIM number",
            tile[0], tile[1]
        ))
        .file(path)
        .remedy("move them to u from 0 to 10 and v from 0 on")
    })?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().replace(PATTERN, &number.to_string());
    Ok(path.with_file_name(name))
}

/// A file beside another one: `word` comes before the extension.
pub fn beside(path: &Path, word: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
    path.with_file_name(format!("{stem}_{word}{extension}"))
}

/// The tiles' numbers: 1001 to 1100 and on, ten in a row, as far up as anybody goes.
const NUMBERS: std::ops::Range<u32> = 1001..2000;

/// The files that a pattern stands for, those that are there, in the order of their tiles.
///
/// # Errors
/// Input, if there is none.
pub fn tiles_of(pattern: &Path) -> Result<Vec<PathBuf>> {
    let name = pattern.file_name().unwrap_or_default().to_string_lossy();
    let tile = |number: u32| pattern.with_file_name(name.replace(PATTERN, &number.to_string()));
    let files: Vec<PathBuf> = NUMBERS.map(tile).filter(|file| file.is_file()).collect();
    if files.is_empty() {
        return Err(Error::input("no file of this pattern is there").file(pattern).remedy("check the path"));
    }
    Ok(files)
}
