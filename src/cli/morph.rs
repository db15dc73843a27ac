//! `homeo morph`: finished maps as morph targets.

use super::args::MorphArgs;
use super::console::Console;
use crate::app::morph::{MorphJob, MorphResult, morph};
use crate::error::{Error, Result};
use std::path::Path;
use std::process::ExitCode;

/// Runs the command.
pub fn run(args: &MorphArgs, console: &Console) -> Result<ExitCode> {
    let ends_in = |path: &Path, wanted: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(wanted));
    if let Some(out) = args.out.as_deref().filter(|out| !ends_in(out, "glb")) {
        let error = Error::usage("a morph is written as binary glTF").file(out);
        return Err(error.remedy("name a file that ends in .glb"));
    }
    if let Some(gif) = args.gif.as_deref().filter(|gif| !ends_in(gif, "gif")) {
        return Err(Error::usage("not the name of a GIF file").file(gif).remedy("name a file that ends in .gif"));
    }
    let job = MorphJob {
        folders: args.maps.clone(),
        out: args.out.clone(),
        gif: args.gif.clone(),
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
    let files = [&result.file, &result.gif].into_iter().flatten().map(String::as_str).collect::<Vec<_>>().join(", ");
    let mut text = format!(
        "{files}: {} vertices{appended}, {} triangles; morph targets: {}; texture: {}\n",
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
