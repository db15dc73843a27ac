//! A finished map, read back from its folder and from the files of its meshes.

use crate::error::{Error, Result};
use crate::map::charts::{Charts, MAP_FILE, fingerprint};
use crate::mesh::io::{MeshFile, read_mesh};
use crate::stage::write::folder::REPORT_FILE;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A finished map.
#[derive(Clone, Debug)]
pub struct FinishedMap {
    /// The source and the target as they were mapped.
    pub meshes: [MeshFile; 2],
    /// The map at every point.
    pub charts: Charts,
}

#[derive(Deserialize)]
struct Report {
    source: Side,
    target: Side,
}

#[derive(Deserialize)]
struct Side {
    file: PathBuf,
}

/// Reads the folder of a finished map; `moved` says where the source or the target is now, if not where the report has it.
///
/// # Errors
/// Input, if the folder holds no finished map, a mesh is not found, or it is not the one that was mapped.
pub fn read_finished_map(dir: &Path, moved: [Option<&Path>; 2]) -> Result<FinishedMap> {
    let no_map = |file: &Path| {
        Error::input("not a folder of a finished map").file(file).remedy("name the --out folder of `homeo map`")
    };
    let text = std::fs::read(dir.join(REPORT_FILE)).map_err(|_| no_map(dir))?;
    let report: Report = serde_json::from_slice(&text).map_err(|_| no_map(&dir.join(REPORT_FILE)))?;
    let path = dir.join(MAP_FILE);
    let bytes = std::fs::read(&path).map_err(|e| Error::io(&path, &e).remedy("map the pair again"))?;
    let charts = Charts::decode(&bytes).map_err(|e| e.file(&path))?;
    let mesh = |k: usize, flag: &str, side: &Side| -> Result<MeshFile> {
        let file = moved[k].unwrap_or(&side.file);
        if !file.is_file() {
            let what = "the mesh that was mapped is not there";
            return Err(Error::input(what).file(file).remedy(format!("say where it is with {flag}")));
        }
        let mesh = read_mesh(file)?;
        if fingerprint(&mesh) != charts.meshes[k].fingerprint {
            let what = "the mesh is not the one that was mapped";
            return Err(Error::input(what).file(file).remedy(format!("map it again, or name the other with {flag}")));
        }
        Ok(mesh)
    };
    let meshes = [mesh(0, "--source", &report.source)?, mesh(1, "--target", &report.target)?];
    Ok(FinishedMap { meshes, charts })
}
