//! A picture of the result: the textured mesh, the same with a checker, and the layout over the image.

use super::sheet::{Sheet, border};
use crate::mesh::{VertexId, metric};
use crate::picture::render::{Camera, Dot, Lens, Line, Paint, Scene, color, contact_sheet, render};
use crate::picture::{Picture, Pyramid};
use glam::{DVec2, DVec3};

/// Pixels along a side of each of the three parts.
const SIZE: usize = 640;
/// Squares of the checker along the image's side.
const CHECKER: f64 = 32.0;

/// Draws the three parts side by side, the mesh seen from where its features look, the image's up upwards.
pub fn preview(sheet: &Sheet, image: &Picture) -> Picture {
    let pyramid = Pyramid::new(image);
    let triangles: Vec<[VertexId; 3]> = sheet.triangles[..sheet.real].iter().map(|t| t.map(VertexId)).collect();
    let uv: Vec<[DVec2; 3]> = (0..sheet.real).map(|t| sheet.planar(t)).collect();
    let camera = camera(sheet);
    let dots: Vec<Dot> = sheet.features.iter().map(|f| dot(sheet.points[f.vertex as usize])).collect();
    let squares = [color(0xf7f7f7), color(0x3b6ea5)];
    let paints = [Paint::Texture(&uv, &pyramid), Paint::Checker(&uv, CHECKER, squares)];
    let mut parts: Vec<Picture> = paints
        .into_iter()
        .map(|paint| {
            let scene = Scene { dots: dots.clone(), ..Scene::new(&sheet.points, &triangles, paint) };
            render(&scene, &camera, [SIZE, SIZE])
        })
        .collect();
    parts.push(layout(sheet, &pyramid));
    contact_sheet(&parts, 3)
}

fn dot(at: DVec3) -> Dot {
    Dot { at, color: color(0xd7301f), radius: 3.5 }
}

/// The image with the edges of the mesh and the features on it.
fn layout(sheet: &Sheet, pyramid: &Pyramid) -> Picture {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let positions = corners.map(|p| p.extend(0.0));
    let halves = [[0, 1, 2], [0, 2, 3]];
    let uv = halves.map(|t| t.map(|i: usize| corners[i]));
    let triangles = halves.map(|t| t.map(|i| VertexId(i as u32)));
    let at = |p: DVec2| p.extend(0.0);
    let line = |points: Vec<DVec3>, color, width| Line { points, color, width };
    let closed = |t: [DVec2; 3]| [t[0], t[1], t[2], t[0]].map(at).to_vec();
    let edges = (0..sheet.real).map(|t| line(closed(sheet.planar(t)), color(0x0a0a0a), 0.3));
    let rim: Vec<DVec3> =
        sheet.boundary.iter().chain(sheet.boundary.first()).map(|&v| at(sheet.uv[v as usize])).collect();
    let lines = edges.chain([line(rim, color(0xe08214), 2.0)]).collect();
    let dots = sheet.features.iter().map(|f| dot(at(f.place))).collect();
    let scene = Scene { lines, dots, ..Scene::new(&positions, &triangles, Paint::Texture(&uv, pyramid)) };
    let points: Vec<DVec3> = border().into_iter().map(at).collect();
    render(&scene, &Camera::looking(DVec3::Z, DVec3::Y, Lens::Orthographic, &points), [SIZE, SIZE])
}

/// Looks against the mean normal around the features, or of all, with increasing v upwards.
fn camera(sheet: &Sheet) -> Camera {
    let [normal, up] = outlook(sheet);
    Camera::looking(normal, up, Lens::Orthographic, &sheet.points)
}

/// Where the sheet looks around its features, or all of it, and the direction of increasing v there.
pub fn outlook(sheet: &Sheet) -> [DVec3; 2] {
    let near: Vec<usize> = (0..sheet.real)
        .filter(|&t| sheet.features.is_empty() || sheet.triangles[t].iter().any(|&v| is_feature(sheet, v)))
        .collect();
    let (mut normal, mut up) = (DVec3::ZERO, DVec3::ZERO);
    for t in near {
        let ([a, b, c], [p, q, r]) = (sheet.spatial(t), sheet.planar(t));
        normal += (b - a).cross(c - a).normalize_or_zero();
        let area = 2.0 * metric::signed_area([p, q, r]);
        let along = (a * (r.x - q.x) + b * (p.x - r.x) + c * (q.x - p.x)) / area;
        up += along.normalize_or_zero();
    }
    [normal, up]
}

fn is_feature(sheet: &Sheet, v: u32) -> bool {
    sheet.features.iter().any(|f| f.vertex == v)
}
