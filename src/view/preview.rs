//! `preview.png` of a finished map: source and target in matching patch colours, and the source on the target, coloured by its
//! stretch.

use super::map_scene::{MapView, place_of};
use super::palette::patch_colors;
use super::scale::SCALES;
use crate::map::divided::Divided;
use crate::map::product::{Product, Shown};
use crate::mesh::Id;
use crate::picture::Picture;
use crate::picture::render::{Camera, Color, Dot, Lens, Line, Paint, Scene, color, contact_sheet, render};
use glam::DVec3;

/// Height of each of the three views, pixels; their width follows the meshes, within bounds.
const HEIGHT: usize = 320;
const WIDTHS: [f64; 2] = [220.0, 500.0];
/// Where the viewer stands, of viewers' terms: before the mesh, a little to the side and above.
const TOWARDS: DVec3 = DVec3::new(0.55, 0.3, 0.78);
const INK: u32 = 0x20242c;

/// The three views side by side. The same map gives the same bytes.
pub fn preview(view: &MapView, product: &Product, shown: &Shown) -> Picture {
    let patches: Vec<Color> = patch_colors(product.base).into_iter().map(color).collect();
    let by_patch = |k: usize| -> Vec<Color> { shown.divided[k].patches.iter().map(|p| patches[p.index()]).collect() };
    let stretch = |f: &crate::mesh::FaceId| stretch_color(view.values[0][f.index()][0]);
    let by_stretch: Vec<Color> = shown.divided[0].faces.iter().map(stretch).collect();
    let views = [(0, 0, by_patch(0)), (1, 1, by_patch(1)), (0, 1, by_stretch)];
    let (cameras, widths): (Vec<Camera>, Vec<f64>) = [0, 1].map(|k| camera(&view.places[k][k])).into_iter().unzip();
    let width = widths.into_iter().fold(0.0, f64::max) as usize;
    let pictures = views.map(|(k, space, colors)| {
        let places = &view.places[k][space];
        let points = in_space(view, k, shown.divided[k], places);
        let mut scene = Scene::new(&points, &shown.divided[k].triangles, Paint::Faces(&colors));
        scene.lines = arcs(view, k, places, if space == k { 1.2 } else { 0.6 });
        if space == k {
            scene.dots = dots(product, k, places);
        }
        render(&scene, &cameras[space], [width, HEIGHT])
    });
    contact_sheet(&pictures, 3)
}

/// A camera for a mesh, and the width of its view.
fn camera(places: &[DVec3]) -> (Camera, f64) {
    let camera = Camera::looking(TOWARDS, DVec3::Y, Lens::Perspective(5.0), places);
    let width = (HEIGHT as f64 * camera.aspect()).clamp(WIDTHS[0], WIDTHS[1]);
    (camera, width)
}

/// The vertices of a divided mesh where the mesh is at `places`.
fn in_space(view: &MapView, k: usize, divided: &Divided, places: &[DVec3]) -> Vec<DVec3> {
    divided.places.iter().map(|&p| place_of(p, view.sides[k].mesh, places)).collect()
}

fn arcs(view: &MapView, k: usize, places: &[DVec3], width: f64) -> Vec<Line> {
    let side = view.sides[k];
    let line = |points: &Vec<_>| Line {
        points: points.iter().map(|&p| place_of(p, side.mesh, places)).collect(),
        color: color(INK),
        width,
    };
    side.arcs.iter().map(line).collect()
}

fn dots(product: &Product, k: usize, places: &[DVec3]) -> Vec<Dot> {
    let landmarks = if k == 0 { &product.landmarks.source } else { &product.landmarks.target };
    landmarks.iter().map(|v| Dot { at: places[v.index()], color: color(INK), radius: 2.6 }).collect()
}

fn stretch_color(value: f64) -> Color {
    let [r, g, b] = SCALES[0].color(value).map(|c| c.round() as u32);
    color(r << 16 | g << 8 | b)
}
