//! What regions look like: the grid of the paper's figures, one atlas with a colour for every region, and previews.

use super::Diffusion;
use crate::mesh::{FaceId, Id, VertexId};
use crate::picture::render::{Camera, Color, Dot, Lens, Line, Paint, Scene, View, color, contact_sheet, render};
use crate::picture::{Depth, Picture, Pyramid};
use glam::DVec2;

/// Squares along a side of the grid.
const SQUARES: usize = 10;
/// Texels along a side of the grid's image.
pub const GRID: usize = 640;
/// Texels along a side of a cell of the atlas, and of the whole atlas at most.
const CELL: usize = 240;
const LARGEST_ATLAS: usize = 4096;
/// Share of a cell that stays free at its border, so that neighbours do not bleed in.
const INSET: f64 = 0.04;
/// Height of one view of a preview, pixels; its width follows the mesh, within bounds.
const HEIGHT: usize = 560;
const WIDTHS: [f64; 2] = [300.0, 800.0];

/// Colours of regions, one after the other: light enough for lines to show, and told apart without red and green.
const TINTS: [u32; 8] = [0x8fb8de, 0xf2c879, 0xa8d5ba, 0xd7a6c8, 0xc9c9c9, 0xf0a58f, 0x9fd8e0, 0xd9d98c];
/// Folded triangles.
const FOLDED: u32 = 0xd00000;
const LINE: u32 = 0x20242c;

/// The colour of a region.
pub fn tint(region: usize) -> Color {
    color(tint_code(region))
}

/// The same as an sRGB code.
pub fn tint_code(region: usize) -> u32 {
    TINTS[region % TINTS.len()]
}

/// The grid as an image: dark lines on white, thicker ones at the border, u = 0 at the left, v = 0 at the bottom.
pub fn grid() -> Picture {
    picture(GRID, |x, y| on_grid(cell_share(x, GRID), cell_share(y, GRID), [1.0; 3]))
}

fn cell_share(texel: usize, size: usize) -> f64 {
    (texel as f64 + 0.5) / size as f64
}

/// The grid's colour at a share of its side to the right and up.
fn on_grid(u: f64, v: f64, ground: Color) -> Color {
    /// Half the width of a line by that of a square, and of the border by that of the grid.
    const HALF_LINE: f64 = 0.06;
    const BORDER: f64 = 0.012;
    let near_line = |x: f64| {
        let x = x * SQUARES as f64;
        (x - x.round()).abs() < HALF_LINE
    };
    let at_border = |x: f64| !(BORDER..1.0 - BORDER).contains(&x);
    let dark = (u * SQUARES as f64).floor() + (v * SQUARES as f64).floor();
    if at_border(u) || at_border(v) || near_line(u) || near_line(v) {
        color(LINE)
    } else if dark.rem_euclid(2.0) == 0.0 {
        ground
    } else {
        ground.map(|c| c * 0.72)
    }
}

fn picture(size: usize, shade: impl Fn(usize, usize) -> Color) -> Picture {
    let pixel = |i: usize| {
        let [r, g, b] = shade(i % size, size - 1 - i / size);
        [r, g, b, 1.0]
    };
    Picture {
        width: size,
        height: size,
        channels: 3,
        depth: Depth::Byte,
        pixels: (0..size * size).map(pixel).collect(),
    }
}

/// A square atlas of cells, one for every region and one for folds.
#[derive(Clone, Copy, Debug)]
pub struct Cells {
    regions: usize,
    columns: usize,
}

impl Cells {
    /// For so many regions.
    pub fn new(regions: usize) -> Self {
        let columns = (1..).find(|n| n * n > regions).unwrap_or(1);
        Cells { regions, columns }
    }

    /// Where (u, v) of a region lies in the atlas.
    pub fn place(&self, region: usize, uv: DVec2) -> DVec2 {
        let cell = DVec2::new((region % self.columns) as f64, (region / self.columns) as f64);
        (cell + INSET + uv * (1.0 - 2.0 * INSET)) / self.columns as f64
    }

    /// The atlas with a tinted grid for every region.
    pub fn image(&self) -> Picture {
        let cell = CELL.min(LARGEST_ATLAS / self.columns).max(8);
        picture(cell * self.columns, |x, y| {
            let region = x / cell + y / cell * self.columns;
            let share = |t: usize| ((cell_share(t % cell, cell) - INSET) / (1.0 - 2.0 * INSET)).clamp(0.0, 1.0);
            if region < self.regions { on_grid(share(x), share(y), tint(region)) } else { color(FOLDED) }
        })
    }
}

/// Two views of every mesh, in the first one's directions, with its grids, borders, corners, and folds in red.
pub fn preview(meshes: &[&Diffusion]) -> Picture {
    let first = meshes.first().map_or(&[][..], |diffusion| &diffusion.mesh.positions.raw);
    let views =
        [View::ThreeQuarter, View::ThreeQuarterBack].map(|view| Camera::new(view, Lens::Perspective(5.0), first));
    let pictures: Vec<Picture> =
        meshes.iter().flat_map(|diffusion| views.map(|camera| one_view(diffusion, &camera))).collect();
    contact_sheet(&pictures, views.len())
}

fn one_view(diffusion: &Diffusion, like: &Camera) -> Picture {
    let mesh = diffusion.mesh;
    let cells = Cells::new(diffusion.pieces.len());
    let image = Pyramid::new(&cells.image());
    let mut uv = vec![[DVec2::NAN; 3]; mesh.conn.face_count()];
    for (r, piece) in diffusion.pieces.iter().enumerate() {
        for (f, t) in piece.disc.faces.iter().zip(&piece.disc.triangles) {
            uv[f.index()] = t.map(|v| cells.place(r, piece.uv(v as usize)));
        }
        let red = |f: &FaceId| uv[f.index()] = [cells.place(diffusion.pieces.len(), DVec2::splat(0.5)); 3];
        diffusion.quality[r].folds.iter().for_each(red);
    }
    let faces = mesh.faces();
    let mut scene = Scene::new(&mesh.positions.raw, &faces, Paint::Texture(&uv, &image));
    scene.lines = borders(diffusion);
    let corners = diffusion.pieces.iter().flat_map(|p| p.sides.iter().map(|s| p.disc.vertices[s.vertices[0] as usize]));
    scene.dots = corners.map(|v| Dot { at: mesh.positions[v], color: color(LINE), radius: 2.0 }).collect();
    let camera = like.fitted_to(&mesh.positions.raw);
    let width = (HEIGHT as f64 * camera.aspect()).clamp(WIDTHS[0], WIDTHS[1]) as usize;
    render(&scene, &camera, [width, HEIGHT])
}

/// The borders between regions, an edge each.
fn borders(diffusion: &Diffusion) -> Vec<Line> {
    let mesh = diffusion.mesh;
    let ends = |h| [mesh.conn.from(h), mesh.conn.to(h)].map(|v: VertexId| mesh.positions[v]).to_vec();
    let rims = diffusion.pieces.iter().flat_map(|piece| &piece.disc.rim);
    let once = rims.filter(|&&h| mesh.conn.is_edge_representative(h));
    once.map(|&h| Line { points: ends(h), color: color(LINE), width: 1.6 }).collect()
}
