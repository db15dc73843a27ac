//! `morph`: finished maps of one source as morph targets of one GLB file, as steps in OBJ files, and as a moving picture.

mod animation;
mod frames;
mod texture;

use super::MapFolder;
use crate::error::{Error, Result};
use crate::mesh::io::{MeshFile, Morph, MorphTarget, write_morph};
use crate::stage::write::write_file;
use animation::animation;
use frames::Frame;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What is to be made.
#[derive(Clone, Debug, Default)]
pub struct MorphJob {
    /// Folders of finished maps of one source; each gives one target.
    pub folders: Vec<PathBuf>,
    /// The GLB file; OBJ steps are written beside it.
    pub out: Option<PathBuf>,
    /// A GIF file.
    pub gif: Option<PathBuf>,
    /// Number of OBJ steps per target, the source and the target's shape included: 2 at least; none if absent.
    pub frames: Option<usize>,
    /// A PNG or JPEG file as colour texture; by default the first one of the source's materials.
    pub texture: Option<PathBuf>,
    /// Where the source is now, if not where it was mapped.
    pub source: Option<PathBuf>,
}

/// What was made.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MorphResult {
    /// The GLB file.
    pub file: Option<String>,
    /// The GIF file.
    pub gif: Option<String>,
    /// Number of the mesh's vertices.
    pub vertices: usize,
    /// Number of vertices that were appended along seams of texture coordinates, in the GLB file only.
    pub appended: usize,
    /// Number of triangles.
    pub faces: usize,
    /// Names of the morph targets.
    pub targets: Vec<String>,
    /// The embedded image, if any.
    pub texture: Option<String>,
    /// The OBJ files.
    pub frames: Vec<String>,
    /// What a user should know, one sentence each.
    pub warnings: Vec<String>,
}

/// Makes the files. All input is read and checked before any is written; the GLB file comes last, and each file appears
/// complete or not at all.
pub fn morph(job: &MorphJob) -> Result<MorphResult> {
    let (mesh, targets) = read_shapes(job)?;
    let (texture, warnings) = texture::choose(job.texture.as_deref(), &mesh)?;
    let image = texture.as_ref().map(|t| &t.image);
    let packed = |out: &PathBuf| {
        let morph = Morph { mesh: &mesh, name: &stem(out), targets: &targets, image };
        write_morph(&morph).map_err(|e| e.file(out))
    };
    let glb = job.out.as_ref().map(packed).transpose()?;
    let steps = job.frames.zip(job.out.as_ref());
    let frames = steps.map_or_else(Vec::new, |(count, out)| frames::plan(out, &targets, count));
    spare_input(job, &mesh, &frames)?;
    let shown = texture.as_ref().map(|t| t.path.as_path());
    let packed = |gif| animation(&mesh, &targets, shown).map(|bytes| (gif, bytes));
    let moving = job.gif.as_ref().map(packed).transpose()?;
    for frame in &frames {
        frame.write(&mesh)?;
    }
    if let Some((gif, bytes)) = &moving {
        write_file(gif, |file| file.write_all(bytes))?;
    }
    if let Some((glb, out)) = glb.as_ref().zip(job.out.as_ref()) {
        write_file(out, |file| file.write_all(&glb.bytes))?;
    }
    let name = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
    Ok(MorphResult {
        file: name(&job.out),
        gif: name(&job.gif),
        vertices: mesh.positions.len(),
        appended: glb.map_or(0, |glb| glb.vertices - mesh.positions.len()),
        faces: mesh.triangle_count(),
        targets: targets.iter().map(|t| t.name.clone()).collect(),
        texture: texture.map(|t| t.path.display().to_string()),
        frames: frames.iter().map(|f| f.path.display().to_string()).collect(),
        warnings,
    })
}

/// The source of the first map, and its shape on every target.
fn read_shapes(job: &MorphJob) -> Result<(MeshFile, Vec<MorphTarget>)> {
    let maps = job.folders.iter().map(|dir| MapFolder::open(dir)).collect::<Result<Vec<_>>>()?;
    let first = maps.first().ok_or_else(|| Error::usage("no maps").remedy("name a folder that `homeo map` wrote"))?;
    let mesh = first.read_source(job.source.as_deref())?;
    let names = unique(maps.iter().map(MapFolder::target_name).collect());
    let target = |(map, name): (&MapFolder, String)| {
        let positions = map.read_source_on_target(&mesh)?.positions;
        Ok(MorphTarget { name, positions })
    };
    let targets = maps.iter().zip(names).map(target).collect::<Result<_>>()?;
    Ok((mesh, targets))
}

/// Names that are there already get the least number, from 2 on, that makes them new.
fn unique(names: Vec<String>) -> Vec<String> {
    let mut taken: Vec<String> = Vec::new();
    for name in names {
        let numbered = (2..).map(|n| format!("{name}_{n}"));
        let free = std::iter::once(name.clone()).chain(numbered).find(|n| !taken.contains(n));
        taken.push(free.unwrap_or(name));
    }
    taken
}

/// Refuses to write over what is read.
fn spare_input(job: &MorphJob, mesh: &MeshFile, frames: &[Frame]) -> Result<()> {
    let Ok(input) = mesh.path.canonicalize() else { return Ok(()) };
    let outputs = frames.iter().map(|f| f.path.as_path()).chain(job.out.as_deref()).chain(job.gif.as_deref());
    let hit = outputs.into_iter().find(|path| path.canonicalize().is_ok_and(|path| path == input));
    match hit {
        Some(path) => Err(Error::usage("this output is the source itself").file(path).remedy("choose another file")),
        None => Ok(()),
    }
}

/// The name of a file without folder and extension.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_names_are_numbered() {
        let names = ["cat", "dog", "cat", "cat_2", "cat"].map(str::to_owned).to_vec();
        assert_eq!(unique(names), ["cat", "dog", "cat_2", "cat_2_2", "cat_3"]);
    }
}
