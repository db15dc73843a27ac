//! Joins the results of shards, after checking that every job was done exactly once.

use super::fingerprint::SEAL_FILE;
use super::ledger::{file_name, read_rows, write_rows};
use super::record::read_record;
use super::row::{Failure, Row, Status};
use super::shelf::Shelf;
use crate::error::{Error, Result};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Ids named in an error at most.
const NAMED: usize = 5;

/// Joins `results-I-of-N.jsonl` of a batch into results.jsonl, and the failures likewise; returns the rows in the order of
/// the manifest.
///
/// # Errors
/// Input, if a job has no row or several, or a row of a finished job has no results: a shard is missing, has not ended, or
/// the number of shards was changed half way.
pub fn merge(shelf: &Shelf) -> Result<Vec<Row>> {
    shelf.fetch_tables()?;
    let out = shelf.folder();
    let ids = read_record(out)?;
    let mut rows: HashMap<String, Row> = HashMap::with_capacity(ids.len());
    let mut twice = Vec::new();
    for file in parts(out, "results")? {
        // Of several rows in one file the last one holds: a run that was killed had no time to drop the others.
        let last: HashMap<String, Row> =
            read_rows::<Row>(&file)?.into_iter().map(|row| (row.id.clone(), row)).collect();
        for (id, row) in last {
            if rows.insert(id.clone(), row).is_some() {
                twice.push(id);
            }
        }
    }
    twice.sort();
    let remedy = "run the shards that are missing, or remove the results of shards that are not of this batch";
    refuse(out, "jobs with several results", &twice, remedy)?;
    let missing: Vec<&String> = ids.iter().filter(|id| !rows.contains_key(*id)).collect();
    refuse(out, "jobs without a result", &missing, remedy)?;
    let mut empty = Vec::new();
    for id in ids.iter().filter(|id| rows.get(*id).is_some_and(|row| row.status != Status::Failed)) {
        if shelf.read(&format!("{id}/{SEAL_FILE}"))?.is_none() {
            empty.push(id);
        }
    }
    refuse(out, "finished jobs whose folder is gone", &empty, "run their shards again")?;
    let mut failures = HashMap::new();
    for file in parts(out, "failed")? {
        failures.extend(read_rows::<Failure>(&file)?.into_iter().map(|failure| (failure.id.clone(), failure)));
    }
    let [results, failed] = ["results", "failed"].map(|name| file_name(out, name, None));
    write_rows(&results, &ids, &mut rows)?;
    write_rows(&failed, &ids, &mut failures)?;
    shelf.put_file(&results)?;
    shelf.put_file(&failed)?;
    Ok(ids.iter().filter_map(|id| rows.remove(id)).collect())
}

/// The shards' files `NAME-I-of-N.jsonl`, or the whole batch's own file if there is none.
fn parts(out: &Path, name: &str) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(out).map_err(|e| Error::io(out, &e))?;
    let is_part = |path: &PathBuf| {
        let file = path.file_name().and_then(|n| n.to_str());
        let part = file.and_then(|n| n.strip_prefix(name)?.strip_prefix('-')?.strip_suffix(".jsonl"));
        part.and_then(|part| part.split_once("-of-")).is_some()
    };
    let mut parts: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).filter(is_part).collect();
    parts.sort();
    if parts.is_empty() {
        parts.push(out.join(format!("{name}.jsonl")));
    }
    Ok(parts)
}

/// Fails if there are any, naming the first.
fn refuse(out: &Path, what: &str, ids: &[impl AsRef<str>], remedy: &str) -> Result<()> {
    if ids.is_empty() {
        return Ok(());
    }
    let mut named: Vec<&str> = ids.iter().take(NAMED).map(AsRef::as_ref).collect();
    if ids.len() > named.len() {
        named.push("...");
    }
    Err(Error::input(format!("{what}: {}", ids.len())).file(out).at(named.join(", ")).remedy(remedy))
}
