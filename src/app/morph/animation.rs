//! A morph as a moving picture: from the source to every target and back, over and over.

use crate::error::Result;
use crate::mesh::VertexId;
use crate::mesh::io::{MeshFile, MorphTarget};
use crate::picture::moving::{Still, write_loop};
use crate::picture::render::{Camera, Lens, Paint, Scene, color, render};
use crate::picture::{Picture, Pyramid, read_picture};
use crate::view::frame::ViewFrame;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::path::Path;

/// Width and height, pixels.
const SIZE: [usize; 2] = [360, 300];
/// Pictures from one shape to the next, both included.
const STEPS: usize = 18;
/// How long a picture stands, and how long a finished shape does, milliseconds.
const MOMENT: u32 = 60;
const REST: u32 = 700;
/// Pairs of points that decide how a target is turned, at most.
const PAIRS: usize = 4000;
/// Where the viewer stands, in viewers' terms.
const TOWARDS: DVec3 = DVec3::new(0.55, 0.38, 0.75);
/// Fired clay, for meshes without an image.
const CLAY: u32 = 0xd99a6c;

/// The GIF file's bytes; the image is shown where the mesh has texture coordinates.
///
/// # Errors
/// Input, if the image cannot be read.
pub fn animation(mesh: &MeshFile, targets: &[MorphTarget], image: Option<&Path>) -> Result<Vec<u8>> {
    let image = image.map(|path| read_picture(path, false)).transpose()?.map(|picture| Pyramid::new(&picture));
    let uv: Vec<[DVec2; 3]> = match image {
        Some(_) => mesh.triangle_corners().map(|t| t.map(|c| mesh.uv.at(c).unwrap_or(DVec2::NAN))).collect(),
        None => Vec::new(),
    };
    let paint = image.as_ref().map_or(Paint::Plain(color(CLAY)), |image| Paint::Texture(&uv, image));
    let triangles = mesh.triangles();
    let shapes = shapes(mesh, targets);
    let everything: Vec<DVec3> = shapes.iter().flatten().copied().collect();
    let camera = Camera::looking(TOWARDS, DVec3::Y, Lens::Perspective(5.0), &everything);
    let ways: Vec<Vec<Picture>> =
        shapes[1..].iter().map(|end| way([&shapes[0], end], &triangles, paint, &camera)).collect();
    let mut bytes = Vec::new();
    write_loop(&to_and_fro(&ways), &mut bytes)?;
    Ok(bytes)
}

/// The source and the targets in viewers' terms.
fn shapes(mesh: &MeshFile, targets: &[MorphTarget]) -> Vec<Vec<DVec3>> {
    let source = &mesh.positions;
    let first = ViewFrame::upright(source);
    let placed = |frame: &ViewFrame, points: &[DVec3]| points.iter().map(|&p| frame.place(p)).collect();
    let step = source.len().div_ceil(PAIRS).max(1);
    let target = |t: &MorphTarget| {
        let pairs: Vec<[DVec3; 2]> = (0..source.len()).step_by(step).map(|v| [source[v], t.positions[v]]).collect();
        placed(&ViewFrame::alike(&t.positions, &first, &pairs), &t.positions)
    };
    std::iter::once(placed(&first, source)).chain(targets.iter().map(target)).collect()
}

/// Pictures on the straight way between two shapes, slow at both ends.
fn way(ends: [&Vec<DVec3>; 2], triangles: &[[VertexId; 3]], paint: Paint, camera: &Camera) -> Vec<Picture> {
    let still = |i: usize| {
        let t = i as f64 / (STEPS - 1) as f64;
        let t = t * t * (3.0 - 2.0 * t);
        let positions: Vec<DVec3> = ends[0].iter().zip(ends[1]).map(|(&a, &b)| a * (1.0 - t) + b * t).collect();
        render(&Scene::new(&positions, triangles, paint), camera, SIZE)
    };
    (0..STEPS).into_par_iter().map(still).collect()
}

/// Along every way and back.
fn to_and_fro(ways: &[Vec<Picture>]) -> Vec<Still<'_>> {
    let still = |way: &'_ [Picture], i: usize| {
        let is_end = i == 0 || i + 1 == way.len();
        if is_end { REST } else { MOMENT }
    };
    let there_and_back = |way| (0..STEPS).chain((1..STEPS - 1).rev()).map(move |i| (way, i));
    let order = ways.iter().flat_map(there_and_back);
    order.map(|(way, i): (&Vec<Picture>, usize)| (&way[i], still(way, i))).collect()
}
