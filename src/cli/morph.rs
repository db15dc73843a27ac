//! `homeo morph`: finished maps as morph targets.

use super::args::MorphArgs;
use super::console::Console;
use crate::app::morph::{MorphJob, MorphResult, morph};
use crate::error::{Error, Result};
use std::process::ExitCode;

/// Runs the command.
pub fn run(args: &MorphArgs, console: &Console) -> Result<ExitCode> {
    if !args.out.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb")) {
        let error = Error::usage("a morph is written as binary glTF").file(&args.out);
        return Err(error.remedy("name a file that ends in .glb"));
    }
    let job = MorphJob {
        folders: args.maps.clone(),
        out: args.out.clone(),
        frames: args.frames.map(|n| n as usize),
        texture: args.texture.clone(),
        source: args.source.clone(),
    };
    let result = morph(&job)?;
    for warning in &result.warnings {
        console.warn(warning);
    }
    console.result(&result, || summary(&result));
    Ok(ExitCode::SUCCESS)
}

fn summary(result: &MorphResult) -> String {
    let appended = match result.appended {
        0 => String::new(),
        n => format!(" and {n} more along seams"),
    };
    let mut text = format!(
        "{}: {} vertices{appended}, {} triangles; morph targets: {}; texture: {}\n",
        result.file,
        result.vertices,
        result.faces,
        result.targets.join(", "),
        result.texture.as_deref().unwrap_or("none")
    );
    if let [first, .., last] = result.frames.as_slice() {
        text += &format!("{first} to {last}: {} steps\n", result.frames.len());
    }
    text
}
