//! Which image a morph shows.

use crate::error::{Error, Result};
use crate::mesh::io::materials::read_materials;
use crate::mesh::io::{MeshFile, TextureImage};
use std::path::{Path, PathBuf};

/// An image and where it came from.
pub struct Texture {
    /// Its file.
    pub path: PathBuf,
    /// Its content.
    pub image: TextureImage,
}

/// The image that was asked for, or else the first texture of the mesh's materials; and warnings.
///
/// An image that was asked for must be PNG or JPEG, and the mesh must have texture coordinates. Whatever is missing of the
/// materials is a warning.
pub fn choose(asked: Option<&Path>, mesh: &MeshFile) -> Result<(Option<Texture>, Vec<String>)> {
    let has_uv = !mesh.uv.values.is_empty();
    match asked {
        Some(_) if !has_uv => Err(Error::input("the mesh has no texture coordinates for an image")
            .file(&mesh.path)
            .remedy("leave out --texture, or add texture coordinates to the source")),
        Some(path) => Ok((Some(read(path)?), Vec::new())),
        None if has_uv => Ok(of_materials(mesh)),
        None => Ok((None, Vec::new())),
    }
}

fn read(path: &Path) -> Result<Texture> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, &e))?;
    let image = TextureImage::new(bytes).ok_or_else(|| {
        Error::input("neither PNG nor JPEG, which are what glTF can hold").file(path).remedy("convert the image to PNG")
    })?;
    Ok(Texture { path: path.to_owned(), image })
}

fn of_materials(mesh: &MeshFile) -> (Option<Texture>, Vec<String>) {
    let materials = match read_materials(mesh) {
        Ok(materials) => materials,
        Err(error) => return (None, vec![format!("no texture is embedded: {error}")]),
    };
    let mut paths: Vec<PathBuf> = materials.into_iter().filter_map(|m| m.texture).collect();
    paths.sort_by_key(|path| !path.is_file());
    paths.dedup();
    let Some(path) = paths.first() else { return (None, Vec::new()) };
    match read(path) {
        Ok(texture) if paths.len() == 1 => (Some(texture), Vec::new()),
        Ok(texture) => {
            let what = format!("the materials have {} textures; only {} is embedded", paths.len(), path.display());
            (Some(texture), vec![what])
        }
        Err(error) => (None, vec![format!("no texture is embedded: {error}")]),
    }
}
