//! An output file that appears complete or not at all.
//!
//! It is written as a hidden sibling `.NAME.tmp-PID` on the same file system, flushed to the disk, and renamed at the end,
//! as [`super::folder`] does it for folders.

use super::folder::{TEMPORARY, absolute, clean_leftovers, parent_of, sibling, sync_folder};
use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{BufWriter, IntoInnerError, Write};
use std::path::{Path, PathBuf};

/// A file under construction; dropped without [`OutputFile::commit`] it disappears.
#[derive(Debug)]
pub struct OutputFile {
    finished: PathBuf,
    temporary: PathBuf,
    writer: Option<BufWriter<File>>,
}

impl OutputFile {
    /// Starts a file that will appear at `path`, replacing an earlier one as a whole; missing parents are made.
    ///
    /// # Errors
    /// Usage, if the path names no file; input, if the file cannot be made.
    pub fn create(path: &Path) -> Result<Self> {
        let finished = absolute(path)?;
        if finished.is_dir() {
            return Err(Error::usage("the output file is a folder").file(path).remedy("name a file"));
        }
        let parent = parent_of(&finished);
        fs::create_dir_all(parent).map_err(|e| Error::io(parent, &e))?;
        clean_leftovers(&finished)?;
        let temporary = sibling(&finished, TEMPORARY, std::process::id());
        let file = File::create(&temporary).map_err(|e| Error::io(path, &e))?;
        Ok(OutputFile { finished, temporary, writer: Some(BufWriter::new(file)) })
    }

    /// Where to write.
    pub fn writer(&mut self) -> &mut BufWriter<File> {
        self.writer.as_mut().expect("only commit takes the writer, and it takes the file as well")
    }

    /// Lets the file appear at its place.
    pub fn commit(mut self) -> Result<()> {
        let writer = self.writer.take();
        let placed = || -> std::io::Result<()> {
            if let Some(writer) = writer {
                writer.into_inner().map_err(IntoInnerError::into_error)?.sync_all()?;
            }
            fs::rename(&self.temporary, &self.finished)?;
            sync_folder(parent_of(&self.finished))
        };
        placed().map_err(|e| Error::io(&self.finished, &e))
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        // After a commit there is nothing to remove; what a failure leaves here the next run cleans up.
        let _ = fs::remove_file(&self.temporary);
    }
}

/// Writes one file. If `fill` or the disk fails, whatever was at `path` before stays.
pub fn write_file(path: &Path, fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    let mut file = OutputFile::create(path)?;
    fill(file.writer()).map_err(|e| Error::io(path, &e))?;
    file.commit()
}
