//! `batch.html`: all jobs of a batch in one sortable table with thumbnails and links to their reports.

use super::html::{THEME_CSS, THEME_JS, escape, fill, relative_link, script_data};
use serde::Serialize;

const TEMPLATE: &str = include_str!("web/batch/batch.html");
const STYLE: &str = include_str!("web/batch/batch.css");
const SCRIPT: &str = include_str!("web/batch/batch.js");

/// What became of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum BatchStatus {
    /// Finished in this run.
    Ok,
    /// Ended with an error.
    Failed,
    /// Finished in an earlier run, unchanged since.
    Skipped,
}

/// One job of a batch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BatchRow {
    /// Its id, which is also the name of its folder beside the page.
    pub id: String,
    /// What became of it.
    pub status: BatchStatus,
    /// Why it failed, in one sentence.
    pub error: Option<String>,
    /// Wall-clock seconds that it took.
    pub seconds: f64,
    /// E_L2 of the source on the target; none for a job without result.
    pub e_l2: Option<f64>,
    /// Symmetric Dirichlet energy of the source on the target, 1 for an isometry.
    pub symmetric_dirichlet: Option<f64>,
    /// Triangles of both compatible meshes that are collapsed or turned over.
    pub flips: Option<usize>,
    /// Whether `ID/report.html` is there.
    pub has_report: bool,
    /// Whether `ID/preview.png` is there.
    pub has_preview: bool,
}

/// A row as the page's script gets it.
#[derive(Serialize)]
struct Entry<'a> {
    #[serde(flatten)]
    row: &'a BatchRow,
    report: Option<String>,
    preview: Option<String>,
}

impl<'a> Entry<'a> {
    fn of(row: &'a BatchRow) -> Self {
        let file = |is_there: bool, name: &str| is_there.then(|| relative_link(&format!("{}/{name}", row.id)));
        let (report, preview) = (file(row.has_report, "report.html"), file(row.has_preview, "preview.png"));
        Entry { row, report, preview }
    }
}

/// The page, complete and self-contained; its links and thumbnails are relative: `ID/report.html`, `ID/preview.png`.
///
/// The same rows give the same bytes. Rows of thousands of jobs are built only as they come into view.
pub fn batch_page(title: &str, rows: &[BatchRow]) -> String {
    let entries: Vec<Entry> = rows.iter().map(Entry::of).collect();
    fill(
        TEMPLATE,
        &[
            ("title", &escape(title)),
            ("theme", THEME_CSS),
            ("style", STYLE),
            ("summary", &summary(rows)),
            ("rows", &script_data(&entries)),
            ("switch", THEME_JS),
            ("script", SCRIPT),
        ],
    )
}

/// How many jobs there are of each kind, and how long they took.
fn summary(rows: &[BatchRow]) -> String {
    let count = |status| rows.iter().filter(|row| row.status == status).count();
    let [ok, failed, skipped] = [BatchStatus::Ok, BatchStatus::Failed, BatchStatus::Skipped].map(count);
    let seconds: f64 = rows.iter().map(|row| row.seconds).sum();
    let turned = rows.iter().filter(|row| row.flips.is_some_and(|flips| flips > 0)).count();
    let card = |number: String, what: &str| format!("<div class=\"tile\"><b>{number}</b><span>{what}</span></div>");
    [
        card(rows.len().to_string(), "jobs"),
        card(ok.to_string(), "done"),
        card(skipped.to_string(), "unchanged"),
        card(failed.to_string(), "failed"),
        card(turned.to_string(), "with turned triangles"),
        card(duration(seconds), "in all jobs"),
    ]
    .concat()
}

/// A time in the unit that suits it.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}
