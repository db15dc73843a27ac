//! Flags and commands that are promised but not built yet are refused, and say so.

use super::args::{Command, MapFlags};
use crate::error::{Error, Result};

/// Fails for a command that comes later.
pub fn refuse_command(command: &Command) -> Result<()> {
    let name = match command {
        Command::Texture(_) => "texture",
        Command::Diffuse(_) => "diffuse",
        Command::Bake(_) => "bake",
        Command::Transfer(_) => "transfer",
        Command::Batch(_) => "batch",
        Command::Demo(_)
        | Command::Map(_)
        | Command::Check(_)
        | Command::Measure(_)
        | Command::Morph(_)
        | Command::Devices => return Ok(()),
    };
    Err(later(&format!("the command '{name}'"), "see homeo --help for what works today"))
}

/// Fails for a flag of `map` that comes later.
pub fn refuse_flags(flags: &MapFlags) -> Result<()> {
    let refused = [(flags.texture.is_some(), "--texture", "leave it out")];
    match refused.into_iter().find(|&(is_asked_for, ..)| is_asked_for) {
        Some((_, flag, remedy)) => Err(later(flag, remedy)),
        None => Ok(()),
    }
}

fn later(what: &str, remedy: &str) -> Error {
    Error::usage(format!("{what} comes with a later version")).remedy(remedy)
}
