//! `homeo demo`: generated pairs through the main job.

use super::args::{DemoArgs, Global};
use super::console::Console;
use super::map::{page, run_all};
use super::summary::{PAGE, demo_summary, invitation};
use crate::error::{Error, Result};
use crate::mesh::io::{MeshFile, write_obj};
use crate::pipeline::{MapJob, MapOptions};
use crate::shape::{DEMO_PAIRS, Shape};
use crate::stage::write::check_place;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::ExitCode;

/// Vertices of the generated meshes, about: enough to show detail, few enough to be mapped in seconds.
const RESOLUTION: usize = 5_000;

/// Runs the command.
pub fn run(args: &DemoArgs, global: &Global, console: &Console) -> Result<ExitCode> {
    let mut names = Vec::new();
    let mut jobs = Vec::new();
    for pair in &DEMO_PAIRS {
        let dir = args.dir.join(pair.name);
        check_place(&dir.join("map"))?;
        let (source, target) = (pair.generate)(RESOLUTION);
        jobs.push(write_pair(&dir, &source, &target)?);
        names.push(pair.name.to_owned());
    }
    let options = MapOptions { page: page(global), ..MapOptions::default() };
    let reports = run_all(jobs, &options, global, console)?;
    let finished: Vec<_> = names.into_iter().zip(reports).collect();
    console.result(&finished, || {
        let place = format!("inputs and maps are in {}\n", args.dir.display());
        let pages: Vec<_> = finished.iter().map(|(name, _)| args.dir.join(name).join("map").join(PAGE)).collect();
        demo_summary(&finished, console) + &place + &invitation(&pages)
    });
    Ok(ExitCode::SUCCESS)
}

/// Writes both meshes and their landmarks into `dir`; the map goes into `dir/map`.
fn write_pair(dir: &Path, source: &Shape, target: &Shape) -> Result<MapJob> {
    let job = MapJob {
        source: dir.join("source.obj"),
        target: dir.join("target.obj"),
        landmarks: dir.join("landmarks.csv"),
        target_landmarks: None,
        hint: None,
        texture: None,
        out: dir.join("map"),
    };
    fs::create_dir_all(dir).map_err(|e| Error::io(dir, &e))?;
    write_shape(&job.source, source)?;
    write_shape(&job.target, target)?;
    write_file(&job.landmarks, |out| {
        writeln!(out, "name,source_vertex,target_vertex")?;
        for ((name, s), (_, t)) in source.landmarks.iter().zip(&target.landmarks) {
            writeln!(out, "{name},{},{}", s.0, t.0)?;
        }
        Ok(())
    })?;
    Ok(job)
}

fn write_shape(path: &Path, shape: &Shape) -> Result<()> {
    let file = MeshFile::of(&shape.mesh);
    write_file(path, |out| write_obj(out, Path::new(""), &file, &file.positions))
}

fn write_file(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>) -> Result<()> {
    let written = || {
        let mut out = BufWriter::new(File::create(path)?);
        fill(&mut out)?;
        out.flush()
    };
    written().map_err(|e| Error::io(path, &e))
}
