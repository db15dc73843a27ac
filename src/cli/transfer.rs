//! `homeo transfer`: an image carried through a finished map.

use super::args::{Global, TransferArgs};
use super::console::Console;
use crate::app::finished_map::read_finished_map;
use crate::app::texture::Textures;
use crate::app::transfer::{TransferOptions, transfer};
use crate::app::uv::UvTriangles;
use crate::error::Result;
use crate::gpu::{Device, DeviceChoice};
use std::process::ExitCode;

/// Runs the command.
pub fn run(args: &TransferArgs, global: &Global, console: &Console) -> Result<ExitCode> {
    let map = read_finished_map(&args.dir, [args.source.as_deref(), args.target.as_deref()])?;
    let [source, target] = &map.meshes;
    let data = args.linear || args.normal_map;
    let textures = Textures::read(&args.texture, &UvTriangles::of(source), data)?;
    let Ok(choice) = global.device.parse::<DeviceChoice>();
    let compute = Device::open(&choice)?.compute;
    let options = TransferOptions { size: args.size, padding: args.padding, normal_map: args.normal_map };
    let report = transfer(&compute, [source, target], &map.charts, &textures, &args.out, &options)?;
    if report.unfilled > 0 {
        console.warn(&format!(
            "{} of {} texels have no counterpart with texture coordinates on the source and stay black",
            report.unfilled, report.covered
        ));
    }
    console.result(&report, || {
        let files: Vec<String> = report.files.iter().map(|f| format!("{}\n", f.display())).collect();
        format!("{}{} texels covered\n", files.concat(), report.covered)
    });
    Ok(ExitCode::SUCCESS)
}
