//! A finished map, read back from its folder and from the files of its meshes.

use super::map_folder::{MapFolder, read_mapped};
use crate::error::{Error, Result};
use crate::map::atlas::Atlas;
use crate::map::charts::Charts;
use crate::map::tile_table::TileTable;
use crate::mesh::io::MeshFile;
use serde::Deserialize;
use std::path::Path;

/// A finished map.
#[derive(Clone, Debug)]
pub struct FinishedMap {
    /// The source and the target as they were mapped.
    pub meshes: [MeshFile; 2],
    /// The map at every point.
    pub charts: Charts,
    /// The common atlas, unless there are no geometry images.
    pub atlas: Option<Atlas>,
}

#[derive(Deserialize)]
struct Layout {
    atlas: Option<TileTable>,
}

/// Reads the folder of a finished map; `moved` says where the source or the target is now, if not where the report has it.
///
/// # Errors
/// Input, if the folder holds no finished map, a mesh is not found, or it is not the one that was mapped.
pub fn read_finished_map(dir: &Path, moved: [Option<&Path>; 2]) -> Result<FinishedMap> {
    let folder = MapFolder::open(dir)?;
    let charts = folder.read_charts()?;
    let mesh = |k: usize, flag| read_mapped(moved[k].unwrap_or(folder.mesh(k)), charts.meshes[k].fingerprint, flag);
    let meshes = [mesh(0, "--source")?, mesh(1, "--target")?];
    let atlas = read_atlas(&dir.join(LAYOUT_FILE))?;
    Ok(FinishedMap { meshes, charts, atlas })
}

/// The file with the layout and the atlas.
const LAYOUT_FILE: &str = "layout.json";

fn read_atlas(path: &Path) -> Result<Option<Atlas>> {
    let text = std::fs::read(path).map_err(|e| Error::io(path, &e))?;
    let damaged = |e: serde_json::Error| Error::input(e.to_string()).file(path).remedy("map the pair again");
    let layout: Layout = serde_json::from_slice(&text).map_err(damaged)?;
    let parts = layout.atlas.map(|table| table.parts()).transpose().map_err(|e| e.file(path))?;
    Ok(parts.map(|(atlas, _)| atlas))
}
