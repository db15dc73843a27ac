//! `homeo transfer`: an image, or numbers by vertex, carried through a finished map.

use super::args::{Global, TransferArgs};
use super::console::Console;
use crate::app::carry_values::carry_values;
use crate::app::destination::Destination;
use crate::app::finished_map::{FinishedMap, read_finished_map};
use crate::app::texture::Textures;
use crate::app::transfer::{Journey, TransferOptions, transfer};
use crate::app::uv::UvTriangles;
use crate::error::{Error, Result};
use crate::gpu::{Device, DeviceChoice};
use crate::mesh::io::{read_vertex_table, write_vertex_table};
use crate::stage::write::write_file;
use std::path::Path;
use std::process::ExitCode;

/// Runs the command.
pub fn run(args: &TransferArgs, global: &Global, console: &Console) -> Result<ExitCode> {
    let map = read_finished_map(&args.dir, [args.source.as_deref(), args.target.as_deref()])?;
    match (&args.texture, &args.attribute) {
        (_, Some(table)) => carry_table(&map, table, args, console),
        (Some(texture), None) => carry_image(&map, texture, args, global, console),
        (None, None) => {
            Err(Error::usage("neither an image nor a table to carry").remedy("give --texture or --attribute"))
        }
    }
}

/// Carries numbers by vertex.
fn carry_table(map: &FinishedMap, table: &Path, args: &TransferArgs, console: &Console) -> Result<ExitCode> {
    if args.out.extension().is_none_or(|e| !e.eq_ignore_ascii_case("csv")) {
        return Err(Error::usage("tables are written as CSV").file(&args.out).remedy("end the name in .csv"));
    }
    let carried = carry_values(map, &read_vertex_table(table, map.meshes[0].positions.len())?);
    write_file(&args.out, |out| write_vertex_table(out, &carried))?;
    let vertices = map.meshes[1].positions.len();
    let result = serde_json::json!({ "file": args.out, "columns": carried.names, "vertices": vertices });
    console.result(&result, || format!("{}\n{vertices} vertices, {}\n", args.out.display(), carried.names.join(", ")));
    Ok(ExitCode::SUCCESS)
}

/// Carries an image.
fn carry_image(
    map: &FinishedMap,
    texture: &Path,
    args: &TransferArgs,
    global: &Global,
    console: &Console,
) -> Result<ExitCode> {
    let [source, target] = &map.meshes;
    let data = args.linear || args.normal_map;
    let textures = Textures::read(texture, &UvTriangles::of(source), data)?;
    let Ok(choice) = global.device.parse::<DeviceChoice>();
    let compute = Device::open(&choice)?.compute;
    let options = TransferOptions { size: args.size, padding: args.padding, normal_map: args.normal_map };
    let destination = Destination::of(target, &map.charts.meshes[1], map.atlas.as_ref())?;
    let journey =
        Journey { meshes: [source, target], charts: &map.charts, textures: &textures, destination: &destination };
    let report = transfer(&compute, journey, &args.out, &options)?;
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
