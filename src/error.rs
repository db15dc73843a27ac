//! One error type for the whole crate: every error says which file, what is wrong, where in it, and how to mend it.

use std::fmt;
use std::path::Path;

/// What kind of trouble an [`Error`] is; each kind has one exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// A defect of this program (exit code 1).
    Bug,
    /// The command line asks for something impossible (exit code 2).
    Usage,
    /// A file is unreadable, malformed or not a manifold (exit code 3).
    Input,
    /// The input is well formed but the problem has no solution (exit code 4).
    Unsolvable,
    /// A compute device was required and there is none (exit code 5).
    Device,
    /// The time given for the job is over (exit code 4).
    Late,
}

impl ErrorKind {
    /// The kind in a word, as JSON has it.
    pub fn name(self) -> &'static str {
        match self {
            ErrorKind::Bug => "bug",
            ErrorKind::Usage => "usage",
            ErrorKind::Input => "input",
            ErrorKind::Unsolvable => "unsolvable",
            ErrorKind::Device => "device",
            ErrorKind::Late => "late",
        }
    }

    /// The process exit code that stands for this kind.
    pub fn exit_code(self) -> u8 {
        match self {
            ErrorKind::Bug => 1,
            ErrorKind::Usage => 2,
            ErrorKind::Input => 3,
            ErrorKind::Unsolvable | ErrorKind::Late => 4,
            ErrorKind::Device => 5,
        }
    }
}

/// An error a user can act on.
///
/// Printed as one line, `FILE: what (element): remedy`; parts that do not apply are left out.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Error {
    /// The kind, which decides the exit code.
    pub kind: ErrorKind,
    /// The file (or other input) the error is about; may be empty.
    pub file: String,
    /// What is wrong.
    pub what: String,
    /// The offending element: a line, a vertex, a face, a row; may be empty.
    pub element: String,
    /// What the user can do about it; may be empty.
    pub remedy: String,
}

/// Result with the crate's [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    fn new(kind: ErrorKind, what: impl Into<String>) -> Self {
        Error { kind, file: String::new(), what: what.into(), element: String::new(), remedy: String::new() }
    }

    /// Bad input: unreadable, malformed, not a manifold.
    pub fn input(what: impl Into<String>) -> Self {
        Self::new(ErrorKind::Input, what)
    }

    /// Well-formed input without a solution.
    pub fn unsolvable(what: impl Into<String>) -> Self {
        Self::new(ErrorKind::Unsolvable, what)
    }

    /// Wrong usage of the command line or of an option.
    pub fn usage(what: impl Into<String>) -> Self {
        Self::new(ErrorKind::Usage, what)
    }

    /// No usable compute device.
    pub fn device(what: impl Into<String>) -> Self {
        Self::new(ErrorKind::Device, what)
    }

    /// The time given is over.
    pub fn late(what: impl Into<String>) -> Self {
        Self::new(ErrorKind::Late, what)
    }

    /// A broken invariant of this program.
    pub fn bug(what: impl Into<String>) -> Self {
        Self::new(ErrorKind::Bug, what).remedy("this is a bug in homeo, please report it with the input files")
    }

    /// An operating system error on `file`.
    pub fn io(file: &Path, error: &std::io::Error) -> Self {
        Self::input(error.to_string()).file(file).remedy("check the path, its permissions and the free disk space")
    }

    /// Names the file the error is about.
    pub fn file(mut self, file: &Path) -> Self {
        self.file = file.display().to_string();
        self
    }

    /// Names the offending element.
    pub fn at(mut self, element: impl fmt::Display) -> Self {
        self.element = element.to_string();
        self
    }

    /// Says how to mend it.
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = remedy.into();
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.file.is_empty() {
            write!(f, "{}: ", self.file)?;
        }
        f.write_str(&self.what)?;
        if !self.element.is_empty() {
            write!(f, " ({})", self.element)?;
        }
        if !self.remedy.is_empty() {
            write!(f, ": {}", self.remedy)?;
        }
        Ok(())
    }
}
