//! What is printed: results on stdout, everything else on stderr. A reader that goes away is not an error.

use super::args::{ColorChoice, Global};
use crate::error::Error;
use serde::Serialize;
use serde_json::json;
use std::io::{self, IsTerminal, Write};

/// How and how much to print.
#[derive(Clone, Copy, Debug)]
pub struct Console {
    /// Results on stdout as JSON.
    pub json: bool,
    /// Nothing but errors.
    pub quiet: bool,
    /// Colours on stdout.
    pub color: bool,
    /// Colours on stderr.
    pub color_errors: bool,
}

impl Console {
    /// What the flags mean here and now.
    pub fn new(global: &Global) -> Self {
        let no_color = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
        let color = |is_terminal: bool| match global.color {
            ColorChoice::Always => true,
            ColorChoice::Never => false,
            ColorChoice::Auto => is_terminal && !no_color,
        };
        Console {
            json: global.json,
            quiet: global.quiet,
            color: color(io::stdout().is_terminal()),
            color_errors: color(io::stderr().is_terminal()),
        }
    }

    /// For arguments that could not be read: no colours, JSON if they seem to ask for it.
    pub fn for_bad_arguments(json: bool) -> Self {
        Console { json, quiet: false, color: false, color_errors: false }
    }

    /// Prints a result: `value` as JSON, or else the text, which ends in a newline; `-q` drops the text.
    pub fn result(&self, value: &impl Serialize, text: impl FnOnce() -> String) {
        if self.json {
            print_json(value);
        } else if !self.quiet {
            print(&text());
        }
    }

    /// A remark on stderr.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            eprint(&format!("{text}\n"));
        }
    }

    /// A warning on stderr.
    pub fn warn(&self, text: &str) {
        self.note(&format!("{}: {text}", self.paint_error("33", "warning")));
    }

    /// One line `error: ...` on stderr; with `--json` an object with the same parts on stdout as well.
    pub fn error(&self, error: &Error) {
        if self.json {
            print_json(&error_object(error));
        }
        let line = error.to_string().replace(['\n', '\r'], " ");
        eprint(&format!("{}: {line}\n", self.paint_error("1;31", "error")));
    }

    /// `text` in an ANSI style for stdout.
    pub fn paint(&self, style: &str, text: &str) -> String {
        painted(self.color, style, text)
    }

    fn paint_error(&self, style: &str, text: &str) -> String {
        painted(self.color_errors, style, text)
    }
}

fn painted(is_on: bool, style: &str, text: &str) -> String {
    if is_on { format!("\x1b[{style}m{text}\x1b[0m") } else { text.to_owned() }
}

/// An error as JSON; parts that do not apply are empty strings.
pub fn error_object(error: &Error) -> serde_json::Value {
    json!({ "error": {
        "kind": error.kind.name(),
        "exit_code": error.kind.exit_code(),
        "file": error.file,
        "what": error.what,
        "element": error.element,
        "remedy": error.remedy,
    } })
}

/// Prints `value` on stdout as JSON.
pub fn print_json(value: &impl Serialize) {
    let text = serde_json::to_string_pretty(value).expect("results are plain data with string keys");
    print(&(text + "\n"));
}

/// Prints to stdout. The only failure that happens in practice is a reader that went away (`| head`), and then there is
/// nobody left to tell.
fn print(text: &str) {
    let mut out = io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Prints to stderr; see [`print`].
pub fn eprint(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}
