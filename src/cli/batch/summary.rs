//! A finished batch in numbers.

use crate::cli::console::Console;
use crate::cli::table::table;
use crate::map::distortion::Measures;
use crate::pipeline::batch::BatchResult;
use crate::pipeline::batch::ledger::Closed;
use crate::pipeline::batch::row::{Row, Status};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Failures named in the summary at most; failed.jsonl has them all.
const NAMED: usize = 10;

/// A measure by its name in reports.
type Named = (&'static str, fn(&Measures) -> f64);

/// What is summed up of every map from source to target.
const MEASURES: [Named; 4] = [
    ("e_l2", |m| m.e_l2),
    ("e_ang", |m| m.e_ang),
    ("symmetric_dirichlet", |m| m.symmetric_dirichlet),
    ("flips", |m| m.flips as f64),
];

/// A batch in numbers, also what `--json` prints.
#[derive(Debug, Serialize)]
pub struct Summary {
    /// Jobs of this run's part of the manifest.
    pub jobs: usize,
    /// Done in this run.
    pub ok: usize,
    /// Done in an earlier run.
    pub skipped: usize,
    /// Without a result.
    pub failed: usize,
    /// Not begun, because the run was stopped.
    pub left: usize,
    /// Median and worst of every measure of the maps from source to target.
    pub distortion: BTreeMap<&'static str, Spread>,
    /// Mean seconds of every stage of the jobs done in this run, and `total`.
    pub stage_seconds: BTreeMap<&'static str, f64>,
    /// How often each reason was given for a failure.
    pub failures: BTreeMap<String, usize>,
    /// The first failures: id and error.
    pub failed_jobs: Vec<(String, String)>,
}

/// Where the values of a measure lie.
#[derive(Debug, Serialize)]
pub struct Spread {
    /// The middle one.
    pub median: f64,
    /// The largest one.
    pub worst: f64,
    /// The job that has it.
    pub worst_job: String,
}

impl Summary {
    /// The numbers of a batch.
    pub fn of(result: &BatchResult) -> Self {
        let Closed { rows, ended } = &result.closed;
        let rows: Vec<&Row> = rows.iter().filter(|row| ended.contains(&row.id)).collect();
        let count = |status| rows.iter().filter(|row| row.status == status).count();
        let failed: Vec<&Row> = rows.iter().copied().filter(|row| row.status == Status::Failed).collect();
        let mut failures = BTreeMap::new();
        for row in &failed {
            *failures.entry(reason(row)).or_default() += 1;
        }
        let named = failed.iter().take(NAMED).map(|row| (row.id.clone(), row.error.clone().unwrap_or_default()));
        let ok = count(Status::Ok);
        let mean = |(&stage, sum): (&&'static str, &f64)| (stage, sum / ok.max(1) as f64);
        Summary {
            jobs: result.jobs,
            ok,
            skipped: count(Status::Skipped),
            failed: failed.len(),
            left: result.jobs.saturating_sub(rows.len()),
            distortion: MEASURES.iter().filter_map(|(name, value)| Some((*name, Spread::of(&rows, value)?))).collect(),
            stage_seconds: result.stage_seconds.iter().map(mean).collect(),
            failures,
            failed_jobs: named.collect(),
        }
    }
}

impl Spread {
    /// None if no row has measures.
    fn of(rows: &[&Row], value: impl Fn(&Measures) -> f64) -> Option<Self> {
        let one = |row: &'_ Row| Some(value(&row.distortion.as_ref()?.forward));
        let mut values: Vec<(f64, &str)> = rows.iter().filter_map(|row| Some((one(row)?, row.id.as_str()))).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let &(worst, worst_job) = values.last()?;
        Some(Spread { median: values[values.len() / 2].0, worst, worst_job: worst_job.to_owned() })
    }
}

/// The error without its file and element: what many jobs can have in common.
fn reason(row: &Row) -> String {
    let error = row.error.as_deref().unwrap_or_default();
    let what = error.split_once(": ").map_or(error, |(_, rest)| rest);
    let end = what.find(" (").or_else(|| what.find(": ")).unwrap_or(what.len());
    what[..end].to_owned()
}

/// The numbers for people.
pub fn summary_text(summary: &Summary, out: &Path, console: &Console) -> String {
    let Summary { jobs, ok, skipped, failed, left, .. } = summary;
    let mut text = format!("{jobs} jobs: {ok} done, {skipped} done before, {failed} failed");
    text += &if *left > 0 { format!(", {left} not begun\n") } else { "\n".to_owned() };
    if !summary.distortion.is_empty() {
        let mut rows = vec![["", "median", "worst", "in"].map(String::from).to_vec()];
        for (name, Spread { median, worst, worst_job }) in &summary.distortion {
            let number = |x: f64| if *name == "flips" { format!("{x:.0}") } else { format!("{x:.3}") };
            rows.push(vec![title(name).to_owned(), number(*median), number(*worst), worst_job.clone()]);
        }
        text += &format!("\n{}", table(&rows));
    }
    let stages = summary.stage_seconds.iter().filter(|(stage, _)| **stage != "total");
    if let Some((stage, seconds)) = stages.max_by(|a, b| a.1.total_cmp(b.1)) {
        let total = summary.stage_seconds.get("total").copied().unwrap_or(0.0);
        text += &format!("\nslowest stage: {stage}, {seconds:.2} of {total:.2} s a job\n");
    }
    if *failed > 0 {
        text += &format!("\n{}\n", console.paint("31", "failed:"));
        for (reason, count) in &summary.failures {
            text += &format!("  {count} x {reason}\n");
        }
        for (id, error) in &summary.failed_jobs {
            text += &format!("  {id}: {error}\n");
        }
    }
    text + &format!("\nresults are in {}\n", out.display())
}

fn title(measure: &str) -> &str {
    match measure {
        "e_l2" => "E_L2",
        "e_ang" => "E_ang",
        "symmetric_dirichlet" => "sym. Dirichlet",
        "flips" => "turned over",
        other => other,
    }
}
