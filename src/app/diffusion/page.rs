//! `report.html` of a parametrization: the model in its regions' colours with lines of equal u and v, beside the plane.

use super::picture::{Cells, tint_code};
use super::report::{DiffusionReport, ParametrizedMesh};
use super::write::Output;
use super::{Diffusion, Piece};
use crate::mesh::io::MeshFile;
use crate::mesh::{Id, VertexId};
use crate::view::cards;
use crate::view::fields::{Values, fields};
use crate::view::frame::ViewFrame;
use crate::view::page::{Card, Page};
use crate::view::scene::{At, Mode, Panel, Scene, THREE_QUARTER, in_plane};
use crate::view::stand_in::{MOST_TRIANGLES, stand_in};
use crate::view::surface::Surface;
use glam::{DVec2, DVec3};
use std::path::Path;

/// Pairs of points that decide how the second mesh is turned, at most.
const PAIRS: usize = 4000;
/// The steps in the order in which they run.
const STEPS: [&str; 4] = ["load", "diffuse", "correspond", "draw"];

/// The scene as the page holds it; and whether stand-ins are shown.
pub fn scene(output: &Output) -> (String, bool) {
    let (file, diffusion) = output.mesh;
    let first = ViewFrame::upright(&diffusion.mesh.positions.raw);
    let mut surfaces = vec![surface("first", file, diffusion, &first)];
    if let Some((file, onto)) = output.onto {
        let frame = ViewFrame::alike(&onto.mesh.positions.raw, &first, &pairs(output));
        surfaces.push(surface("second", file, onto, &frame));
    }
    let panels = panels(&surfaces);
    let reduced = stand_in(&mut surfaces, MOST_TRIANGLES);
    let scene = Scene {
        surfaces,
        panels,
        marks: Vec::new(),
        mark_name: "corner",
        patch_name: "region",
        patch_names: diffusion.pieces.iter().map(|piece| piece.name.clone()).collect(),
        patch_colors: (0..diffusion.pieces.len()).map(tint_code).collect(),
        modes: vec![Mode::Patches, Mode::Checker, Mode::Distortion, Mode::Plain],
        texture: None,
        home: THREE_QUARTER,
        by_uv: true,
    };
    (scene.data(), reduced)
}

fn panels(surfaces: &[Surface]) -> Vec<Panel> {
    let panel = |title, surface: usize, at, flat| {
        let subtitle = surfaces[surface].name.clone();
        Panel { title, subtitle, surface, at, flat, backdrop: false }
    };
    let mut panels = vec![panel("Model", 0, At::First, false)];
    if surfaces.len() > 1 {
        panels.push(panel("Second model", 1, At::First, false));
    }
    let plane = Panel { subtitle: "a square for every region".to_owned(), ..panel("(u, v)", 0, At::Second, true) };
    panels.push(plane);
    panels
}

/// Points of the first mesh and of the second that correspond.
fn pairs(output: &Output) -> Vec<[DVec3; 2]> {
    let Some([there, _]) = output.maps else { return Vec::new() };
    let positions = &output.mesh.1.mesh.positions;
    let step = positions.len().div_ceil(PAIRS).max(1);
    let of_vertex = |i: usize| [positions[VertexId::new(i)], there.positions[VertexId::new(i)]];
    (0..positions.len()).step_by(step).map(of_vertex).collect()
}

/// A mesh cut into its regions, which have their vertices to themselves.
fn surface(space: &'static str, file: &MeshFile, diffusion: &Diffusion, frame: &ViewFrame) -> Surface {
    let cells = Cells::new(diffusion.pieces.len());
    let polygons = file.triangle_polygons();
    let mut surface = Surface {
        name: file.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        spaces: vec![space, "plane"],
        places: vec![Vec::new(), Vec::new()],
        ..Surface::default()
    };
    for (r, piece) in diffusion.pieces.iter().enumerate() {
        let first = surface.places[0].len() as u32;
        let uv: Vec<DVec2> = (0..piece.st.len()).map(|v| piece.uv(v)).collect();
        let points: Vec<DVec3> = piece.disc.vertices.iter().map(|&v| diffusion.mesh.positions[v]).collect();
        surface.places[0].extend(points.iter().map(|&p| frame.place(p)));
        surface.places[1].extend(uv.iter().map(|&uv| in_plane(cells.place(r, uv))));
        surface.lines.push(rim(&surface.places, first as usize, piece));
        let folds = &diffusion.quality[r].folds;
        for (i, f) in piece.disc.faces.iter().enumerate() {
            if folds.contains(f) {
                surface.flips.push((surface.triangles.len() + i) as u32);
            }
        }
        surface.values.extend(values(piece, &uv, &points));
        surface.triangles.extend(piece.disc.triangles.iter().map(|t| t.map(|v| v + first)));
        surface.uv.extend(piece.disc.triangles.iter().map(|t| t.map(|v| uv[v as usize])));
        surface.numbers.extend(piece.disc.faces.iter().map(|f| polygons[f.index()]));
        surface.patches.extend(piece.disc.faces.iter().map(|_| r as u32));
    }
    surface
}

/// The border of a region in both spaces; the rim's vertices come first.
fn rim(places: &[Vec<DVec3>], first: usize, piece: &Piece) -> Vec<Vec<DVec3>> {
    let count = piece.disc.rim.len();
    places.iter().map(|at| (0..=count).map(|i| at[first + i % count.max(1)]).collect()).collect()
}

/// The stretch of a region over a rectangle with its sides' lengths.
fn values(piece: &Piece, uv: &[DVec2], points: &[DVec3]) -> Vec<Values> {
    let length = |k: usize| {
        let side = &piece.sides[k].vertices;
        side.windows(2).map(|w| points[w[0] as usize].distance(points[w[1] as usize])).sum::<f64>()
    };
    let along = [0.5 * (length(0) + length(2)), 0.5 * (length(1) + length(3))];
    let [width, height] = along.map(|x| x.max(f64::MIN_POSITIVE));
    let flat: Vec<DVec3> = uv.iter().map(|uv| DVec3::new(uv.x * width, uv.y * height, 0.0)).collect();
    fields(&piece.disc.triangles, &flat, points)
}

/// The page.
pub fn page(scene: &(String, bool), report: &DiffusionReport, command: &str) -> String {
    let meshes = || std::iter::once(&report.mesh).chain(&report.onto);
    let folds: usize = meshes().map(|m| m.folds).sum();
    let verdict = if folds == 0 { "No folds".to_owned() } else { format!("{folds} folded triangles") };
    let cards = [
        Some(cards::histograms(String::new())),
        cards::warnings(&report.warnings),
        Some(Card { wide: true, ..Card::new("Regions", meshes().map(regions).collect()) }),
        Some(cards::flips()),
        Some(cards::seconds(&report.seconds, &STEPS)),
        cards::command(command),
    ];
    let names: Vec<String> = meshes().map(|m| file_name(&m.mesh.file)).collect();
    let reduced =
        "The meshes are too large for a page: simpler stand-ins are shown, made of some of their own vertices.";
    let page = Page {
        title: names.join(" \u{2192} "),
        verdict: (verdict, folds == 0),
        scene: &scene.0,
        note: scene.1.then(|| reduced.to_owned()),
        cards: cards.into_iter().flatten().collect(),
    };
    page.html()
}

fn file_name(path: &str) -> String {
    Path::new(path).file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn regions(mesh: &ParametrizedMesh) -> String {
    let name = file_name(&mesh.mesh.file);
    let head = [name.as_str(), "Vertices", "Folds", "E_L2", "Angle", "Jitter"];
    let row = |r: &super::RegionReport| {
        let (q, m) = (&r.quality, &r.quality.measures);
        let folds = q.folds.len() + q.flat.len();
        let angle = format!("{:.1}\u{b0}", m.e_ang.to_degrees());
        vec![
            r.name.clone(),
            r.vertices.to_string(),
            folds.to_string(),
            format!("{:.3}", m.e_l2),
            angle,
            format!("{:.3}", q.jitter),
        ]
    };
    let rows: Vec<Vec<String>> =
        std::iter::once(head.map(str::to_owned).to_vec()).chain(mesh.regions.iter().map(row)).collect();
    cards::table(&rows)
}
