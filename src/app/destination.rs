//! Where the texels of a carried image lie on the target: in its own texture coordinates, or in the common atlas.

use super::uv::UvTriangles;
use crate::error::{Error, Result};
use crate::map::atlas::{Atlas, Corner, Half};
use crate::map::charts::ChartedMesh;
use crate::map::transport::{Arrival, Transport};
use crate::mesh::PatchId;
use crate::mesh::io::MeshFile;
use glam::{DMat2, DVec2};

/// The triangles that an image is drawn on.
pub struct Destination<'a> {
    uv: UvTriangles,
    /// In the atlas: the mesh over the base complex, and for every triangle its patch and number there.
    atlas: Option<(&'a ChartedMesh, Vec<[u32; 2]>)>,
}

impl<'a> Destination<'a> {
    /// A mesh's own texture coordinates; the atlas if it has none.
    ///
    /// # Errors
    /// Input, if there is no atlas either.
    pub fn of(mesh: &MeshFile, charted: &'a ChartedMesh, atlas: Option<&Atlas>) -> Result<Self> {
        if !mesh.uv.values.is_empty() {
            return Ok(Destination { uv: UvTriangles::of(mesh), atlas: None });
        }
        let none = || {
            let what = "the mesh has no texture coordinates, and the map was made without an atlas";
            Error::input(what).file(&mesh.path).remedy("map the pair again with --image 65")
        };
        let places = AtlasPlaces::new(atlas.ok_or_else(none)?, charted.patches.len());
        let mut corners = Vec::new();
        let mut pieces = Vec::new();
        for (p, patch) in (0u32..).zip(&charted.patches) {
            for (t, triangle) in (0u32..).zip(&patch.triangles) {
                let point = |v: &u32| DVec2::from_array(patch.points[*v as usize]);
                corners.push([0, 1, 2].map(|k| places.uv(PatchId(p), point(&triangle[k]))));
                pieces.push([p, t]);
            }
        }
        let uv = UvTriangles { corners, missing: Vec::new(), flipped: Vec::new() };
        Ok(Destination { uv, atlas: Some((charted, pieces)) })
    }

    /// Where the triangles lie.
    pub fn uv(&self) -> &UvTriangles {
        &self.uv
    }

    /// The own texture coordinates, unless the atlas stands in for them.
    pub fn own(&self) -> Option<&UvTriangles> {
        self.atlas.is_none().then_some(&self.uv)
    }

    /// Where a point of a triangle comes out on the source; the derivative is by the weights of its second and third corner.
    pub fn image(&self, transport: &Transport, triangle: u32, weights: [f64; 3]) -> Option<Arrival> {
        let Some((charted, pieces)) = &self.atlas else { return transport.image(triangle, weights) };
        let [p, t] = pieces[triangle as usize];
        let patch = &charted.patches[p as usize];
        let [a, b, c] = patch.triangles[t as usize].map(|v| DVec2::from_array(patch.points[v as usize]));
        let arrival = transport.arrive(p, a * weights[0] + b * weights[1] + c * weights[2])?;
        Some(Arrival { derivative: arrival.derivative * DMat2::from_cols(b - a, c - a), ..arrival })
    }
}

/// The place of every patch in the atlas.
pub struct AtlasPlaces<'a> {
    atlas: &'a Atlas,
    /// For every patch its tile and half.
    place: Vec<Option<(usize, Corner, Half)>>,
}

impl<'a> AtlasPlaces<'a> {
    /// Of so many patches.
    pub fn new(atlas: &'a Atlas, patches: usize) -> Self {
        let mut place = vec![None; patches];
        for (i, tile) in atlas.tiles.iter().enumerate() {
            for (corner, half) in tile.halves() {
                if let Some(slot) = place.get_mut(half.patch.0 as usize) {
                    *slot = Some((i, corner, half));
                }
            }
        }
        AtlasPlaces { atlas, place }
    }

    /// The texture coordinates of a point of a patch's reference triangle, so that samples lie at the centres of the
    /// geometry images' pixels; not a number for a patch without a place.
    pub fn uv(&self, p: PatchId, at: DVec2) -> DVec2 {
        let Some((tile, corner, half)) = self.place[p.0 as usize] else { return DVec2::NAN };
        let coords = [1.0 - at.x - at.y, at.x, at.y];
        let steps = self.atlas.steps() as f64;
        let (a, b) = (coords[half.side] * steps, coords[(half.side + 1) % 3] * steps);
        let (right, up) = match corner {
            Corner::LowerLeft => (a, b),
            Corner::UpperRight => (steps - a, steps - b),
        };
        let origin = DVec2::new((tile % self.atlas.columns) as f64, (tile / self.atlas.columns) as f64);
        let pixel = origin * self.atlas.tile_size as f64 + DVec2::new(right, steps - up) + 0.5;
        let share = pixel / DVec2::new(self.atlas.width() as f64, self.atlas.height() as f64);
        DVec2::new(share.x, 1.0 - share.y)
    }
}
