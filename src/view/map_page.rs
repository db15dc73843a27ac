//! The report of a finished map as a page.

use super::cards;
use super::image::png;
use super::map_scene::{MapView, file_name};
use super::page::{Card, Page, image_address};
use super::preview::preview;
use crate::map::distortion::Measures;
use crate::map::product::{Product, Shown};
use crate::map::report::{MeshSummary, Report};
use crate::mesh::FaceId;
use std::path::Path;

/// The stages in the order in which a job passes them.
const STAGES: [&str; 11] =
    ["load", "check", "cluster", "trace", "embed", "stretch", "relax", "compose", "refine", "bake", "write"];

/// What people look at of a finished map: all but the numbers.
#[derive(Clone, Debug)]
pub struct MapPictures {
    /// `preview.png`.
    pub preview: Vec<u8>,
    /// The page's scene.
    scene: String,
    /// True if the scene shows stand-ins.
    reduced: bool,
}

impl MapPictures {
    /// Draws the preview and prepares the page; `flips` are the turned-over triangles of the meshes as they came.
    pub fn new(product: &Product, shown: &Shown, flips: [&[FaceId]; 2]) -> Self {
        let view = MapView::new(product);
        let scene = || {
            let (scene, reduced) = view.scene(product, shown, flips);
            (scene.data(), reduced)
        };
        let preview = || png(&preview(&view, product, shown)).unwrap_or_default();
        let (preview, (scene, reduced)) = rayon::join(preview, scene);
        MapPictures { preview, scene, reduced }
    }

    /// `report.html`. Apart from times, memory and the command the same map gives the same bytes.
    pub fn page(&self, product: &Product, shown: &Shown, report: &Report) -> String {
        let [source, target] = [&report.source, &report.target].map(|m| file_name(Path::new(&m.file)));
        let verdict = if report.certificate.bijective { "Certified bijective" } else { "No certificate" };
        let page = Page {
            title: format!("{source} \u{2192} {target}"),
            verdict: (verdict.to_owned(), report.certificate.bijective),
            scene: &self.scene,
            note: self.note(product),
            cards: map_cards(report, shown),
        };
        page.html()
    }

    fn note(&self, product: &Product) -> Option<String> {
        let reduced = "The meshes are too large for a page: simpler stand-ins are shown, made of some of their own vertices; \
                       the numbers below are those of the whole meshes.";
        let refined = "The meshes are shown as they came, without the vertices that were appended; the numbers below are \
                       those of the refined meshes.";
        match (self.reduced, product.source.refined.is_some()) {
            (false, false) => None,
            (true, false) => Some(reduced.to_owned()),
            (false, true) => Some(refined.to_owned()),
            (true, true) => Some(format!("{reduced} {refined}")),
        }
    }
}

fn map_cards(report: &Report, shown: &Shown) -> Vec<Card> {
    let figure = |(caption, bytes): &(String, Vec<u8>)| (caption.clone(), image_address("png", bytes));
    let images: Vec<(String, String)> = shown.figures.iter().map(figure).collect();
    let about = "One atlas for both meshes: the same pixel is the same point of the map.";
    let cards = [
        Some(cards::histograms(measures(report))),
        cards::warnings(&report.warnings),
        Some(cards::flips()),
        Some(Card::new("Certificate", certificate(report))),
        Some(cards::seconds(&report.seconds, &STAGES)),
        Some(Card::new("Meshes and layout", meshes(report))),
        cards::figures("Geometry images", about, &images),
        cards::command(shown.command),
    ];
    cards.into_iter().flatten().collect()
}

/// The distortion of both compatible meshes, both ways.
fn measures(report: &Report) -> String {
    let row = |name: &str, m: &Measures| {
        let numbers = [m.e_l2, m.symmetric_dirichlet].map(|x| format!("{x:.3}"));
        let angle = format!("{:.1}\u{b0}", m.e_ang.to_degrees());
        [name.to_owned()].into_iter().chain(numbers).chain([angle, m.flips.to_string()]).collect::<Vec<_>>()
    };
    let head = ["", "E_L2", "Sym. Dirichlet", "Angle", "Turned over"].map(str::to_owned).to_vec();
    cards::table(&[
        head,
        row("Source on target", &report.distortion.forward),
        row("\u{2003}and back", &report.distortion.backward),
        row("Target on source", &report.distortion_target_on_source.forward),
        row("\u{2003}and back", &report.distortion_target_on_source.backward),
    ]) + "<p class=\"soft\">E_L2 and the symmetric Dirichlet energy are 1 for a map that keeps all lengths up \
          to one scale, more otherwise; angle is the mean change of the triangles' angles.</p>"
}

/// Why the map is a bijection, in words.
fn certificate(report: &Report) -> String {
    let c = &report.certificate;
    let mark = |holds: bool, text: String| {
        let class = if holds { "holds" } else { "fails" };
        format!("<li class=\"{class}\">{text}</li>")
    };
    let (arcs, patches) = (report.layout.arcs, report.layout.patches);
    let list = [
        mark(
            c.same_complex,
            format!("Both meshes are divided by the same {arcs} arcs into the same {patches} patches."),
        ),
        mark(c.patches_are_discs, "Every patch is a disc on both meshes.".to_owned()),
        mark(
            c.positive,
            format!(
                "Every triangle of every patch lies in its base triangle the right way up; the smallest has {:.1e} of its \
                 area. Checked with exact arithmetic.",
                c.min_orientation
            ),
        ),
    ];
    let verdict = if c.bijective {
        "Every point of the source has exactly one point of the target, and the other way round:"
    } else {
        "The map is not proved to be a bijection:"
    };
    format!("<p>{verdict}</p><ul class=\"proof\">{}</ul>", list.concat())
}

fn meshes(report: &Report) -> String {
    let mesh = |m: &MeshSummary| {
        let loops = match m.boundary_loops {
            0 => "closed".to_owned(),
            1 => "1 boundary loop".to_owned(),
            n => format!("{n} boundary loops"),
        };
        format!("{}: {} vertices, {} triangles, genus {}, {loops}", m.file, m.vertices, m.faces, m.genus)
    };
    let layout = &report.layout;
    let mut list = vec![
        ("Source", mesh(&report.source)),
        ("Target", mesh(&report.target)),
        ("Landmarks", report.landmarks.to_string()),
        ("Layout", format!("{}, {} arcs, {} patches", layout.kind, layout.arcs, layout.patches)),
        ("Relaxation", relaxation(report)),
        ("Device", report.device.clone()),
    ];
    if report.peak_bytes > 0 {
        list.push(("Memory", format!("{:.0} MB at most", report.peak_bytes as f64 / 1e6)));
    }
    list.push(("Program", format!("homeo {}", report.version)));
    cards::facts(&list)
}

fn relaxation(report: &Report) -> String {
    let relaxation = &report.relaxation;
    match relaxation.energies.as_slice() {
        [first, .., last] => format!("{}: energy {first:.3} to {last:.3}", relaxation.method),
        _ => relaxation.method.to_owned(),
    }
}
