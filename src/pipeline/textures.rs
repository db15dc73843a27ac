//! What a finished map carries along besides geometry images: the map at every point, and the source's texture.

use crate::app::atlas_mesh::atlas_mesh;
use crate::app::attributes::require_uv;
use crate::app::canvas::Padding;
use crate::app::destination::Destination;
use crate::app::texture::Textures;
use crate::app::transfer::{Journey, TransferOptions, TransferReport, carry};
use crate::app::udim::{file_of, is_pattern};
use crate::app::uv::UvTriangles;
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::map::atlas::Atlas;
use crate::map::charts::{ChartedMesh, Charts, MAP_FILE};
use crate::map::embedding::EmbeddedMesh;
use crate::map::file_order::Onto;
use crate::map::product::{GeometryImages, NamedFile};
use crate::mesh::io::{MeshFile, write_obj};
use crate::picture::{Depth, file::format_for};
use crate::stage::check::{Checked, LoadedMesh};
use crate::stage::compose::Composed;
use std::io::Cursor;
use std::path::Path;

/// Texels that are filled around what triangles cover.
const PADDING: Padding = Padding::Texels(16);
/// The target with the atlas as its texture coordinates, where it has none of its own.
const ATLAS_MESH: &str = "target_atlas.obj";

/// Fails early for a texture that cannot be carried: a file that is missing, a source without texture coordinates.
pub fn check_texture(texture: &Path, source: &MeshFile) -> Result<()> {
    require_uv(source)?;
    if is_pattern(texture) || texture.is_file() {
        return Ok(());
    }
    Err(Error::input("the texture is not there").file(texture).remedy("check the path"))
}

/// Names and contents of the further files of a finished map, and what the user should know about them.
pub fn further_files(
    compute: &Compute,
    checked: &Checked,
    composed: &Composed,
    images: Option<&GeometryImages>,
    texture: Option<&Path>,
) -> Result<(Vec<NamedFile>, Vec<String>)> {
    let embedded = &composed.embedding.meshes;
    let charts = Charts { meshes: [charted(&checked.source, &embedded[0]), charted(&checked.target, &embedded[1])] };
    let mut files = vec![(MAP_FILE.to_owned(), charts.encode()?)];
    let atlas = images.map(|images| images.table.parts()).transpose()?.map(|(atlas, _)| atlas);
    let target = &checked.target;
    if let Some(atlas) = atlas.as_ref().filter(|_| target.file.uv.values.is_empty()) {
        let mesh = atlas_mesh(&embedded[1], &target.file, &target.canonical, atlas);
        let mut bytes = Vec::new();
        let written = write_obj(&mut bytes, Path::new(""), &mesh, &mesh.positions);
        written.map_err(|e| Error::bug(e.to_string()))?;
        files.push((ATLAS_MESH.to_owned(), bytes));
    }
    let mut notes = Vec::new();
    if let Some(texture) = texture {
        let report = carried(compute, checked, &charts, atlas.as_ref(), texture, &mut files)?;
        notes.extend((report.unfilled > 0).then(|| {
            let TransferReport { unfilled, covered, .. } = report;
            format!(
                "{unfilled} of {covered} texels of the target's texture have no counterpart with texture coordinates"
            )
        }));
    }
    Ok((files, notes))
}

/// An embedded mesh in terms of its file.
fn charted(LoadedMesh { file, mesh, omitted, canonical, .. }: &LoadedMesh, embedded: &EmbeddedMesh) -> ChartedMesh {
    ChartedMesh::new(embedded, file, canonical, Onto { mesh, triangles: &file.triangles(), omitted })
}

/// The source's texture on the target.
fn carried(
    compute: &Compute,
    checked: &Checked,
    charts: &Charts,
    atlas: Option<&Atlas>,
    texture: &Path,
    files: &mut Vec<NamedFile>,
) -> Result<TransferReport> {
    let meshes = [&checked.source.file, &checked.target.file];
    let textures = Textures::read(texture, &UvTriangles::of(meshes[0]), false)?;
    let destination = Destination::of(meshes[1], &charts.meshes[1], atlas)?;
    let extension = if textures.depth() == Depth::Float { "exr" } else { "png" };
    // A target whose texture coordinates lie in several tiles gets an image for each.
    let several = destination.uv().tiles().len() > 1;
    let name =
        if several { format!("target_texture.<UDIM>.{extension}") } else { format!("target_texture.{extension}") };
    let name = Path::new(&name);
    let format = format_for(name, textures.depth())?;
    let journey = Journey { meshes, charts, textures: &textures, destination: &destination };
    let options = TransferOptions { size: None, padding: PADDING, normal_map: false };
    carry(compute, journey, several, &options, |tile, picture| {
        let mut bytes = Cursor::new(Vec::new());
        picture.write(format, &mut bytes)?;
        files.push((file_of(name, tile)?.display().to_string(), bytes.into_inner()));
        Ok(())
    })
}
