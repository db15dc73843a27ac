//! Sews the grids of all patches along the arcs by the tile table.
//!
//! Borders are sewn by number, never by position, so the mesh is closed wherever the base complex is. A base complex
//! may have patches that meet themselves or each other along several arcs; near landmarks with one or two arcs the grid
//! then has edges with common ends, which a triangle mesh cannot tell apart: such edges are split, see `glued`.

use super::glued::{Glued, NONE, Node};
use super::{PositionImage, Rebuilt};
use crate::error::{Error, Result};
use crate::map::atlas::{BaseSample, Corner, Half, Pixel};
use crate::mesh::io::Attribute;
use crate::mesh::{Id, TriMesh, VertexId};
use glam::{DVec2, DVec3};

/// The mesh that a position image holds; watertight if the base complex is closed, with its Euler characteristic.
///
/// Every patch becomes `steps^2` triangles, more where edges had to be split. Vertices appear tile by tile, each at its
/// first pixel.
///
/// # Errors
/// Input, if two pixels of one place on an arc differ, a position is not finite, or the tile table describes no surface.
pub fn rebuild(image: &PositionImage) -> Result<Rebuilt> {
    let mut sewing = Sewing::new(image);
    for (tile, entry) in image.atlas.tiles.iter().enumerate() {
        for (corner, half) in entry.halves() {
            sewing.add_patch(tile, corner, half)?;
        }
    }
    let mut glued = sewing.glued;
    glued.separate_edges()?;
    let faces: Vec<[VertexId; 3]> = glued.faces().map(|face| face.map(|node| VertexId::new(node.vertex))).collect();
    let corners = glued.faces().flatten().map(|node| node.uv as u32).collect();
    let uv = Attribute { values: glued.uv, corners };
    // A table whose arcs fit together can still let two cones share their tip.
    let no_surface = |fault| {
        let remedy = "the tile table is damaged: write the geometry image again";
        Error::input(format!("the patches form no surface: {fault:?}")).remedy(remedy)
    };
    Ok(Rebuilt { mesh: TriMesh::new(glued.positions, &faces).map_err(no_surface)?, uv })
}

/// The nodes of a triangle cut into `steps` along each side: triples of whole numbers that sum to `steps`.
#[derive(Clone, Copy)]
struct Grid {
    steps: usize,
}

impl Grid {
    /// The number of a node in the order of [`Grid::nodes`].
    fn number(self, [i, j, _]: [usize; 3]) -> usize {
        i * (2 * self.steps + 3 - i) / 2 + j
    }

    fn len(self) -> usize {
        (self.steps + 1) * (self.steps + 2) / 2
    }

    fn nodes(self) -> impl Iterator<Item = [usize; 3]> {
        let n = self.steps;
        (0..=n).flat_map(move |i| (0..=n - i).map(move |j| [i, j, n - i - j]))
    }
}

/// Patches as they are sewn together.
struct Sewing<'a> {
    image: &'a PositionImage,
    /// The mesh vertex of every landmark, then of every inner sample of every arc, then of every pixel.
    vertex_at: Vec<usize>,
    /// The texture coordinates of every pixel.
    uv_at: Vec<usize>,
    /// The half-edge first met on every step of every arc.
    half_edge_at: Vec<usize>,
    glued: Glued,
}

impl<'a> Sewing<'a> {
    fn new(image: &'a PositionImage) -> Self {
        let PositionImage { atlas, base, pixels } = image;
        let places = base.landmarks + base.arcs.len() * (atlas.steps() - 1) + pixels.len();
        Sewing {
            image,
            vertex_at: vec![NONE; places],
            uv_at: vec![NONE; pixels.len()],
            half_edge_at: vec![NONE; base.arcs.len() * atlas.steps()],
            glued: Glued::default(),
        }
    }

    /// Adds the grid of a patch and joins it to itself and to the patches before it.
    ///
    /// Around node (i, j, k) of the next coarser grid stands the upright triangle of nodes (i+1, j, k), (i, j+1, k),
    /// (i, j, k+1), whose edge 0 keeps the third coordinate, edge 1 the first and edge 2 the second. The triangles
    /// between them are the same turned by half a circle, and their edges 0, 1, 2 lie at edges 0, 1, 2 of the upright
    /// triangles with k, i, j one higher.
    fn add_patch(&mut self, tile: usize, corner: Corner, half: Half) -> Result<()> {
        let nodes = Grid { steps: self.image.atlas.steps() };
        let mut corners = Vec::with_capacity(nodes.len());
        for node in nodes.nodes() {
            let pixel = self.image.atlas.pixel(tile, corner, half, node);
            corners.push(Node { vertex: self.vertex(pixel)?, uv: self.uv(pixel) });
        }
        let corner = |node: [usize; 3]| corners[nodes.number(node)];
        let upright = Grid { steps: nodes.steps - 1 };
        let first = self.glued.face_count();
        for [i, j, k] in upright.nodes() {
            self.glued.add_face([[i + 1, j, k], [i, j + 1, k], [i, j, k + 1]].map(corner));
        }
        for [i, j, k] in upright.steps.checked_sub(1).into_iter().flat_map(|steps| Grid { steps }.nodes()) {
            let f = self.glued.add_face([[i, j + 1, k + 1], [i + 1, j, k + 1], [i + 1, j + 1, k]].map(corner));
            for (edge, across) in [[i, j, k + 1], [i + 1, j, k], [i, j + 1, k]].into_iter().enumerate() {
                self.glued.join(3 * f + edge, 3 * (first + upright.number(across)) + edge);
            }
        }
        for side in 0..3 {
            for step in 0..nodes.steps {
                let mut at = [0; 3];
                at[side] = upright.steps - step;
                at[(side + 1) % 3] = step;
                self.sew(half, side, step, 3 * (first + upright.number(at)) + side);
            }
        }
        Ok(())
    }

    /// Joins half-edge `h`, on step number `step` of a side, to the one on the arc's other side once that is there.
    fn sew(&mut self, half: Half, side: usize, step: usize, h: usize) {
        let directed = self.image.base.patches[half.patch][side];
        let steps = self.image.atlas.steps();
        let along = if directed.reversed { steps - 1 - step } else { step };
        let slot = &mut self.half_edge_at[directed.arc.index() * steps + along];
        if *slot == NONE {
            *slot = h;
        } else {
            self.glued.join(h, *slot);
        }
    }

    /// The mesh vertex at a pixel: a new one, or the one that stands at the same place of the base complex.
    fn vertex(&mut self, pixel: Pixel) -> Result<usize> {
        let index = self.image.atlas.index(pixel);
        let position = DVec3::from(self.image.pixels[index].map(f64::from));
        if !position.is_finite() {
            return Err(damaged("a position is not a finite number", pixel));
        }
        let place = self.place(pixel, index);
        if self.vertex_at[place] == NONE {
            self.vertex_at[place] = self.glued.positions.len();
            self.glued.positions.push(position);
        }
        let v = self.vertex_at[place];
        if self.glued.positions[v] == position {
            return Ok(v);
        }
        Err(damaged("a pixel differs from another that samples the same point", pixel))
    }

    /// The texture coordinates of a pixel's centre, v up.
    fn uv(&mut self, pixel: Pixel) -> usize {
        let atlas = &self.image.atlas;
        let slot = &mut self.uv_at[atlas.index(pixel)];
        if *slot == NONE {
            *slot = self.glued.uv.len();
            let share = |at: usize, size: usize| (at as f64 + 0.5) / size as f64;
            self.glued.uv.push(DVec2::new(share(pixel.x, atlas.width()), 1.0 - share(pixel.y, atlas.height())));
        }
        *slot
    }

    /// The slot of [`Sewing::vertex_at`] for a pixel inside the mask.
    fn place(&self, pixel: Pixel, index: usize) -> usize {
        let PositionImage { atlas, base, .. } = self.image;
        let steps = atlas.steps();
        match atlas.sample(base, pixel) {
            Some(BaseSample::Landmark(l)) => l.index(),
            // A share is a multiple of 1 / steps, exactly.
            Some(BaseSample::OnArc(a, s)) => base.landmarks + a.index() * (steps - 1) + (s * steps as f64) as usize - 1,
            _ => base.landmarks + base.arcs.len() * (steps - 1) + index,
        }
    }
}

fn damaged(what: &str, pixel: Pixel) -> Error {
    let remedy = "geometry images must not be resized, filtered or stored with less than 32 bits";
    Error::input(what).at(format!("column {}, row {}", pixel.x, pixel.y)).remedy(remedy)
}
