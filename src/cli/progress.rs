//! Progress of jobs on stderr: a bar on a terminal, JSON lines on request, nothing otherwise.

use super::args::{Global, ProgressChoice};
use super::console::eprint;
use crate::error::Error;
use crate::pipeline::{JobId, Observer, Stage};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::io::IsTerminal;

/// The observer that the flags ask for.
pub fn observer(global: &Global, jobs: usize) -> Box<dyn Observer> {
    match global.progress {
        ProgressChoice::Jsonl => Box::new(JsonLines),
        ProgressChoice::Auto if global.quiet => Box::new(crate::pipeline::Silent),
        ProgressChoice::Auto if global.verbose => Box::new(Lines),
        ProgressChoice::Auto if std::io::stderr().is_terminal() => Box::new(Bar::new(jobs)),
        ProgressChoice::Auto => Box::new(crate::pipeline::Silent),
    }
}

/// One bar over the stages of all jobs.
struct Bar(ProgressBar);

impl Bar {
    fn new(jobs: usize) -> Self {
        let steps = (jobs * Stage::ALL.len()) as u64;
        let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {msg}");
        bar.set_style(style.expect("the template is a constant").progress_chars("=> "));
        Bar(bar)
    }
}

impl Observer for Bar {
    fn stage_started(&self, _: JobId, stage: Stage) {
        self.0.set_message(stage.name());
    }

    fn stage_detail(&self, _: JobId, stage: Stage, detail: &str) {
        self.0.set_message(format!("{}: {detail}", stage.name()));
    }

    fn stage_finished(&self, _: JobId, stage: Stage, _: f64, error: Option<&Error>) {
        let skipped = Stage::ALL.len() - 1 - stage as usize;
        self.0.inc(if error.is_some() { 1 + skipped as u64 } else { 1 });
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// One line per finished stage, for `-v`.
struct Lines;

impl Observer for Lines {
    fn stage_started(&self, _: JobId, _: Stage) {}

    fn stage_detail(&self, job: JobId, stage: Stage, detail: &str) {
        eprint(&format!("job {} {:8} {detail}\n", job.0, stage.name()));
    }

    fn stage_finished(&self, job: JobId, stage: Stage, seconds: f64, error: Option<&Error>) {
        let state = if error.is_some() { "failed" } else { "done" };
        eprint(&format!("job {} {:8} {state} after {seconds:.3} s\n", job.0, stage.name()));
    }
}

/// One JSON object per line: `event` is `started`, `detail`, `finished` or `failed`.
struct JsonLines;

impl JsonLines {
    fn line(value: &serde_json::Value) {
        eprint(&format!("{value}\n"));
    }
}

impl Observer for JsonLines {
    fn stage_started(&self, job: JobId, stage: Stage) {
        Self::line(&json!({ "job": job.0, "stage": stage.name(), "event": "started" }));
    }

    fn stage_detail(&self, job: JobId, stage: Stage, detail: &str) {
        Self::line(&json!({ "job": job.0, "stage": stage.name(), "event": "detail", "detail": detail }));
    }

    fn stage_finished(&self, job: JobId, stage: Stage, seconds: f64, error: Option<&Error>) {
        let event = if error.is_some() { "failed" } else { "finished" };
        Self::line(&json!({ "job": job.0, "stage": stage.name(), "event": event, "seconds": seconds }));
    }
}
