//! `homeo diffuse`: (u, v) per region, and region-wise maps.

use super::args::{DiffuseArgs, FrontChoice, Global};
use super::console::Console;
use super::map::page;
use super::summary::{PAGE, invitation};
use super::table::table;
use crate::app::diffusion::job::{DiffuseJob, Onto, RegionSource, TextureJob, run as run_job};
use crate::app::diffusion::{DiffusionOptions, DiffusionReport};
use crate::error::{Error, Result};
use crate::gpu::{Compute, Device, DeviceChoice};
use crate::path::side_front::Travel;
use std::process::ExitCode;

/// Runs the command.
pub fn run(args: &DiffuseArgs, global: &Global, console: &Console) -> Result<ExitCode> {
    let regions = match (&args.regions, args.segment) {
        (Some(file), _) => RegionSource::File(file.clone()),
        (None, Some(count)) => RegionSource::Segment(count),
        (None, None) => return Err(Error::usage("no regions").remedy("give --regions or --segment")),
    };
    let onto = match (&args.onto, &args.onto_regions, &args.onto_map) {
        (Some(mesh), Some(regions), _) => Some(Onto::Regions { mesh: mesh.clone(), regions: regions.clone() }),
        (_, _, Some(map)) => Some(Onto::Map(map.clone())),
        _ => None,
    };
    let travel = match args.front {
        FrontChoice::Edge => Travel::Edges,
        FrontChoice::Face => Travel::Faces,
    };
    let job = DiffuseJob {
        mesh: args.mesh.clone(),
        regions,
        split_ends: args.split_ends,
        options: DiffusionOptions { travel, repair: args.repair },
        onto,
        texture: args.texture.clone().map(|image| TextureJob { image, size: args.size, padding: args.padding }),
        out: args.out.clone(),
        command: page(global).map(|page| page.command),
    };
    let report = run_job(&job, &|| compute(global))?;
    report.warnings.iter().for_each(|w| console.warn(w));
    console.result(&report, || summary(&report, args) + &invitation(&[args.out.join(PAGE)]));
    Ok(ExitCode::SUCCESS)
}

/// The device, which only textures need.
fn compute(global: &Global) -> Result<Compute> {
    let Ok(choice) = global.device.parse::<DeviceChoice>();
    Ok(Device::open(&choice)?.compute)
}

fn summary(report: &DiffusionReport, args: &DiffuseArgs) -> String {
    let meshes = std::iter::once(&report.mesh).chain(&report.onto);
    let mut text = String::new();
    for mesh in meshes {
        text += &format!("{}: {} vertices, {} regions\n", mesh.mesh.file, mesh.mesh.vertices, mesh.regions.len());
        let header = ["region", "vertices", "folds", "E_L2", "E_ang", "jitter"];
        let mut rows = vec![header.map(String::from).to_vec()];
        rows.extend(mesh.regions.iter().map(|r| {
            let folds = (r.quality.folds.len() + r.quality.flat.len()).to_string();
            let m = &r.quality.measures;
            let numbers = [m.e_l2, m.e_ang, r.quality.jitter].map(|x| format!("{x:.3}"));
            [r.name.clone(), r.vertices.to_string(), folds].into_iter().chain(numbers).collect()
        }));
        text += &format!("{}\n", table(&rows));
    }
    if let Some(d) = &report.distortion {
        let m = d.forward;
        text +=
            &format!("map onto the second mesh: E_L2 {:.3}, E_ang {:.3}, turned over {}\n", m.e_l2, m.e_ang, m.flips);
    }
    text + &format!("written to {}\n", args.out.display())
}
