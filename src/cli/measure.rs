//! `homeo measure`: the distortion of a compatible mesh as JSON.

use super::args::MeasureArgs;
use super::console::{Console, print_json};
use crate::error::{Error, Result};
use crate::map::distortion::{Distortion, distortion};
use crate::map::flips::local_flips;
use crate::mesh::io::read_mesh;
use crate::mesh::{FaceId, Id, IdVec};
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;

#[derive(Serialize)]
struct Measurement {
    source: String,
    compatible: String,
    vertices: usize,
    faces: usize,
    #[serde(flatten)]
    distortion: Distortion,
}

/// Runs the command. Turned-over triangles are found against their surroundings: the target is not at hand.
pub fn run(args: &MeasureArgs, _: &Console) -> Result<ExitCode> {
    let (source, compatible) = (read_mesh(&args.source)?, read_mesh(&args.compatible)?);
    let (faces, images) = (source.triangles(), compatible.triangles());
    let counts = (source.positions.len(), faces.len());
    let compatible_counts = (compatible.positions.len(), images.len());
    if counts != compatible_counts {
        let what = format!(
            "{} vertices and {} triangles, but the source has {} and {}",
            compatible_counts.0, compatible_counts.1, counts.0, counts.1
        );
        return Err(not_compatible(&args.compatible, what));
    }
    if let Some(i) = (0..faces.len()).find(|&i| faces[i] != images[i]) {
        return Err(not_compatible(&args.compatible, "not the source's triangles".into()).at(FaceId::new(i)));
    }
    let (before, after) = (IdVec::from_raw(source.positions), IdVec::from_raw(compatible.positions));
    let flips = local_flips(&faces, &after).len();
    print_json(&Measurement {
        source: args.source.display().to_string(),
        compatible: args.compatible.display().to_string(),
        vertices: counts.0,
        faces: counts.1,
        distortion: distortion(&faces, &before, &after, flips),
    });
    Ok(ExitCode::SUCCESS)
}

fn not_compatible(file: &Path, what: String) -> Error {
    Error::input(what).file(file).remedy("the compatible mesh must have the source's vertices and faces in their order")
}
