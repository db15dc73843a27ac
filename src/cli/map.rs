//! `homeo map`: the main job on one pair.

use super::args::{Global, LayoutChoice, MapArgs, MapFlags, RefineChoice, RelaxChoice};
use super::console::Console;
use super::progress;
use super::summary::map_summary;
use crate::error::{Error, Result};
use crate::gpu::{Device, DeviceChoice};
use crate::map::report::Report;
use crate::pipeline::{LayoutMethod, MapJob, MapOptions, PageOptions, Relaxation, run_maps};
use crate::stage::refine::RefineOptions;
use crate::stage::write::check_place;
use std::process::ExitCode;

/// Runs the command.
pub fn run(args: &MapArgs, global: &Global, console: &Console) -> Result<ExitCode> {
    let options = options(&args.options, global)?;
    check_place(&args.out)?;
    let job = MapJob {
        source: args.source.clone(),
        target: args.target.clone(),
        landmarks: args.landmarks.clone(),
        target_landmarks: args.target_landmarks.clone(),
        hint: args.hint.clone(),
        texture: args.texture.clone(),
        out: args.out.clone(),
    };
    let report = run_all(vec![job], &options, global, console)?.remove(0);
    console.result(&report, || map_summary(&report, &args.out, console));
    Ok(ExitCode::SUCCESS)
}

/// What the flags of the main job mean.
pub fn options(flags: &MapFlags, global: &Global) -> Result<MapOptions> {
    let relax = match flags.relax {
        RelaxChoice::None => Relaxation::None,
        RelaxChoice::Patch => Relaxation::Patch,
        RelaxChoice::Full => Relaxation::Full,
    };
    let layout = match flags.layout {
        LayoutChoice::Voronoi => LayoutMethod::Voronoi,
        LayoutChoice::Hypothesis => LayoutMethod::Hypothesis { cycles: flags.cycles },
        LayoutChoice::Greedy => LayoutMethod::Greedy,
    };
    let refine = (flags.refine == RefineChoice::Active).then_some(RefineOptions {
        whisker: flags.refine_whisker,
        salience: flags.refine_salience,
        most: flags.refine_most,
    });
    Ok(MapOptions {
        layout,
        relax,
        tolerance: flags.tolerance,
        refine,
        image: flags.image,
        layered: flags.layered,
        seed: global.seed,
        page: page(global),
    })
}

/// What the page says besides the result; none if it is not wanted.
pub fn page(global: &Global) -> Option<PageOptions> {
    (!global.no_report).then(|| PageOptions { command: global.command.clone() })
}

/// Runs jobs to the end with progress on stderr; one report per job, or the first error. Warnings are printed.
pub fn run_all(jobs: Vec<MapJob>, options: &MapOptions, global: &Global, console: &Console) -> Result<Vec<Report>> {
    let Ok(choice) = global.device.parse::<DeviceChoice>();
    let device = Device::open(&choice)?;
    let count = jobs.len();
    let mut outcomes = Vec::with_capacity(count);
    {
        let observer = progress::observer(global, count);
        run_maps(jobs, options, &device, observer.as_ref(), |outcome| outcomes.push(outcome));
    }
    outcomes.sort_by_key(|outcome| outcome.id);
    let reports = outcomes.into_iter().map(|outcome| outcome.value).collect::<Result<Vec<Report>>>()?;
    if reports.len() != count {
        return Err(Error::bug(format!("{} of {count} jobs came to an end", reports.len())));
    }
    for warning in reports.iter().flat_map(|r| &r.warnings) {
        console.warn(warning);
    }
    Ok(reports)
}
