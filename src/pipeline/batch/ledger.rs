//! results.jsonl and failed.jsonl: a row for every job that came to an end, written when it ends.
//!
//! While a batch runs, rows are appended, each in one write. When it ends (and when the next one begins, if it was
//! killed) both files are written anew: in the manifest's order, one row for every job. A row that cannot be written,
//! because the disk is full, is kept and tried again with the next.

use super::row::{Failure, Row};
use super::shard::Shard;
use crate::error::{Error, Result};
use crate::stage::write::write_file;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::{HashMap, HashSet};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The rows of a batch or of a shard of it; its files are locked against other runs.
#[derive(Debug)]
pub struct Ledger {
    order: Vec<String>,
    rows: HashMap<String, Row>,
    failures: HashMap<String, Failure>,
    results: Journal,
    failed: Journal,
    /// Jobs that ended in this run.
    ended: HashSet<String>,
    /// Held until the ledger is dropped; the system lets go of them when the process dies.
    locks: Vec<File>,
}

/// What a ledger says in the end.
#[derive(Clone, Debug, Default)]
pub struct Closed {
    /// The row of every job that has one, in the manifest's order.
    pub rows: Vec<Row>,
    /// The jobs that ended in this run; the rows of others are from earlier ones.
    pub ended: HashSet<String>,
}

impl Ledger {
    /// Opens the ledger in `out`, which is made if need be, for these jobs; rows of other jobs are dropped.
    ///
    /// # Errors
    /// Usage, if another process has it open; input, if files cannot be read or written.
    pub fn open(out: &Path, shard: Option<Shard>, ids: &[&str]) -> Result<Self> {
        std::fs::create_dir_all(out).map_err(|e| Error::io(out, &e))?;
        let locks = lock(out, shard)?;
        let (results, failed) = (file_name(out, "results", shard), file_name(out, "failed", shard));
        let mut rows: HashMap<String, Row> = read_rows(&results)?.into_iter().map(|r: Row| (r.id.clone(), r)).collect();
        let mut failures: HashMap<String, Failure> =
            read_rows(&failed)?.into_iter().map(|f: Failure| (f.id.clone(), f)).collect();
        let order: Vec<String> = ids.iter().map(|&id| id.to_owned()).collect();
        write_rows(&results, &order, &mut rows)?;
        write_rows(&failed, &order, &mut failures)?;
        let (results, failed) = (Journal::open(results)?, Journal::open(failed)?);
        Ok(Ledger { order, rows, failures, results, failed, ended: HashSet::new(), locks })
    }

    /// True if no other run can be writing to the same place; where the file system has no locks nobody knows.
    pub fn is_alone(&self) -> bool {
        !self.locks.is_empty()
    }

    /// Adds what became of a job, in place of what was known before.
    pub fn add(&mut self, row: Row, failure: Option<Failure>) {
        self.results.append(&row);
        match failure {
            Some(failure) => {
                self.failed.append(&failure);
                self.failures.insert(row.id.clone(), failure);
            }
            None => drop(self.failures.remove(&row.id)),
        }
        self.ended.insert(row.id.clone());
        self.rows.insert(row.id.clone(), row);
    }

    /// Writes both files anew, in order.
    pub fn close(mut self) -> Result<Closed> {
        let written = write_rows(&self.results.path, &self.order, &mut self.rows)
            .and_then(|()| write_rows(&self.failed.path, &self.order, &mut self.failures));
        if let Err(error) = written {
            // What was appended says the same, in the order in which jobs ended.
            if !(self.results.flush() && self.failed.flush()) {
                return Err(error);
            }
        }
        Ok(Closed { rows: self.order.iter().filter_map(|id| self.rows.remove(id)).collect(), ended: self.ended })
    }
}

/// `NAME.jsonl`, or `NAME-I-of-N.jsonl` for a shard.
pub fn file_name(out: &Path, name: &str, shard: Option<Shard>) -> PathBuf {
    let part = shard.map(|shard| format!("-{}", shard.to_string().replace('/', "-of-"))).unwrap_or_default();
    out.join(format!("{name}{part}.jsonl"))
}

/// Locks the place: a whole batch for itself, shards beside each other, each shard for itself. None where there are no locks,
/// as on some network file systems: then it is up to the user.
fn lock(out: &Path, shard: Option<Shard>) -> Result<Vec<File>> {
    let open = |path: PathBuf| {
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
        file.map_err(|e| Error::io(&path, &e))
    };
    let whole = open(out.join(".lock"))?;
    let mut tried = vec![if shard.is_some() { whole.try_lock_shared() } else { whole.try_lock() }];
    let mut locks = vec![whole];
    if shard.is_some() {
        let own = open(file_name(out, ".lock", shard).with_extension(""))?;
        tried.push(own.try_lock());
        locks.push(own);
    }
    if tried.iter().any(|result| matches!(result, Err(TryLockError::WouldBlock))) {
        return Err(Error::usage("another run writes to this folder")
            .file(out)
            .remedy("wait until it has ended, or name another folder"));
    }
    Ok(if tried.iter().all(std::result::Result::is_ok) { locks } else { Vec::new() })
}

/// The rows of a file of JSON lines, none if it is not there; a last line that was cut short is left out.
pub fn read_rows<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>> {
    let mut text = match std::fs::read(path) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(Error::io(path, &e)),
    };
    text.truncate(text.iter().rposition(|&b| b == b'\n').map_or(0, |end| end + 1));
    let mut rows = Vec::new();
    for (i, line) in text.split_inclusive(|&b| b == b'\n').enumerate() {
        rows.push(serde_json::from_slice(line).map_err(|e| {
            Error::input(format!("not a row of results: {e}"))
                .file(path)
                .at(format!("line {}", i + 1))
                .remedy("remove the file; finished jobs are found again by their folders")
        })?);
    }
    Ok(rows)
}

/// Writes the rows of the jobs in `order`, those that have one, and forgets the others.
pub fn write_rows<T: Serialize>(path: &Path, order: &[String], rows: &mut HashMap<String, T>) -> Result<()> {
    let mut kept = HashMap::with_capacity(order.len());
    let written = write_file(path, |out| {
        for id in order {
            if let Some((id, row)) = rows.remove_entry(id) {
                serde_json::to_writer(&mut *out, &row)?;
                out.write_all(b"\n")?;
                kept.insert(id, row);
            }
        }
        Ok(())
    });
    if written.is_ok() {
        rows.clear();
    }
    rows.extend(kept);
    written
}

/// A file that rows are appended to.
#[derive(Debug)]
struct Journal {
    path: PathBuf,
    file: File,
    /// Length of what is complete; a row that was cut short is cut off.
    len: u64,
    /// Rows that could not be written yet.
    pending: Vec<u8>,
}

impl Journal {
    fn open(path: PathBuf) -> Result<Self> {
        let opened = OpenOptions::new().append(true).create(true).open(&path);
        let opened = opened.and_then(|file| Ok((file.metadata()?.len(), file)));
        let (len, file) = opened.map_err(|e| Error::io(&path, &e))?;
        Ok(Journal { path, file, len, pending: Vec::new() })
    }

    fn append(&mut self, row: &impl Serialize) {
        serde_json::to_writer(&mut self.pending, row).expect("rows are plain data with string keys");
        self.pending.push(b'\n');
        self.flush();
    }

    /// True if all rows are in the file.
    fn flush(&mut self) -> bool {
        if self.file.write_all(&self.pending).is_ok() {
            self.len += self.pending.len() as u64;
            self.pending.clear();
        } else {
            // If this fails as well, the next run drops the line that is cut short.
            let _ = self.file.set_len(self.len);
        }
        self.pending.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(test: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("homeo-ledger-{test}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        dir
    }

    fn failed(id: &str) -> (Row, Option<Failure>) {
        let error = Error::input("bad");
        (Row::failed(id, &error, 0.5), Some(Failure::new(id, "load", &error, None)))
    }

    fn ids(path: &Path) -> Vec<String> {
        read_rows::<Row>(path).expect("rows").into_iter().map(|row| row.id).collect()
    }

    #[test]
    fn rows_come_in_the_jobs_order_and_survive_a_kill() {
        let out = folder("order");
        let results = out.join("results.jsonl");
        let mut ledger = Ledger::open(&out, None, &["a", "b", "c"]).expect("a ledger");
        for id in ["c", "a"] {
            let (row, failure) = failed(id);
            ledger.add(row, failure);
        }
        assert_eq!(ids(&results), ["c", "a"], "appended as they end");
        drop(ledger); // as if killed
        let cut_short = |mut file: File| file.write_all(b"{\"id\":\"b\",\"sta");
        OpenOptions::new().append(true).open(&results).and_then(cut_short).expect("writable");
        let mut ledger = Ledger::open(&out, None, &["a", "b", "c"]).expect("a ledger");
        assert_eq!(ids(&results), ["a", "c"]);
        ledger.add(Row { status: super::super::row::Status::Ok, error: None, ..failed("a").0 }, None);
        let closed = ledger.close().expect("closed");
        assert_eq!((closed.rows.len(), closed.ended.len()), (2, 1));
        assert_eq!(ids(&results), ["a", "c"]);
        let failures: Vec<Failure> = read_rows(&out.join("failed.jsonl")).expect("rows");
        assert_eq!(failures.into_iter().map(|f| f.id).collect::<Vec<_>>(), ["c"], "a has succeeded since");
        std::fs::remove_dir_all(&out).expect("removable");
    }

    #[test]
    fn rows_of_jobs_that_are_gone_are_dropped() {
        let out = folder("gone");
        let mut ledger = Ledger::open(&out, None, &["a", "b"]).expect("a ledger");
        for id in ["a", "b"] {
            let (row, failure) = failed(id);
            ledger.add(row, failure);
        }
        ledger.close().expect("closed");
        let rows = Ledger::open(&out, None, &["b"]).and_then(Ledger::close).expect("closed").rows;
        assert_eq!(rows.into_iter().map(|row| row.id).collect::<Vec<_>>(), ["b"]);
        std::fs::remove_dir_all(&out).expect("removable");
    }

    #[test]
    fn two_runs_do_not_write_to_one_place() {
        let out = folder("lock");
        let first = Ledger::open(&out, None, &["a"]).expect("a ledger");
        assert!(Ledger::open(&out, None, &["a"]).is_err_and(|e| e.what.contains("another run")));
        let [one, two] = ["1/2", "2/2"].map(|shard| shard.parse().ok());
        assert!(Ledger::open(&out, one, &["a"]).is_err(), "nor a shard beside the whole");
        drop(first);
        let shard = Ledger::open(&out, one, &["a"]).expect("a ledger");
        assert!(Ledger::open(&out, two, &["a"]).is_ok_and(|ledger| ledger.is_alone()), "shards go side by side");
        assert!(Ledger::open(&out, one, &["a"]).is_err() && Ledger::open(&out, None, &["a"]).is_err());
        drop(shard);
        assert!(Ledger::open(&out, None, &["a"]).is_ok());
        std::fs::remove_dir_all(&out).expect("removable");
    }
}
