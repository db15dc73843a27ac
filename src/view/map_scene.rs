//! A finished map as a scene: both meshes, and the source on its way to the target.

use super::carried_uv::{carried_uv, own_uv};
use super::fields::fields;
use super::frame::ViewFrame;
use super::image::texture_of;
use super::palette::patch_colors;
use super::scene::{At, Mark, Mode, Panel, Scene, THREE_QUARTER};
use super::stand_in::{MOST_TRIANGLES, stand_in};
use super::surface::{IN_PARTS, Part, Surface};
use crate::map::divided::Divided;
use crate::map::file_order::number_in_file;
use crate::map::product::{Product, Shown, Side};
use crate::mesh::{FaceId, Id, SurfacePoint, TriMesh};
use glam::DVec3;
use std::path::Path;

/// Pairs of points that decide how the target is turned, at most: more say the same.
const PAIRS: usize = 4000;
const SPACES: [&str; 2] = ["source", "target"];

/// The meshes of a map as they are shown: without vertices that a refinement appended.
pub struct MapView<'a> {
    /// Source and target.
    pub sides: [&'a Side<'a>; 2],
    /// Their vertices in viewers' terms, and where their images are: `places[k][j]` are those of mesh k in space j.
    pub places: [[Vec<DVec3>; 2]; 2],
    /// The distortion of their triangles.
    pub values: [Vec<[f64; 3]>; 2],
}

impl<'a> MapView<'a> {
    /// Turns both meshes to the viewer and measures their triangles.
    pub fn new(product: &'a Product<'a>) -> Self {
        let sides = [&product.source, &product.target];
        let images = [image_of(sides[0], sides[1]), image_of(sides[1], sides[0])];
        let own = sides.map(|side| &side.mesh.positions.raw);
        let step = own[0].len().div_ceil(PAIRS).max(1);
        let pairs: Vec<[DVec3; 2]> = (0..own[0].len()).step_by(step).map(|v| [own[0][v], images[0][v]]).collect();
        let first = ViewFrame::upright(own[0]);
        let frames = [first, ViewFrame::alike(own[1], &first, &pairs)];
        let placed = |k: usize, points: &[DVec3]| points.iter().map(|&p| frames[k].place(p)).collect::<Vec<_>>();
        let places = [[placed(0, own[0]), placed(1, &images[0])], [placed(0, &images[1]), placed(1, own[1])]];
        let values = [0, 1].map(|k| fields(&corners(sides[k].mesh), own[k], &images[k]));
        MapView { sides, places, values }
    }

    /// The scene; `flips` are the turned-over triangles of both meshes. True if stand-ins are shown.
    pub fn scene(&self, product: &Product, shown: &Shown, flips: [&[FaceId]; 2]) -> (Scene, bool) {
        let texture = texture_of(self.sides[0].file, shown.texture);
        let mut surfaces: Vec<Surface> = [0, 1].map(|k| self.surface(k, shown.divided[k], flips[k])).into();
        if texture.is_some() {
            surfaces[0].uv = own_uv(self.sides[0]);
            surfaces[1].uv = carried_uv(self.sides[1], self.sides[0], &surfaces[0].uv);
        }
        let reduced = stand_in(&mut surfaces, MOST_TRIANGLES);
        let modes = [Mode::Patches, Mode::Distortion, Mode::Checker, Mode::Texture, Mode::Places, Mode::Plain];
        let scene = Scene {
            panels: panels(self.sides),
            marks: self.marks(product),
            mark_name: "landmark",
            patch_name: "patch",
            patch_names: Vec::new(),
            patch_colors: patch_colors(product.base),
            modes: modes.into_iter().filter(|m| *m != Mode::Texture || texture.is_some()).collect(),
            texture,
            home: THREE_QUARTER,
            by_uv: false,
            surfaces,
        };
        (scene, reduced)
    }

    fn surface(&self, k: usize, divided: &Divided, flips: &[FaceId]) -> Surface {
        let (side, places) = (self.sides[k], &self.places[k]);
        let (patches, parts) = patches(divided, side.mesh);
        let along = |points: &Vec<SurfacePoint>| {
            places.iter().map(|at| points.iter().map(|&p| place_of(p, side.mesh, at)).collect()).collect()
        };
        Surface {
            name: file_name(&side.file.path),
            spaces: SPACES.to_vec(),
            places: places.to_vec(),
            triangles: corners(side.mesh),
            numbers: numbers(side),
            values: self.values[k].clone(),
            patches,
            parts,
            uv: Vec::new(),
            flips: flips.iter().map(|f| f.0).collect(),
            lines: side.arcs.iter().map(along).collect(),
            stands_for: None,
        }
    }

    fn marks(&self, product: &Product) -> Vec<Mark> {
        let given = product.landmarks;
        let place = |k: usize, v: usize| self.places[k][k][v];
        let mark = |(i, name): (usize, &String)| {
            Mark::new(name, [place(0, given.source[i].index()), place(1, given.target[i].index())])
        };
        given.names.iter().enumerate().map(mark).collect()
    }
}

fn panels(sides: [&Side; 2]) -> Vec<Panel> {
    let [source, target] = sides.map(|side| file_name(&side.file.path));
    let panel = |title, subtitle, surface, at| Panel { title, subtitle, surface, at, flat: false, backdrop: false };
    vec![
        panel("Source", source.clone(), 0, At::First),
        panel("Target", target.clone(), 1, At::Second),
        panel("Source on target", format!("{source} \u{2192} {target}"), 0, At::Slider),
    ]
}

/// The last part of a path.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Where the vertices of a mesh lie on the other one; a vertex that no face uses stays where the first one goes.
fn image_of(side: &Side, other: &Side) -> Vec<DVec3> {
    let position = |p: SurfacePoint| p.position(other.mesh);
    let anywhere = side.image.iter().flatten().next().map_or(DVec3::ZERO, |&p| position(p));
    (0..side.mesh.positions.len()).map(|v| side.image.raw[v].map_or(anywhere, position)).collect()
}

/// The triangles of a mesh as plain numbers.
pub fn corners(mesh: &TriMesh) -> Vec<[u32; 3]> {
    mesh.conn.faces().map(|f| mesh.face(f).map(|v| v.0)).collect()
}

/// Where a point of a mesh is when its vertices are at `places`.
pub fn place_of(point: SurfacePoint, mesh: &TriMesh, places: &[DVec3]) -> DVec3 {
    match point {
        SurfacePoint::Vertex(v) => places[v.index()],
        SurfacePoint::Edge(h, t) => places[mesh.conn.from(h).index()] * (1.0 - t) + places[mesh.conn.to(h).index()] * t,
        SurfacePoint::Face(f, b) => mesh.face(f).iter().zip(b).map(|(v, w)| places[v.index()] * w).sum(),
    }
}

/// The polygon of the file that every triangle comes from; empty if all have the same number.
fn numbers(side: &Side) -> Vec<u32> {
    let polygons = side.file.triangle_polygons();
    let faces = side.mesh.conn.faces();
    let numbers: Vec<u32> = faces.map(|f| polygons[number_in_file(f, side.omitted).index()]).collect();
    if (0u32..).zip(&numbers).all(|(i, &n)| i == n) { Vec::new() } else { numbers }
}

/// The patch of every face of a mesh, and the parts of those that lie in several.
fn patches(divided: &Divided, mesh: &TriMesh) -> (Vec<u32>, Vec<Part>) {
    let mut patches: Vec<Option<u32>> = vec![None; mesh.conn.face_count()];
    for (f, p) in divided.faces.iter().zip(&divided.patches) {
        let slot = &mut patches[f.index()];
        *slot = Some(if slot.is_none_or(|known| known == p.0) { p.0 } else { IN_PARTS });
    }
    let mut parts = Vec::new();
    for (i, t) in divided.triangles.iter().enumerate() {
        let f = divided.faces[i];
        if patches[f.index()] == Some(IN_PARTS) {
            let corners = t.map(|v| divided.places[v].barycentric_in(mesh, f).unwrap_or([1.0 / 3.0; 3]));
            parts.push(Part { triangle: f.0, patch: divided.patches[i].0, corners });
        }
    }
    parts.sort_by_key(|part| part.triangle);
    (patches.into_iter().map(|p| p.unwrap_or(0)).collect(), parts)
}
