//! A single output file that appears complete or not at all.

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{BufWriter, IntoInnerError, Write};
use std::path::{Path, PathBuf};

/// Writes `path` through a hidden sibling that is flushed to the disk and then renamed over it.
///
/// # Errors
/// Usage, if `path` names no file; input, if it cannot be written. Nothing is left behind then.
pub fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    let Some(name) = path.file_name().filter(|_| !path.is_dir()) else {
        return Err(Error::usage("the output place is a folder").file(path).remedy("name a file"));
    };
    let hidden = format!(".{}.tmp-{}", name.to_string_lossy(), std::process::id());
    let temporary = Temporary(path.with_file_name(hidden));
    let written = || -> std::io::Result<()> {
        let mut out = BufWriter::new(File::create(&temporary.0)?);
        fill(&mut out)?;
        out.into_inner().map_err(IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&temporary.0, path)
    };
    written().map_err(|e| Error::io(path, &e))
}

/// A file that does not outlive its owner, unless it is renamed before.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        // Gone after the rename; after a failure there is nothing more to be done about another one.
        let _ = fs::remove_file(&self.0);
    }
}
