//! `homeo check`: what is wrong with meshes and landmarks, element by element.

use super::args::CheckArgs;
use super::console::{Console, error_object};
use crate::error::{Error, ErrorKind, Result};
use crate::mesh::check::{Report, check};
use crate::mesh::io::{Landmarks, MeshFile, read_landmarks, read_mesh};
use crate::stage;
use serde_json::{Value, json};
use std::path::Path;
use std::process::ExitCode;

/// One mesh file and what was found in it.
struct Checked<'a> {
    path: &'a Path,
    found: Result<(MeshFile, Report)>,
}

/// Runs the command. Faults are its result, not its failure: they go to stdout, and the exit code is that of bad input.
pub fn run(args: &CheckArgs, console: &Console) -> Result<ExitCode> {
    if args.landmarks.is_some() && args.meshes.len() != 2 {
        let error = Error::usage("--landmarks needs two meshes, the source and the target");
        return Err(error.remedy("homeo check SOURCE TARGET --landmarks FILE"));
    }
    let meshes: Vec<Checked> = args.meshes.iter().map(|path| Checked { path, found: read_and_check(path) }).collect();
    let landmarks = args.landmarks.as_deref().and_then(|path| Some((path, check_landmarks(path, &meshes)?)));
    let is_sound = meshes.iter().all(Checked::is_sound) && landmarks.as_ref().is_none_or(|(_, l)| l.is_ok());
    let value = json!({
        "sound": is_sound,
        "meshes": meshes.iter().map(Checked::value).collect::<Vec<_>>(),
        "landmarks": landmarks.as_ref().map(landmarks_value),
    });
    console.result(&value, || {
        meshes.iter().map(Checked::text).chain(landmarks.as_ref().map(landmarks_text)).collect::<String>()
    });
    Ok(if is_sound { ExitCode::SUCCESS } else { ExitCode::from(ErrorKind::Input.exit_code()) })
}

fn read_and_check(path: &Path) -> Result<(MeshFile, Report)> {
    let file = read_mesh(path)?;
    let report = check(&file.positions, &file.triangles());
    Ok((file, report))
}

/// None if a mesh could not be read: then there is nothing to check landmarks against.
fn check_landmarks(path: &Path, meshes: &[Checked]) -> Option<Result<Landmarks>> {
    let [source, target] = meshes else { return None };
    let (source, target) = (source.found.as_ref().ok()?, target.found.as_ref().ok()?);
    Some(read_landmarks(path, None, &source.0, &target.0).and_then(|mut landmarks| {
        if let (Some(source), Some(target)) = (source.1.mesh(), target.1.mesh()) {
            landmarks.notes.extend(stage::check::check_landmarks([source, target], &landmarks)?);
        }
        Ok(landmarks)
    }))
}

impl Checked<'_> {
    fn is_sound(&self) -> bool {
        self.found.as_ref().is_ok_and(|(_, report)| report.faults.is_empty())
    }

    fn value(&self) -> Value {
        let mut value = match &self.found {
            Ok((_, report)) => json!(report),
            Err(e) => error_object(e),
        };
        value["file"] = json!(self.path);
        if let Ok((file, report)) = &self.found {
            let faults: Vec<String> = report.faults.iter().map(ToString::to_string).collect();
            value["messages"] = json!({ "faults": faults, "notes": report.notes(), "file": file.warnings });
        }
        value
    }

    fn text(&self) -> String {
        match &self.found {
            Ok((file, report)) => {
                let mut text = format!("{}: {report}\n", self.path.display());
                for warning in &file.warnings {
                    text += &format!("warning: {warning}\n");
                }
                text
            }
            Err(e) => format!("fault: {e}\n"),
        }
    }
}

fn landmarks_value((path, found): &(&Path, Result<Landmarks>)) -> Value {
    let mut value = match found {
        Ok(l) => json!({ "count": l.names.len(), "notes": l.notes }),
        Err(e) => error_object(e),
    };
    value["file"] = json!(path);
    value
}

fn landmarks_text((path, found): &(&Path, Result<Landmarks>)) -> String {
    match found {
        Ok(l) => {
            let mut text = format!("{}: {} landmarks\n", path.display(), l.names.len());
            for note in &l.notes {
                text += &format!("warning: {note}\n");
            }
            text
        }
        Err(e) => format!("fault: {e}\n"),
    }
}
