//! `batch.html`: the results of a batch to look at.

use super::row::{Row, Status};
use super::shelf::Shelf;
use crate::error::Result;
use crate::stage::write::write_file;
use crate::view::batch::{BatchRow, BatchStatus, batch_page};

/// The page's file in the output folder.
pub const PAGE_FILE: &str = "batch.html";

/// Writes the page of a batch with these rows, and puts it where the results are.
pub fn write_page(shelf: &Shelf, title: &str, rows: &[Row]) -> Result<()> {
    let shown: Vec<BatchRow> = rows.iter().map(|row| shown(shelf, row)).collect();
    let path = shelf.folder().join(PAGE_FILE);
    write_file(&path, |out| out.write_all(batch_page(title, &shown).as_bytes()))?;
    shelf.put_file(&path)
}

fn shown(shelf: &Shelf, row: &Row) -> BatchRow {
    let forward = row.distortion.as_ref().map(|d| d.forward);
    let has = |name: &str| row.status != Status::Failed && shelf.may_hold(&format!("{}/{name}", row.id));
    BatchRow {
        id: row.id.clone(),
        status: match row.status {
            Status::Ok => BatchStatus::Ok,
            Status::Failed => BatchStatus::Failed,
            Status::Skipped => BatchStatus::Skipped,
        },
        error: row.error.clone(),
        seconds: row.seconds,
        e_l2: forward.map(|m| m.e_l2),
        symmetric_dirichlet: forward.map(|m| m.symmetric_dirichlet),
        flips: forward.map(|m| m.flips),
        has_report: has("report.html"),
        has_preview: has("preview.png"),
    }
}
