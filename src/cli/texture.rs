//! `homeo texture`: texture coordinates with hard constraints.

use super::args::{Global, TextureArgs};
use super::console::Console;
use super::map::page;
use super::summary::{PAGE, invitation};
use crate::app::constrained::job::{TextureJob, TextureReport, texture};
use crate::error::Result;
use crate::gpu::{Device, DeviceChoice};
use std::process::ExitCode;

/// Runs the command.
pub fn run(args: &TextureArgs, global: &Global, console: &Console) -> Result<ExitCode> {
    let Ok(choice) = global.device.parse::<DeviceChoice>();
    let compute = Device::open(&choice)?.compute;
    let job = TextureJob {
        mesh: args.mesh.clone(),
        image: args.image.clone(),
        constraints: args.constraints.clone(),
        seam: args.seam.clone(),
        out: args.out.clone(),
        command: page(global).map(|page| page.command),
    };
    let report = texture(&job, &compute)?;
    report.warnings.iter().for_each(|w| console.warn(w));
    console.result(&report, || summary(&report, args) + &invitation(&[args.out.join(PAGE)]));
    Ok(ExitCode::SUCCESS)
}

fn summary(report: &TextureReport, args: &TextureArgs) -> String {
    let [before, after] = report.constrain.steiner;
    let [met, smooth] = report.constrain.e_l2;
    let how = if report.constrain.carried > 0 {
        format!("carried {} times, {before} Steiner vertices, of which {after} stay", report.constrain.carried)
    } else {
        "all walked there, no vertex added".to_owned()
    };
    format!(
        "{}\n{} constraints met exactly, {} flips\n{how}\nE_L2 {met:.3}, smoothed {smooth:.3}\n{:.2} s\n",
        args.out.join("mesh.obj").display(),
        report.constraints,
        report.flips,
        report.seconds.total
    )
}
