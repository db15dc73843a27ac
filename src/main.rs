//! The program `homeo`: arguments in, exit code out.

use std::process::ExitCode;

fn main() -> ExitCode {
    homeo::cli::run(std::env::args_os().collect())
}
