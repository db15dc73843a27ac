//! `homeo bake`: maps of a mesh in its own texture coordinates.

use super::args::{BakeArgs, CompressionChoice, Global, MapChoice};
use super::console::Console;
use crate::app::attributes::BakeMap;
use crate::app::bake::{BakeOptions, BakeReport, Oddity, bake};
use crate::error::{Error, Result};
use crate::gpu::{Device, DeviceChoice};
use crate::mesh::io::read_mesh;
use crate::stage::exr::Compression;
use std::process::ExitCode;

/// Runs the command.
pub fn run(args: &BakeArgs, global: &Global, console: &Console) -> Result<ExitCode> {
    if args.out.extension().is_none_or(|e| !e.eq_ignore_ascii_case("exr")) {
        return Err(Error::usage("baked maps are EXR files").file(&args.out).remedy("end the name in .exr"));
    }
    let map = match args.map {
        MapChoice::Position => BakeMap::Position,
        MapChoice::Normal => BakeMap::Normal,
        MapChoice::Tangent => BakeMap::Tangent,
        MapChoice::Curvature => BakeMap::Curvature,
        MapChoice::Distortion => BakeMap::Distortion,
    };
    let compression = match args.compression {
        CompressionChoice::None => Compression::None,
        CompressionChoice::Rle => Compression::Rle,
        CompressionChoice::Zip => Compression::Zip,
        CompressionChoice::Piz => Compression::Piz,
    };
    let mesh = args.mesh.as_deref().ok_or_else(|| Error::bug("a bake without a mesh"))?;
    let mesh = read_mesh(mesh)?;
    let Ok(choice) = global.device.parse::<DeviceChoice>();
    let compute = Device::open(&choice)?.compute;
    let options = BakeOptions { map, size: args.size, padding: args.padding, compression };
    let report = bake(&compute, &mesh, &args.out, &options)?;
    warnings(&report).iter().for_each(|w| console.warn(w));
    console.result(&report, || {
        let files: Vec<String> = report.files.iter().map(|f| format!("{}\n", f.display())).collect();
        format!("{}{} texels covered\n", files.concat(), report.covered)
    });
    Ok(ExitCode::SUCCESS)
}

/// What is odd about the texture coordinates, in words.
fn warnings(report: &BakeReport) -> Vec<String> {
    let word = |Oddity { count, face }: Oddity, what: &str| {
        let face = face.map_or(String::new(), |f| format!(" (such as face {f}, counted from 0)"));
        (count > 0).then(|| format!("{count} {what}{face}"))
    };
    [
        word(report.overlapping, "texels are covered by several triangles, of which the first shows"),
        word(report.flipped, "triangles are turned over in texture space"),
        word(report.missing, "triangles have no texture coordinates and are left out"),
        word(report.outside, "triangles reach beyond the unit square: put <UDIM> into the file's name for all tiles"),
    ]
    .into_iter()
    .flatten()
    .collect()
}
