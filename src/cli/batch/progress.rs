//! Progress of a batch on stderr: a bar over its jobs, lines on `-v`, JSON lines on request.

use crate::cli::args::{Global, ProgressChoice};
use crate::cli::console::eprint;
use crate::error::Error;
use crate::pipeline::batch::BatchObserver;
use crate::pipeline::batch::manifest::BatchJob;
use crate::pipeline::batch::row::{Row, Status};
use crate::pipeline::batch::shard::Shard;
use crate::pipeline::{JobId, Observer, Stage};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The observer that the flags ask for.
pub fn observer(global: &Global, jobs: &[BatchJob], shard: Option<Shard>) -> Box<dyn BatchObserver> {
    let own = jobs.iter().filter(|job| shard.is_none_or(|shard| shard.holds(&job.id)));
    let ids: Vec<String> = own.map(|job| job.id.clone()).collect();
    match global.progress {
        ProgressChoice::Jsonl => Box::new(JsonLines(ids)),
        ProgressChoice::Auto if global.quiet => Box::new(Quiet),
        ProgressChoice::Auto if global.verbose => Box::new(Lines::new(ids)),
        ProgressChoice::Auto if std::io::stderr().is_terminal() => Box::new(Bar::new(ids.len())),
        ProgressChoice::Auto => Box::new(Quiet),
    }
}

/// Watches nothing.
struct Quiet;

impl Observer for Quiet {
    fn stage_started(&self, _: JobId, _: Stage) {}
    fn stage_detail(&self, _: JobId, _: Stage, _: &str) {}
    fn stage_finished(&self, _: JobId, _: Stage, _: f64, _: Option<&Error>) {}
}

impl BatchObserver for Quiet {
    fn job_ended(&self, _: &Row) {}
}

/// One bar over all jobs, with rate and the time that is left.
struct Bar {
    bar: ProgressBar,
    failed: Mutex<usize>,
}

impl Bar {
    fn new(jobs: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(jobs as u64), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} jobs, {per_sec}, {eta} left {msg}");
        bar.set_style(style.expect("the template is a constant").progress_chars("=> "));
        Bar { bar, failed: Mutex::new(0) }
    }
}

impl Observer for Bar {
    fn stage_started(&self, _: JobId, _: Stage) {
        self.bar.tick();
    }

    fn stage_detail(&self, _: JobId, _: Stage, _: &str) {}

    fn stage_finished(&self, _: JobId, _: Stage, _: f64, _: Option<&Error>) {}
}

impl BatchObserver for Bar {
    fn job_ended(&self, row: &Row) {
        match row.status {
            // Jobs done before say nothing about the rate of those to come.
            Status::Skipped => {
                self.bar.set_length(self.bar.length().unwrap_or(1).saturating_sub(1));
            }
            Status::Ok => self.bar.inc(1),
            Status::Failed => {
                let mut failed = self.failed.lock().unwrap_or_else(PoisonError::into_inner);
                *failed += 1;
                self.bar.set_message(format!("({} failed)", *failed));
                self.bar.inc(1);
            }
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// A line for every job, and at the end how busy every stage was: for `-v`.
struct Lines {
    ids: Vec<String>,
    started: Instant,
    busy: Mutex<[f64; Stage::ALL.len()]>,
}

impl Lines {
    fn new(ids: Vec<String>) -> Self {
        Lines { ids, started: Instant::now(), busy: Mutex::default() }
    }
}

impl Observer for Lines {
    fn stage_started(&self, _: JobId, _: Stage) {}

    fn stage_detail(&self, job: JobId, stage: Stage, detail: &str) {
        eprint(&format!("{} {:8} {detail}\n", self.ids[job.0], stage.name()));
    }

    fn stage_finished(&self, _: JobId, stage: Stage, seconds: f64, _: Option<&Error>) {
        self.busy.lock().unwrap_or_else(PoisonError::into_inner)[stage as usize] += seconds;
    }
}

impl BatchObserver for Lines {
    fn job_ended(&self, row: &Row) {
        let end = match (row.status, &row.error) {
            (Status::Failed, Some(error)) => format!("failed: {error}"),
            (Status::Skipped, _) => "done before".to_owned(),
            _ => format!("done after {:.2} s", row.seconds),
        };
        eprint(&format!("{} {end}\n", row.id));
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        let wall = self.started.elapsed().as_secs_f64();
        let busy = self.busy.lock().unwrap_or_else(PoisonError::into_inner);
        eprint(&format!("{wall:.2} s; threads at work in each stage, on average:\n"));
        for (stage, seconds) in Stage::ALL.iter().zip(*busy) {
            eprint(&format!("  {:8} {:.2}\n", stage.name(), seconds / wall));
        }
    }
}

/// One JSON object per line: `event` is `started`, `detail`, `finished`, `failed`, or `ended` with the job's row.
struct JsonLines(Vec<String>);

impl JsonLines {
    fn line(&self, job: JobId, stage: Stage, event: &str, more: Value) {
        let mut line = json!({ "job": self.0[job.0], "stage": stage.name(), "event": event });
        if let (Some(line), Value::Object(more)) = (line.as_object_mut(), more) {
            line.extend(more);
        }
        eprint(&format!("{line}\n"));
    }
}

impl Observer for JsonLines {
    fn stage_started(&self, job: JobId, stage: Stage) {
        self.line(job, stage, "started", json!({}));
    }

    fn stage_detail(&self, job: JobId, stage: Stage, detail: &str) {
        self.line(job, stage, "detail", json!({ "detail": detail }));
    }

    fn stage_finished(&self, job: JobId, stage: Stage, seconds: f64, error: Option<&Error>) {
        let event = if error.is_some() { "failed" } else { "finished" };
        self.line(job, stage, event, json!({ "seconds": seconds }));
    }
}

impl BatchObserver for JsonLines {
    fn job_ended(&self, row: &Row) {
        eprint(&format!("{}\n", json!({ "job": row.id, "event": "ended", "row": row })));
    }
}
