//! An output file that appears complete or not at all.

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// A file under construction in a hidden sibling; dropped without [`OutputFile::commit`] it disappears.
#[derive(Debug)]
pub struct OutputFile {
    finished: PathBuf,
    temporary: PathBuf,
    writer: Option<BufWriter<File>>,
}

impl OutputFile {
    /// Starts a file that will appear at `path`, replacing one that is there.
    ///
    /// # Errors
    /// Usage, if the path names no file; input, if the file cannot be made.
    pub fn create(path: &Path) -> Result<Self> {
        let name = path.file_name().filter(|_| !path.is_dir());
        let name = name.ok_or_else(|| Error::usage("not the name of a file").file(path).remedy("name a file"))?;
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(|e| Error::io(parent, &e))?;
        }
        let temporary = path.with_file_name(format!(".{}.tmp-{}", name.to_string_lossy(), std::process::id()));
        let file = File::create(&temporary).map_err(|e| Error::io(path, &e))?;
        Ok(OutputFile { finished: path.to_owned(), temporary, writer: Some(BufWriter::new(file)) })
    }

    /// Where to write.
    pub fn writer(&mut self) -> &mut BufWriter<File> {
        self.writer.as_mut().expect("only commit takes the writer, and it takes the file as well")
    }

    /// Lets the file appear at its place.
    pub fn commit(mut self) -> Result<()> {
        let writer = self.writer.take();
        let flushed = || -> std::io::Result<()> {
            if let Some(writer) = writer {
                writer.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()?;
            }
            fs::rename(&self.temporary, &self.finished)
        };
        flushed().map_err(|e| Error::io(&self.finished, &e))
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        // After a commit there is nothing to remove; a failure here leaves a hidden file and harms nothing.
        let _ = fs::remove_file(&self.temporary);
    }
}
