//! Finished maps as text for people.

use super::console::Console;
use super::table::table;
use crate::map::distortion::Measures;
use crate::map::report::{MeshSummary, Report};
use std::path::{Path, PathBuf};

/// One finished map.
pub fn map_summary(report: &Report, dir: &Path, console: &Console) -> String {
    let mesh = |m: &MeshSummary| format!("{}: {} vertices, {} faces", m.file, m.vertices, m.faces);
    let mut text = format!("{}\n{}\n", mesh(&report.source), mesh(&report.target));
    text += &format!(
        "{} landmarks, {} arcs, {} patches, on {}\n",
        report.landmarks, report.layout.arcs, report.layout.patches, report.device
    );
    text += &format!("{}\n\n", verdict(report, console));
    text += &table(&[
        ["", "E_L2", "E_ang", "sym. Dirichlet", "turned over"].map(String::from).to_vec(),
        measures_row("source on target", &report.distortion.forward),
        measures_row("  and back", &report.distortion.backward),
        measures_row("target on source", &report.distortion_target_on_source.forward),
        measures_row("  and back", &report.distortion_target_on_source.backward),
    ]);
    text += &format!("\nwritten to {} after {:.2} s\n", dir.display(), total_seconds(report));
    text + &invitation(&[dir.join(PAGE)])
}

/// The page that shows a result.
pub const PAGE: &str = "report.html";

/// Which pages to open, those that there are; empty without any.
pub fn invitation(pages: &[PathBuf]) -> String {
    let there: Vec<String> = pages.iter().filter(|p| p.is_file()).map(|p| p.display().to_string()).collect();
    if there.is_empty() { String::new() } else { format!("open in a browser: {}\n", there.join(", ")) }
}

/// Several finished maps, a row each.
pub fn demo_summary(finished: &[(String, Report)], console: &Console) -> String {
    let header =
        ["pair", "vertices", "landmarks", "patches", "E_L2", "E_ang", "sym. Dirichlet", "turned over", "seconds"];
    let mut rows = vec![header.map(String::from).to_vec()];
    rows.extend(finished.iter().map(|(name, r)| {
        let m = r.distortion.forward;
        vec![
            name.clone(),
            format!("{}/{}", r.source.vertices, r.target.vertices),
            r.landmarks.to_string(),
            r.layout.patches.to_string(),
            format!("{:.3}", m.e_l2),
            format!("{:.3}", m.e_ang),
            format!("{:.3}", m.symmetric_dirichlet),
            format!("{}/{}", m.flips, r.distortion_target_on_source.forward.flips),
            format!("{:.2}", total_seconds(r)),
        ]
    }));
    let verdicts = finished.iter().map(|(name, r)| format!("{name}: {}\n", verdict(r, console)));
    table(&rows) + &verdicts.collect::<String>()
}

/// The certificate and how the distortion was lowered; a map without a certificate is an error and gets no summary.
fn verdict(report: &Report, console: &Console) -> String {
    let relaxation = &report.relaxation;
    let [source, target] = relaxation.stretch.map(|s| format!("{:.3} to {:.3}", s.before, s.after));
    let mut text = console.paint("32", "certified bijective");
    text += &format!("; patches' E_L2 {source} (source), {target} (target)");
    if let [first, .., last] = relaxation.energies.as_slice() {
        text += &format!("; relaxed from sym. Dirichlet {first:.3} to {last:.3}");
    }
    if let [first, .., last] = relaxation.polish.as_slice() {
        text += &format!("; polished from {first:.3} to {last:.3} at the vertices");
    }
    text
}

fn measures_row(name: &str, m: &Measures) -> Vec<String> {
    let number = |x: f64| format!("{x:.3}");
    vec![name.to_owned(), number(m.e_l2), number(m.e_ang), number(m.symmetric_dirichlet), m.flips.to_string()]
}

fn total_seconds(report: &Report) -> f64 {
    report.seconds.get("total").copied().unwrap_or(0.0)
}
