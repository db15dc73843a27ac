//! Who watches the jobs: progress bars, logs, tests.

use super::line::JobId;
use super::stages::Stage;
use crate::error::Error;

/// Is told what happens to every job; called from the stages' threads.
pub trait Observer: Sync {
    /// A stage takes up a job.
    fn stage_started(&self, job: JobId, stage: Stage);
    /// A stage has something to say about the job at hand, in a few words.
    fn stage_detail(&self, job: JobId, stage: Stage, detail: &str);
    /// A stage is done with a job after `seconds` of wall clock, or gives it up with an error.
    fn stage_finished(&self, job: JobId, stage: Stage, seconds: f64, error: Option<&Error>);
}

/// Watches nothing.
pub struct Silent;

impl Observer for Silent {
    fn stage_started(&self, _: JobId, _: Stage) {}
    fn stage_detail(&self, _: JobId, _: Stage, _: &str) {}
    fn stage_finished(&self, _: JobId, _: Stage, _: f64, _: Option<&Error>) {}
}
