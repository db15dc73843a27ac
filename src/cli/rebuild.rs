//! `homeo bake --rebuild`: a geometry image read back as a mesh.

use super::args::{BakeArgs, LayerChoice};
use super::console::Console;
use crate::app::rebuild::{Layer, PositionImage, rebuild};
use crate::error::{Error, Result};
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;

/// What the command prints.
#[derive(Serialize)]
struct Summary {
    out: String,
    vertices: usize,
    faces: usize,
    genus: i64,
    boundary_loops: usize,
}

/// Runs the command on a geometry image.
pub fn run(image: &Path, args: &BakeArgs, console: &Console) -> Result<ExitCode> {
    check_extension(&args.out)?;
    let layer = args.layer.map(|choice| match choice {
        LayerChoice::Source => Layer::Source,
        LayerChoice::Target => Layer::Target,
    });
    let rebuilt = rebuild(&PositionImage::open(image, layer)?).map_err(|error| error.file(image))?;
    rebuilt.write(&args.out)?;
    let summary = Summary {
        out: args.out.display().to_string(),
        vertices: rebuilt.mesh.positions.len(),
        faces: rebuilt.mesh.conn.face_count(),
        genus: rebuilt.mesh.genus(),
        boundary_loops: rebuilt.mesh.conn.boundary_loops().len(),
    };
    console.result(&summary, || {
        let Summary { out, vertices, faces, genus, boundary_loops } = &summary;
        format!("{out}: {vertices} vertices, {faces} faces, genus {genus}, {boundary_loops} boundary loops\n")
    });
    Ok(ExitCode::SUCCESS)
}

fn check_extension(out: &Path) -> Result<()> {
    if out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj")) {
        return Ok(());
    }
    Err(Error::usage("a mesh is written as OBJ only").file(out).remedy("name a file that ends in .obj"))
}
