//! From the files of a mesh, an image and constraints to a folder with the textured mesh.

use super::disc::{Disc, disc_of};
use super::files::{LIBRARY, Textured, textured, write_added, write_material};
use super::page::{page, scene};
use super::preview::preview;
use super::sheet::{Feature, Sheet};
use super::{ConstrainReport, constrain};
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::mesh::io::{Constraint, read_constraints, read_mesh, write_obj};
use crate::mesh::{TriMesh, VertexId};
use crate::picture::{file::format_for, read_picture};
use crate::stage::check::inspect;
use crate::stage::write::{OutputFolder, check_place};
use serde::Serialize;
use std::io::Cursor;
use std::path::PathBuf;
use std::time::Instant;

/// What is asked for.
#[derive(Clone, Debug)]
pub struct TextureJob {
    /// The mesh.
    pub mesh: PathBuf,
    /// The image.
    pub image: PathBuf,
    /// The constraints.
    pub constraints: PathBuf,
    /// Vertices of the seam that a closed mesh is cut along, if not the program chooses.
    pub seam: Option<Vec<VertexId>>,
    /// The folder of the results.
    pub out: PathBuf,
    /// The command as it was typed, for `report.html`; none if no page is wanted.
    pub command: Option<String>,
}

/// `report.json` of a textured mesh.
#[derive(Clone, Debug, Serialize)]
pub struct TextureReport {
    /// Version of the program.
    pub version: &'static str,
    /// The mesh's file.
    pub mesh: PathBuf,
    /// Its vertices and triangles.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// The image's file.
    pub image: PathBuf,
    /// Number of constraints.
    pub constraints: usize,
    /// The largest distance of a constrained vertex from its place, in units of the image's side.
    pub constraint_error: f64,
    /// Triangles that are not counter-clockwise in texture space, by exact predicate.
    pub flips: usize,
    /// How the constraints were met.
    #[serde(flatten)]
    pub constrain: ConstrainReport,
    /// Vertices of the seam that a closed mesh was cut along, in order.
    pub seam: Vec<VertexId>,
    /// Boundary loops that were filled for the computation.
    pub filled_loops: usize,
    /// Wall-clock seconds: `load`, `solve`, `write` and `total`.
    pub seconds: Seconds,
    /// What a user should know.
    pub warnings: Vec<String>,
}

/// Wall-clock seconds.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Seconds {
    /// Reading and checking.
    pub load: f64,
    /// Meeting the constraints and smoothing.
    pub solve: f64,
    /// Drawing the preview and writing, up to this report.
    pub write: f64,
    /// All of it.
    pub total: f64,
}

/// Runs the job; the folder appears complete or not at all.
///
/// # Errors
/// Input for what the files hold, unsolvable for handles, usage for a place that cannot be written to.
pub fn texture(job: &TextureJob, compute: &Compute) -> Result<TextureReport> {
    let start = Instant::now();
    check_place(&job.out)?;
    let image = read_picture(&job.image, false)?;
    let loaded = inspect(read_mesh(&job.mesh)?)?;
    let constraints = read_constraints(&job.constraints, loaded.file.positions.len())?;
    refuse_unused(&loaded.mesh, &constraints).map_err(|e| e.file(&job.constraints))?;
    let features: Vec<VertexId> = constraints.iter().map(|c| c.vertex).collect();
    let disc = disc_of(&loaded, &features, job.seam.as_deref()).map_err(|e| e.file(&job.mesh))?;
    let sheet = Sheet::new(&disc.mesh, disc.real, in_disc(&disc, &constraints))?;
    let read = start.elapsed().as_secs_f64();
    let (refined, report) = constrain(sheet, compute).map_err(|e| e.file(&job.mesh))?;
    let solved = start.elapsed().as_secs_f64();
    let folder = OutputFolder::create(&job.out)?;
    let made = textured(&loaded.file, &disc, &refined, folder.place());
    write_files(&folder, job, &made, loaded.file.positions.len())?;
    let mut png = Cursor::new(Vec::new());
    preview(&refined.sheet, &image)
        .write(format_for("preview.png".as_ref(), crate::picture::Depth::Byte)?, &mut png)?;
    folder.write("preview.png", |out| out.write_all(png.get_ref()))?;
    let shown = job.command.as_ref().map(|command| (scene(&refined, &loaded.file, &constraints, &job.image), command));
    let sheet = &refined.sheet;
    let error = sheet.features.iter().map(|f| sheet.uv[f.vertex as usize].distance(f.place)).fold(0.0, f64::max);
    let total = start.elapsed().as_secs_f64();
    let notes = loaded.file.warnings.iter().cloned().chain(loaded.report.notes());
    let report = TextureReport {
        version: env!("CARGO_PKG_VERSION"),
        mesh: job.mesh.clone(),
        vertices: loaded.file.positions.len(),
        triangles: disc.real,
        image: job.image.clone(),
        constraints: constraints.len(),
        constraint_error: error,
        flips: sheet.folded(),
        constrain: report,
        seam: disc.seam.clone(),
        filled_loops: disc.filled,
        seconds: Seconds { load: read, solve: solved - read, write: total - solved, total },
        warnings: notes.collect(),
    };
    if let Some((scene, command)) = &shown {
        folder.write("report.html", |out| out.write_all(page(scene, &report, command).as_bytes()))?;
    }
    folder.write("report.json", |out| Ok(serde_json::to_writer_pretty(out, &report)?))?;
    folder.commit()?;
    Ok(report)
}

fn refuse_unused(mesh: &TriMesh, constraints: &[Constraint]) -> Result<()> {
    let unused = constraints.iter().find(|c| mesh.conn.leaving(c.vertex).is_none());
    let Some(c) = unused else { return Ok(()) };
    Err(Error::input(format!("\"{}\" constrains {}, which no face uses", c.name, c.vertex))
        .remedy("constrain a vertex of the surface"))
}

/// The constraints on the disc's vertices.
fn in_disc(disc: &Disc, constraints: &[Constraint]) -> Vec<Feature> {
    let mut number = std::collections::HashMap::new();
    for (i, v) in (0u32..).zip(&disc.vertex_of) {
        // Features are not on the seam, so each has one vertex.
        v.map(|v| number.insert(v, i));
    }
    constraints.iter().filter_map(|c| Some(Feature { vertex: *number.get(&c.vertex)?, place: c.place })).collect()
}

fn write_files(folder: &OutputFolder, job: &TextureJob, made: &Textured, given: usize) -> Result<()> {
    let extension = job.image.extension().map_or("png".into(), |e| e.to_string_lossy().to_ascii_lowercase());
    let image = format!("image.{extension}");
    let bytes = std::fs::read(&job.image).map_err(|e| Error::io(&job.image, &e))?;
    let place = folder.place();
    folder.write("mesh.obj", |mut out| write_obj(&mut out, place, &made.file, &made.file.positions))?;
    folder.write(LIBRARY, |out| write_material(out, &image))?;
    folder.write(&image, |out| out.write_all(&bytes))?;
    folder.write("steiner.csv", |out| write_added(out, given, &made.added))
}
