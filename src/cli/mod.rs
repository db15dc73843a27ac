//! The command line: what was typed, what it means, what is printed.

mod args;
mod bake;
mod batch;
mod check;
mod console;
mod demo;
mod devices;
mod diffuse;
mod map;
mod measure;
mod morph;
mod progress;
mod rebuild;
mod summary;
mod table;
mod texture;
mod transfer;

use crate::error::{Error, Result};
use crate::pipeline::{install_panic_hook, message_of};
use args::{Cli, Command, Global};
use clap::Parser;
use clap::error::ErrorKind;
use console::Console;
use std::ffi::OsString;
use std::panic::catch_unwind;
use std::process::ExitCode;

/// Runs the program on its arguments, the program's name first; the exit code says how it went.
pub fn run(arguments: Vec<OsString>) -> ExitCode {
    install_panic_hook();
    let mut cli = match Cli::try_parse_from(&arguments) {
        Ok(cli) => cli,
        Err(e) => return refuse_arguments(&e, &arguments),
    };
    cli.global.command = typed(&arguments);
    let console = Console::new(&cli.global);
    let outcome = catch_unwind(|| dispatch(&cli, &arguments, &console));
    let result = outcome.unwrap_or_else(|payload| Err(Error::bug(message_of(payload.as_ref()))));
    match result {
        Ok(code) => code,
        Err(error) => {
            console.error(&error);
            ExitCode::from(error.kind.exit_code())
        }
    }
}

fn dispatch(cli: &Cli, arguments: &[OsString], console: &Console) -> Result<ExitCode> {
    set_threads(&cli.global)?;
    match &cli.command {
        Command::Map(args) => map::run(args, &cli.global, console),
        Command::Demo(args) => demo::run(args, &cli.global, console),
        Command::Check(args) => check::run(args, console),
        Command::Measure(args) => measure::run(args, console),
        Command::Morph(args) => morph::run(args, console),
        Command::Diffuse(args) => diffuse::run(args, &cli.global, console),
        Command::Devices => devices::run(&cli.global, console),
        Command::Transfer(args) => transfer::run(args, &cli.global, console),
        Command::Bake(args) => match &args.rebuild {
            Some(image) => rebuild::run(image, args, console),
            None => bake::run(args, &cli.global, console),
        },
        Command::Texture(args) => texture::run(args, &cli.global, console),
        Command::Batch(args) => batch::run(args, arguments, &cli.global, console),
    }
}

/// The arguments as one line for a shell, the program by its name alone.
fn typed(arguments: &[OsString]) -> String {
    let quoted = |argument: &OsString| {
        let text = argument.to_string_lossy();
        let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
        if !text.is_empty() && text.chars().all(is_plain) {
            text.into_owned()
        } else {
            format!("'{}'", text.replace('\'', "'\\''"))
        }
    };
    let rest = arguments.iter().skip(1).map(quoted);
    std::iter::once("homeo".to_owned()).chain(rest).collect::<Vec<_>>().join(" ")
}

/// Prints help or the version as asked, or what is wrong with the arguments in one line.
fn refuse_arguments(error: &clap::Error, arguments: &[OsString]) -> ExitCode {
    let is_message = matches!(
        error.kind(),
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
    );
    if is_message {
        // The only failure is a reader that went away.
        let _ = error.print();
        return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
    }
    let given = |flag: &str| arguments.iter().any(|a| a == flag);
    let error = Error::usage(one_line(&error.to_string())).remedy("see homeo --help");
    Console::for_bad_arguments(given("--json")).error(&error);
    ExitCode::from(error.kind.exit_code())
}

/// What is wrong and the hints, without the usage text and line breaks.
fn one_line(message: &str) -> String {
    let lines = message.lines().map(str::trim).filter(|l| !l.is_empty());
    let told = lines.take_while(|l| !l.starts_with("Usage:") && !l.starts_with("For more information"));
    let text = told.collect::<Vec<_>>().join(" ");
    text.strip_prefix("error: ").unwrap_or(&text).to_owned()
}

/// The size of the pool that the CPU stages share; without the flag it is one thread per core.
fn set_threads(global: &Global) -> Result<()> {
    let Some(threads) = global.threads else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global();
    pool.map_err(|e| Error::usage(format!("cannot start {threads} threads: {e}")).remedy("ask for fewer"))
}
