//! Where a batch's results end up: a folder, or an object store behind an address.
//!
//! With a store, jobs are written to a folder of this machine first, as ever; when one is done, its files go to the store,
//! its seal last, and leave the folder. What has no seal is not there. Tables go to the store when the batch ends.

use super::fingerprint::SEAL_FILE;
use super::store::Store;
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// A place for results.
#[derive(Debug)]
pub struct Shelf {
    /// The folder itself, or what is on its way to the store.
    folder: PathBuf,
    store: Option<Store>,
}

impl Shelf {
    /// The place that `out` names: an address such as `s3://bucket/night`, or a folder.
    ///
    /// # Errors
    /// Usage, if the place is a file, or an address that this program cannot reach.
    pub fn open(out: &Path) -> Result<Self> {
        let text = out.to_string_lossy();
        if let Some((scheme, path)) = text.split_once("://") {
            if scheme == "file" {
                return Ok(Shelf { folder: PathBuf::from(path), store: None });
            }
            let name = blake3::hash(text.as_bytes()).to_hex();
            let own = format!("homeo-batch-{}-{}", &name[..16], std::process::id());
            let folder = std::env::temp_dir().join(own);
            return Ok(Shelf { folder, store: Some(Store::open(&text)?) });
        }
        if out.exists() && !out.is_dir() {
            return Err(Error::usage("the output place is a file").file(out).remedy("name a folder"));
        }
        Ok(Shelf { folder: out.to_owned(), store: None })
    }

    /// The folder on this machine.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// A file of the results, `/` between folders; none if it is not there.
    ///
    /// # Errors
    /// Input, if the store does not answer.
    pub fn read(&self, name: &str) -> Result<Option<Vec<u8>>> {
        match &self.store {
            Some(store) => store.read(name),
            None => Ok(std::fs::read(self.folder.join(name)).ok()),
        }
    }

    /// False if a file of the results is surely not there; a store is not asked.
    pub fn may_hold(&self, name: &str) -> bool {
        self.store.is_some() || self.folder.join(name).is_file()
    }

    /// Puts a job's finished folder where it belongs.
    pub fn put_job(&self, id: &str) -> Result<()> {
        let Some(store) = &self.store else { return Ok(()) };
        let folder = self.folder.join(id);
        let mut names = files_below(&folder)?;
        names.sort_by_key(|name| name == SEAL_FILE);
        // Old results lose their seal before the first of them is replaced.
        if store.read(&format!("{id}/{SEAL_FILE}"))?.is_some() {
            store.remove(&format!("{id}/{SEAL_FILE}"))?;
        }
        for old in store.files_below(id)? {
            store.remove(&format!("{id}/{old}"))?;
        }
        for name in names {
            let path = folder.join(&name);
            let bytes = std::fs::read(&path).map_err(|e| Error::io(&path, &e))?;
            store.write(&format!("{id}/{name}"), bytes)?;
        }
        std::fs::remove_dir_all(&folder).map_err(|e| Error::io(&folder, &e))
    }

    /// Puts a table where it belongs, if it was made.
    pub fn put_file(&self, path: &Path) -> Result<()> {
        let (Some(store), Some(name), true) = (&self.store, path.file_name(), path.is_file()) else { return Ok(()) };
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, &e))?;
        store.write(&name.to_string_lossy(), bytes)
    }

    /// Brings the tables from the store to the folder.
    pub fn fetch_tables(&self) -> Result<()> {
        let Some(store) = &self.store else { return Ok(()) };
        std::fs::create_dir_all(&self.folder).map_err(|e| Error::io(&self.folder, &e))?;
        for name in store.files("")?.iter().filter(|name| name.ends_with(".jsonl") || name.ends_with(".json")) {
            let path = self.folder.join(name);
            let bytes = store.read(name)?.unwrap_or_default();
            std::fs::write(&path, bytes).map_err(|e| Error::io(&path, &e))?;
        }
        Ok(())
    }
}

impl Drop for Shelf {
    fn drop(&mut self) {
        if self.store.is_some() {
            // What was on its way has arrived, or is lost with this run; the system clears its temporary files itself.
            let _ = std::fs::remove_dir_all(&self.folder);
        }
    }
}

/// The files in and below a folder, as names with `/` between folders, in order.
fn files_below(folder: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(folder).map_err(|e| Error::io(folder, &e))?;
    let mut names = Vec::new();
    for path in entries.flatten().map(|entry| entry.path()) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            names.extend(files_below(&path)?.into_iter().map(|below| format!("{name}/{below}")));
        } else {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}
