//! Commands that are promised but not built yet are refused, and say so.

use super::args::Command;
use crate::error::{Error, Result};

/// Fails for a command that comes later.
pub fn refuse_command(command: &Command) -> Result<()> {
    let name = match command {
        Command::Batch(_) => "batch",
        Command::Demo(_)
        | Command::Diffuse(_)
        | Command::Transfer(_)
        | Command::Bake(_)
        | Command::Map(_)
        | Command::Check(_)
        | Command::Measure(_)
        | Command::Morph(_)
        | Command::Texture(_)
        | Command::Devices => {
            return Ok(());
        }
    };
    Err(later(&format!("the command '{name}'"), "see homeo --help for what works today"))
}

fn later(what: &str, remedy: &str) -> Error {
    Error::usage(format!("{what} comes with a later version")).remedy(remedy)
}
