//! `batch.html`: complete, self-contained, and safe whatever jobs are called.

use homeo::view::{BatchRow, BatchStatus, batch_page};

fn row(id: &str, status: BatchStatus) -> BatchRow {
    let is_done = status != BatchStatus::Failed;
    BatchRow {
        id: id.to_owned(),
        status,
        error: (!is_done).then(|| "not manifold".to_owned()),
        seconds: 1.5,
        e_l2: is_done.then_some(1.25),
        symmetric_dirichlet: is_done.then_some(1.5),
        flips: is_done.then_some(0),
        has_report: is_done,
        has_preview: is_done,
    }
}

/// The rows as the page's script reads them.
fn data(page: &str) -> serde_json::Value {
    let (_, rest) = page.split_once("id=\"data\">").expect("the page holds its rows");
    let (text, _) = rest.split_once("</script>").expect("an element that ends");
    serde_json::from_str(text).expect("the rows are JSON")
}

#[test]
fn every_job_stands_in_the_page_with_relative_links() {
    let rows = [row("cat on lion", BatchStatus::Ok), row("b", BatchStatus::Failed), row("c", BatchStatus::Skipped)];
    let page = batch_page("My batch", &rows);
    assert_eq!(page, batch_page("My batch", &rows), "the same rows give the same bytes");
    assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("src=\"//"), "no address");
    assert!(!page.contains("{{"), "all places are filled");
    let data = data(&page);
    assert_eq!(data[0]["report"], "./cat%20on%20lion/report.html");
    assert_eq!(data[0]["preview"], "./cat%20on%20lion/preview.png");
    assert_eq!((&data[1]["status"], &data[1]["error"]), (&"failed".into(), &"not manifold".into()));
    assert!(data[1]["report"].is_null() && data[1]["e_l2"].is_null());
    assert_eq!(data[2]["status"], "skipped");
}

#[test]
fn hostile_names_stay_text() {
    let name = "</script><img src=x onerror=alert(1)>\"'&";
    let page = batch_page(name, &[row(name, BatchStatus::Ok)]);
    assert!(!page.contains("<img src=x"), "no element comes from a name");
    assert_eq!(data(&page)[0]["id"], name);
}

#[test]
fn thousands_of_jobs_make_a_page_of_bounded_size() {
    let rows: Vec<BatchRow> = (0..5000).map(|i| row(&format!("pair-{i:04}"), BatchStatus::Ok)).collect();
    let page = batch_page("5000 jobs", &rows);
    assert_eq!(data(&page).as_array().map(Vec::len), Some(5000));
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
}
