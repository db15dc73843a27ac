//! An output file that appears complete or not at all.
//!
//! It is written as a hidden sibling `.NAME.tmp-PID` on the same file system, flushed to the disk, and renamed at the end,
//! as [`super::folder`] does it for folders.

use super::folder::{TEMPORARY, absolute, clean_leftovers, parent_of, sibling, sync_folder};
use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{BufWriter, IntoInnerError, Write};
use std::path::Path;

/// Writes one file, replacing an earlier one as a whole; missing parents are made. If `fill` or the disk fails, whatever
/// was at `path` before stays.
pub fn write_file(path: &Path, fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    let finished = absolute(path)?;
    if finished.is_dir() {
        return Err(Error::usage("the output file is a folder").file(path).remedy("name a file"));
    }
    let parent = parent_of(&finished);
    fs::create_dir_all(parent).map_err(|e| Error::io(parent, &e))?;
    clean_leftovers(&finished)?;
    let temporary = sibling(&finished, TEMPORARY, std::process::id());
    let written = || -> std::io::Result<()> {
        let mut file = BufWriter::new(File::create(&temporary)?);
        fill(&mut file)?;
        file.into_inner().map_err(IntoInnerError::into_error)?.sync_all()?;
        fs::rename(&temporary, &finished)?;
        sync_folder(parent)
    };
    written().map_err(|e| {
        // Nothing more can be done about a failure here; the next run cleans up.
        let _ = fs::remove_file(&temporary);
        Error::io(path, &e)
    })
}
