//! `report.html` of a textured mesh: the model beside the image that it was laid onto.

use super::job::TextureReport;
use super::preview::outlook;
use super::refined::Refined;
use super::sheet::Sheet;
use crate::mesh::io::{Constraint, MeshFile};
use crate::plane::orientation::orientation;
use crate::view::cards;
use crate::view::fields::fields;
use crate::view::frame::ViewFrame;
use crate::view::image::embedded;
use crate::view::page::{Card, Page};
use crate::view::scene::{At, Mark, Mode, Panel, Scene, in_plane};
use crate::view::stand_in::{MOST_TRIANGLES, stand_in};
use crate::view::surface::Surface;
use glam::DVec3;
use std::path::Path;

/// Nearly from where the constraints look, so that the image is upright and shapes still show.
const HOME: [f64; 2] = [0.25, 0.08];

/// The scene of a disc that was laid onto an image, as the page holds it; and whether a stand-in is shown.
pub fn scene(refined: &Refined, given: &MeshFile, constraints: &[Constraint], image: &Path) -> (String, bool) {
    let sheet = &refined.sheet;
    let [normal, up] = outlook(sheet);
    let frame = ViewFrame::towards(normal, up, &sheet.points);
    let in_space: Vec<DVec3> = sheet.points.iter().map(|&p| frame.place(p)).collect();
    let on_image: Vec<DVec3> = sheet.uv.iter().map(|&uv| in_plane(uv)).collect();
    let marks = sheet.features.iter().zip(constraints);
    let marks = marks.map(|(f, c)| Mark::new(&c.name, [&in_space, &on_image].map(|at| at[f.vertex as usize])));
    let marks = marks.collect();
    let mut surfaces = [surface(sheet, refined, given, [in_space, on_image])];
    let reduced = stand_in(&mut surfaces, MOST_TRIANGLES);
    let scene = Scene {
        surfaces: surfaces.into(),
        panels: panels(given, image),
        marks,
        mark_name: "constraint",
        patch_name: "patch",
        patch_names: Vec::new(),
        patch_colors: Vec::new(),
        modes: vec![Mode::Texture, Mode::Checker, Mode::Distortion, Mode::Plain],
        texture: embedded(image),
        home: HOME,
        by_uv: true,
    };
    (scene.data(), reduced)
}

fn panels(given: &MeshFile, image: &Path) -> Vec<Panel> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let model =
        Panel { title: "Model", subtitle: name(&given.path), surface: 0, at: At::First, flat: false, backdrop: false };
    let on_image = Panel {
        title: "On the image",
        subtitle: name(image),
        at: At::Second,
        flat: true,
        backdrop: true,
        ..model.clone()
    };
    vec![model, on_image]
}

fn surface(sheet: &Sheet, refined: &Refined, given: &MeshFile, places: [Vec<DVec3>; 2]) -> Surface {
    let triangles = sheet.triangles[..sheet.real].to_vec();
    let polygons = given.triangle_polygons();
    let is_turned = |&t: &u32| {
        let [a, b, c] = sheet.planar(t as usize);
        orientation(a, b, c).partial_cmp(&0.0).is_none_or(std::cmp::Ordering::is_le)
    };
    let rim: Vec<u32> = sheet.boundary.iter().chain(sheet.boundary.first()).copied().collect();
    let line = places.each_ref().map(|at| rim.iter().map(|&v| at[v as usize]).collect()).into();
    let flat: Vec<DVec3> = sheet.uv.iter().map(|uv| uv.extend(0.0)).collect();
    Surface {
        name: given.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        spaces: vec!["model", "plane"],
        values: fields(&triangles, &flat, &sheet.points),
        numbers: refined.part_of[..sheet.real].iter().map(|&t| polygons[t as usize]).collect(),
        uv: (0..sheet.real).map(|t| sheet.planar(t)).collect(),
        flips: (0..sheet.real as u32).filter(is_turned).collect(),
        lines: vec![line],
        places: places.into(),
        triangles,
        ..Surface::default()
    }
}

/// The page.
pub fn page(scene: &(String, bool), report: &TextureReport, command: &str) -> String {
    let is_good = report.flips == 0 && report.constraint_error == 0.0;
    let verdict = if is_good { "No fold, every constraint met exactly" } else { "Not all constraints are met" };
    let [met, smooth] = report.constrain.e_l2;
    let table = cards::table(&[
        ["", "E_L2"].map(str::to_owned).to_vec(),
        vec!["Constraints met".to_owned(), format!("{met:.3}")],
        vec!["Smoothed".to_owned(), format!("{smooth:.3}")],
    ]);
    let seconds = report.seconds;
    let times =
        [("load", seconds.load), ("solve", seconds.solve), ("write", seconds.write), ("total", seconds.total)].into();
    let cards = [
        Some(cards::histograms(table)),
        cards::warnings(&report.warnings),
        Some(Card::new("Constraints", facts(report))),
        Some(cards::flips()),
        Some(cards::seconds(&times, &["load", "solve", "write"])),
        cards::command(command),
    ];
    let name = report.mesh.file_name().unwrap_or_default().to_string_lossy();
    let reduced = "The mesh is too large for a page: a simpler stand-in is shown, made of some of its own vertices.";
    let page = Page {
        title: format!("{name} with {}", report.image.file_name().unwrap_or_default().to_string_lossy()),
        verdict: (verdict.to_owned(), is_good),
        scene: &scene.0,
        note: scene.1.then(|| reduced.to_owned()),
        cards: cards.into_iter().flatten().collect(),
    };
    page.html()
}

fn facts(report: &TextureReport) -> String {
    let [before, after] = report.constrain.steiner;
    let how = match report.constrain.carried {
        0 => "All walked to their places.".to_owned(),
        1 => "Some were carried to their places.".to_owned(),
        n => format!("Some were carried to their places, in {n} turns."),
    };
    cards::facts(&[
        ("Constraints", report.constraints.to_string()),
        ("Largest error", format!("{}", report.constraint_error)),
        ("How", how),
        ("Added vertices", format!("{after} ({before} before smoothing)")),
        ("Mesh", format!("{} vertices, {} triangles", report.vertices, report.triangles)),
        ("Seam", if report.seam.is_empty() { "none".to_owned() } else { format!("{} vertices", report.seam.len()) }),
        ("Program", format!("homeo {}", report.version)),
    ])
}
