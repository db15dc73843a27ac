//! Many maps from a manifest: streamed through the stages, resumable, in shards.
//!
//! ```text
//!   manifest -> jobs of this shard -> finished before? --- yes ---> ledger: skipped
//!                                          | no                        ^
//!                                          v                           |
//!                                    line of stages ---- outcome ------+--> results.jsonl, failed.jsonl
//! ```
//!
//! Input: jobs. Output: `DIR/ID/` for every job that succeeds, as [`super::stages`] writes it, with a seal in it: the
//! job's fingerprint, which covers the bytes of its inputs, the options and the version. Invariants: a folder is there
//! complete or not at all; what becomes of a job depends on nothing but the job; every job of the shard that came to an
//! end has one row, written as it ends; whatever kills the process, the jobs with a folder are not done again.

pub mod fingerprint;
pub mod ledger;
pub mod manifest;
pub mod merge;
pub mod page;
pub mod plan;
pub mod record;
pub mod row;
pub mod shard;
pub mod shelf;
pub mod store;

use super::flow::Flow;
use super::job::{MapJob, MapOptions};
use super::line::{JobId, Outcome};
use super::observer::Observer;
use super::stages::{SealedJob, stream_maps};
use super::templates::Templates;
use crate::error::Result;
use crate::gpu::Device;
use crate::map::report::Report;
use crate::stage::write::folder::{REPORT_FILE, clean_leftovers_of};
use fingerprint::{Fingerprint, Fingerprints, SEAL_FILE};
use ledger::{Closed, Ledger, file_name};
use manifest::BatchJob;
use record::{RECORD_FILE, write_record};
use row::{Failure, Row};
use shard::Shard;
use shelf::Shelf;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// How a batch is run.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchOptions {
    /// How each pair is mapped.
    pub map: MapOptions,
    /// The part of the jobs to do; none: all.
    pub shard: Option<Shard>,
    /// Time for each job, in which it is worked on; none: any.
    pub timeout: Option<Duration>,
    /// Bytes of memory for the jobs in flight together, by estimate; a job that needs more runs alone.
    pub memory: u64,
    /// No further job is begun after so many have failed; none: failures never stop the others.
    pub max_fail: Option<usize>,
}

/// What became of a batch.
#[derive(Clone, Debug)]
pub struct BatchResult {
    /// Jobs of this shard.
    pub jobs: usize,
    /// Their rows.
    pub closed: Closed,
    /// Seconds that the jobs done in this run spent in every stage, together, and `total`.
    pub stage_seconds: BTreeMap<&'static str, f64>,
}

/// What can be told while a batch runs.
pub trait BatchObserver: Observer {
    /// A job has come to an end. Rows come from several threads, one at a time.
    fn job_ended(&self, row: &Row);
}

/// Runs the jobs of a manifest, or of a shard of it. Once `stop` is set, jobs at hand are finished and no other begun.
///
/// # Errors
/// Usage, if another run writes to the same place; input, if results cannot be written. A job that fails is no error: its
/// row says why.
pub fn run_batch(
    jobs: &[BatchJob],
    shelf: &Shelf,
    options: &BatchOptions,
    device: &Device,
    observer: &dyn BatchObserver,
    stop: &AtomicBool,
) -> Result<BatchResult> {
    let out = shelf.folder();
    shelf.fetch_tables()?;
    let own: Vec<&BatchJob> = jobs.iter().filter(|job| options.shard.is_none_or(|s| s.holds(&job.id))).collect();
    let own_ids: Vec<&str> = own.iter().map(|job| job.id.as_str()).collect();
    let ledger = Ledger::open(out, options.shard, &own_ids)?;
    if ledger.is_alone() {
        clean_leftovers_of(out, &own_ids.iter().copied().collect())?;
    }
    write_record(out, &jobs.iter().map(|job| job.id.as_str()).collect::<Vec<_>>())?;
    let run = Run {
        shelf,
        options,
        observer,
        stop,
        fingerprints: Mutex::new(Fingerprints::new(&options.map)),
        ledger: Mutex::new(ledger),
        failed: AtomicUsize::new(0),
        stage_seconds: Mutex::default(),
        at_hand: own.iter().map(|_| Mutex::default()).collect(),
    };
    let templates = Templates::shared_by(own.iter().map(|job| &job.files));
    let flow = Flow::watched(observer).bounded(options.timeout, options.memory);
    let due = own.iter().enumerate().take_while(|_| run.goes_on()).filter_map(|(i, job)| run.due(JobId(i), job));
    stream_maps(due, &options.map, device, &flow, &templates, |outcome| run.note(own[outcome.id.0], outcome));
    let stage_seconds = run.stage_seconds.into_inner().unwrap_or_else(PoisonError::into_inner);
    let closed = run.ledger.into_inner().unwrap_or_else(PoisonError::into_inner).close()?;
    for table in
        [out.join(RECORD_FILE), file_name(out, "results", options.shard), file_name(out, "failed", options.shard)]
    {
        shelf.put_file(&table)?;
    }
    Ok(BatchResult { jobs: own.len(), closed, stage_seconds })
}

/// A batch that runs.
struct Run<'a> {
    shelf: &'a Shelf,
    options: &'a BatchOptions,
    observer: &'a dyn BatchObserver,
    stop: &'a AtomicBool,
    fingerprints: Mutex<Fingerprints>,
    ledger: Mutex<Ledger>,
    failed: AtomicUsize,
    stage_seconds: Mutex<BTreeMap<&'static str, f64>>,
    /// The fingerprint of every job in the line.
    at_hand: Vec<Mutex<Option<Fingerprint>>>,
}

impl Run<'_> {
    fn goes_on(&self) -> bool {
        let enough = self.options.max_fail.is_some_and(|most| self.failed.load(Ordering::SeqCst) >= most);
        !enough && !self.stop.load(Ordering::SeqCst)
    }

    /// The job for the line of stages; none if it is done already, or fails before it is begun.
    fn due(&self, id: JobId, job: &BatchJob) -> Option<SealedJob> {
        let fingerprint = self.fingerprints.lock().unwrap_or_else(PoisonError::into_inner).of(&job.files);
        let fingerprint = match fingerprint {
            Ok(fingerprint) => fingerprint,
            Err(error) => {
                self.end(Row::failed(&job.id, &error, 0.0), Some(Failure::new(&job.id, "load", &error, None)));
                return None;
            }
        };
        match self.finished_before(&job.id, &fingerprint) {
            Ok(None) => {}
            Ok(Some(row)) => {
                self.end(row, None);
                return None;
            }
            Err(error) => {
                let failure = Failure::new(&job.id, "load", &error, Some(&fingerprint));
                self.end(Row::failed(&job.id, &error, 0.0), Some(failure));
                return None;
            }
        }
        let seal = fingerprint.seal(&job.id);
        *self.at_hand[id.0].lock().unwrap_or_else(PoisonError::into_inner) = Some(fingerprint);
        Some((id, MapJob { out: self.shelf.folder().join(&job.id), ..job.files.clone() }, Some(seal)))
    }

    /// Notes what became of a job.
    fn note(&self, job: &BatchJob, outcome: Outcome<Report>) {
        let seconds = outcome.seconds.get("total").copied().unwrap_or(0.0);
        let fingerprint = self.at_hand[outcome.id.0].lock().unwrap_or_else(PoisonError::into_inner).take();
        match outcome.value.and_then(|report| self.shelf.put_job(&job.id).map(|()| report)) {
            Ok(report) => {
                let mut sums = self.stage_seconds.lock().unwrap_or_else(PoisonError::into_inner);
                outcome.seconds.iter().for_each(|(&stage, seconds)| *sums.entry(stage).or_default() += seconds);
                drop(sums);
                self.end(Row::done(&job.id, &report), None);
            }
            Err(error) => {
                let stage = outcome.failed_in.map_or("write", |stage| stage.name());
                let failure = Failure::new(&job.id, stage, &error, fingerprint.as_ref());
                self.end(Row::failed(&job.id, &error, seconds), Some(failure));
            }
        }
    }

    fn end(&self, row: Row, failure: Option<Failure>) {
        if failure.is_some() {
            self.failed.fetch_add(1, Ordering::SeqCst);
        }
        let mut ledger = self.ledger.lock().unwrap_or_else(PoisonError::into_inner);
        self.observer.job_ended(&row);
        ledger.add(row, failure);
    }

    /// The row of a job whose results are there already, made from the same inputs by the same options and version.
    fn finished_before(&self, id: &str, fingerprint: &Fingerprint) -> Result<Option<Row>> {
        let seal = self.shelf.read(&format!("{id}/{SEAL_FILE}"))?;
        if !seal.is_some_and(|seal| fingerprint.is_sealed_by(&seal)) {
            return Ok(None);
        }
        let report = self.shelf.read(&format!("{id}/{REPORT_FILE}"))?;
        Ok(report.and_then(|report| Row::skipped(id, &report)))
    }
}
