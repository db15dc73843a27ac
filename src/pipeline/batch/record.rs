//! `batch.json`: the ids of all jobs, so that shards can be told complete without the manifest.

use crate::error::{Error, Result};
use crate::stage::write::write_file;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The file's name in the output folder.
pub const RECORD_FILE: &str = "batch.json";

#[derive(Serialize, Deserialize)]
struct Record {
    version: String,
    ids: Vec<String>,
}

/// Writes the ids of all jobs, whatever shard they belong to; all shards write the same, and the first one does.
pub fn write_record(out: &Path, ids: &[&str]) -> Result<()> {
    let ids = ids.iter().map(|&id| id.to_owned()).collect();
    let record = Record { version: env!("CARGO_PKG_VERSION").to_owned(), ids };
    let (path, bytes) = (out.join(RECORD_FILE), serde_json::to_vec(&record).expect("strings by name"));
    let is_there = || std::fs::read(&path).is_ok_and(|there| there == bytes);
    if is_there() {
        return Ok(());
    }
    let written = write_file(&path, |file| file.write_all(&bytes));
    // A shard on another machine may have taken the temporary file for a dead process's, and written the same itself.
    if is_there() { Ok(()) } else { written }
}

/// The ids of all jobs of the batch in a folder.
pub fn read_record(out: &Path) -> Result<Vec<String>> {
    let path = out.join(RECORD_FILE);
    let bytes = std::fs::read(&path).map_err(|e| {
        Error::input(format!("no batch was run into this folder: {e}"))
            .file(&path)
            .remedy("name the folder that was given to homeo batch with --out")
    })?;
    let record: Record = serde_json::from_slice(&bytes).map_err(|e| {
        Error::input(format!("not a list of jobs: {e}")).file(&path).remedy("run the batch again, which renews it")
    })?;
    Ok(record.ids)
}
