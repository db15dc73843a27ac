//! An output folder that appears complete or not at all.
//!
//! Everything is written into a hidden sibling `.NAME.tmp-PID` on the same file system, flushed to the disk, and renamed
//! at the end. An earlier output at the same place is moved to `.NAME.old-PID` first and removed afterwards. What a
//! killed process left behind is cleaned up by the next one that writes to the same place.

use crate::error::{Error, Result};
use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The file whose presence marks a folder as one of our finished outputs.
pub const REPORT_FILE: &str = "report.json";

/// A folder under construction; dropped without [`OutputFolder::commit`] it disappears.
#[derive(Debug)]
pub struct OutputFolder {
    finished: PathBuf,
    temporary: PathBuf,
    committed: bool,
}

/// Refuses a place that holds something which is not ours to replace. Cheap: call it before the work starts.
///
/// Free are: no entry, an empty folder, a folder with our report in it.
pub fn check_place(dir: &Path) -> Result<()> {
    let refuse = |what: &str| {
        Err(Error::usage(what).file(dir).remedy("name a new folder, an empty one, or an earlier output to replace"))
    };
    let mut entries = match fs::read_dir(dir) {
        Ok(entries) => entries,
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(()),
        Err(e) if e.kind() == ErrorKind::NotADirectory => return refuse("the output place is a file"),
        Err(e) => return Err(Error::io(dir, &e)),
    };
    if entries.next().is_none() || dir.join(REPORT_FILE).is_file() {
        return Ok(());
    }
    refuse("the output folder holds files that are not an output of this program")
}

impl OutputFolder {
    /// Starts a folder that will appear at `dir`; missing parents are made, leftovers of dead processes cleaned.
    pub fn create(dir: &Path) -> Result<Self> {
        check_place(dir)?;
        let finished = absolute(dir)?;
        let parent = parent_of(&finished);
        fs::create_dir_all(parent).map_err(|e| Error::io(parent, &e))?;
        clean_leftovers(&finished)?;
        let temporary = sibling(&finished, TEMPORARY, std::process::id());
        fs::create_dir(&temporary).map_err(|e| Error::io(&temporary, &e))?;
        Ok(OutputFolder { finished, temporary, committed: false })
    }

    /// Where the folder will appear.
    pub fn place(&self) -> &Path {
        &self.finished
    }

    /// Writes one file of the folder, `name` relative with `/` between folders, and flushes it to the disk.
    pub fn write(&self, name: &str, fill: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        let path = self.temporary.join(name);
        let written = || -> std::io::Result<()> {
            fs::create_dir_all(parent_of(&path))?;
            let mut file = BufWriter::new(File::create_new(&path)?);
            fill(&mut file)?;
            file.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()
        };
        written().map_err(|e| Error::io(&self.finished.join(name), &e))
    }

    /// Lets the folder appear at its place, replacing an earlier output.
    pub fn commit(mut self) -> Result<()> {
        let old = sibling(&self.finished, REPLACED, std::process::id());
        self.swap_in(&old).map_err(|e| Error::io(&self.finished, &e))?;
        self.committed = true;
        // The result stands; an old output that cannot be removed is cleaned by the next run.
        let _ = fs::remove_dir_all(&old);
        Ok(())
    }

    fn swap_in(&self, old: &Path) -> std::io::Result<()> {
        sync_folders(&self.temporary)?;
        let replaced = match fs::rename(&self.finished, old) {
            Ok(()) => true,
            Err(e) if e.kind() == ErrorKind::NotFound => false,
            Err(e) => return Err(e),
        };
        if let Err(e) = fs::rename(&self.temporary, &self.finished) {
            if replaced {
                fs::rename(old, &self.finished)?;
            }
            return Err(e);
        }
        sync_folder(parent_of(&self.finished))
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        if !self.committed {
            // Nothing more can be done about a failure here; the next run cleans up.
            let _ = fs::remove_dir_all(&self.temporary);
        }
    }
}

pub(super) const TEMPORARY: &str = "tmp";
const REPLACED: &str = "old";

/// `.NAME.KIND-PID` beside `finished`.
pub(super) fn sibling(finished: &Path, kind: &str, process: u32) -> PathBuf {
    finished.with_file_name(format!("{}{process}", sibling_prefix(finished, kind)))
}

fn sibling_prefix(finished: &Path, kind: &str) -> String {
    let name = finished.file_name().unwrap_or_default().to_string_lossy();
    format!(".{name}.{kind}-")
}

/// Links resolved, so that the output itself is replaced and not a link to it.
pub(super) fn absolute(dir: &Path) -> Result<PathBuf> {
    let path = match fs::canonicalize(dir) {
        Ok(path) => path,
        Err(_) => std::path::absolute(dir).map_err(|e| Error::io(dir, &e))?,
    };
    if path.file_name().is_none() {
        return Err(Error::usage("the output place has no name of its own").file(dir).remedy("name a new one"));
    }
    Ok(path)
}

/// The folder that holds `path`; itself for a root, which [`absolute`] refuses.
pub(super) fn parent_of(path: &Path) -> &Path {
    path.parent().unwrap_or(path)
}

/// Removes what dead processes left beside `finished`; an output they had moved away is put back first.
pub(super) fn clean_leftovers(finished: &Path) -> Result<()> {
    let parent = parent_of(finished);
    let entries = fs::read_dir(parent).map_err(|e| Error::io(parent, &e))?;
    for entry in entries.flatten() {
        let name = entry.file_name();
        let owner = |kind| name.to_str()?.strip_prefix(&sibling_prefix(finished, kind))?.parse::<u32>().ok();
        let (temporary, replaced) = (owner(TEMPORARY), owner(REPLACED));
        if temporary.or(replaced).is_none_or(is_running) {
            continue;
        }
        let path = entry.path();
        let is_only_copy = replaced.is_some() && !finished.exists();
        let cleaned = if is_only_copy { fs::rename(&path, finished) } else { remove(&path) };
        cleaned.map_err(|e| Error::io(&path, &e))?;
    }
    Ok(())
}

/// Removes what runs that were killed left in `parent` of the outputs with these names; an output that they had moved away
/// is put back first. Only for a folder that no other process writes these outputs to.
pub fn clean_leftovers_of(parent: &Path, names: &HashSet<&str>) -> Result<()> {
    let entries = fs::read_dir(parent).map_err(|e| Error::io(parent, &e))?;
    for path in entries.flatten().map(|entry| entry.path()) {
        let file = path.file_name().and_then(|name| name.to_str()).and_then(|name| name.strip_prefix('.'));
        let parts = file.and_then(|file| file.rsplit_once('-')).filter(|(_, pid)| pid.parse::<u32>().is_ok());
        let Some((name, kind)) = parts.and_then(|(start, _)| start.rsplit_once('.')) else { continue };
        if !names.contains(name) || ![TEMPORARY, REPLACED].contains(&kind) {
            continue;
        }
        let finished = parent.join(name);
        let is_only_copy = kind == REPLACED && !finished.exists();
        let cleaned = if is_only_copy { fs::rename(&path, &finished) } else { remove(&path) };
        cleaned.map_err(|e| Error::io(&path, &e))?;
    }
    Ok(())
}

fn remove(path: &Path) -> std::io::Result<()> {
    if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) }
}

/// True if another process with this number may be running; where the system does not say, it may.
fn is_running(process: u32) -> bool {
    let table = Path::new("/proc");
    let is_listed = !table.join("self").exists() || table.join(process.to_string()).exists();
    process != std::process::id() && is_listed
}

/// Flushes the folder entries below and including `dir`.
fn sync_folders(dir: &Path) -> std::io::Result<()> {
    for entry in fs::read_dir(dir)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            sync_folders(&entry.path())?;
        }
    }
    sync_folder(dir)
}

#[cfg(unix)]
pub(super) fn sync_folder(dir: &Path) -> std::io::Result<()> {
    File::open(dir)?.sync_all()
}

/// Folders cannot be opened as files here; the rename itself is durable enough.
#[cfg(not(unix))]
pub(super) fn sync_folder(_: &Path) -> std::io::Result<()> {
    Ok(())
}
