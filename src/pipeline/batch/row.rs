//! The rows of results.jsonl and failed.jsonl.

use super::fingerprint::Fingerprint;
use crate::error::Error;
use crate::map::distortion::Distortion;
use crate::map::report::Report;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What became of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Done in this run.
    Ok,
    /// It has no result; the row says why.
    Failed,
    /// Done in an earlier run, from the same inputs by the same options and version.
    Skipped,
}

/// A job that came to an end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The job's id.
    pub id: String,
    /// What became of it.
    pub status: Status,
    /// Why it failed, in one line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Wall-clock seconds in which it was worked on; of a skipped job those it once took.
    pub seconds: f64,
    /// Of the map from source to target, as in the job's report; null for one that failed.
    pub distortion: Option<Distortion>,
}

/// What a row needs of a job's report.
#[derive(Deserialize)]
struct Finished {
    seconds: BTreeMap<String, f64>,
    distortion: Distortion,
}

impl Row {
    /// A job that was done just now.
    pub fn done(id: &str, report: &Report) -> Self {
        Row {
            id: id.to_owned(),
            status: Status::Ok,
            error: None,
            seconds: report.seconds.get("total").copied().unwrap_or(0.0),
            distortion: Some(report.distortion),
        }
    }

    /// A job that failed after `seconds`.
    pub fn failed(id: &str, error: &Error, seconds: f64) -> Self {
        let error = Some(error.to_string().replace(['\n', '\r'], " "));
        Row { id: id.to_owned(), status: Status::Failed, error, seconds, distortion: None }
    }

    /// A job that has a report already; none if it cannot be read.
    pub fn skipped(id: &str, report: &[u8]) -> Option<Self> {
        let Finished { seconds, distortion } = serde_json::from_slice(report).ok()?;
        Some(Row {
            id: id.to_owned(),
            status: Status::Skipped,
            error: None,
            seconds: seconds.get("total").copied().unwrap_or(0.0),
            distortion: Some(distortion),
        })
    }
}

/// A job that failed, part by part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// The job's id.
    pub id: String,
    /// The stage it failed in.
    pub stage: String,
    /// The exit code that `homeo map` would have ended with.
    pub code: u8,
    /// The kind of error: bug, usage, input, unsolvable, device, late.
    pub kind: String,
    /// The file the error is about.
    pub file: String,
    /// What is wrong.
    pub what: String,
    /// The offending element.
    pub element: String,
    /// How to mend it.
    pub remedy: String,
    /// The fingerprint of the job's inputs, options and version; none if they could not be read.
    pub input: Option<String>,
}

impl Failure {
    /// What `error` says about a job.
    pub fn new(id: &str, stage: &str, error: &Error, input: Option<&Fingerprint>) -> Self {
        Failure {
            id: id.to_owned(),
            stage: stage.to_owned(),
            code: error.kind.exit_code(),
            kind: error.kind.name().to_owned(),
            file: error.file.clone(),
            what: error.what.clone(),
            element: error.element.clone(),
            remedy: error.remedy.clone(),
            input: input.map(Fingerprint::to_string),
        }
    }
}
