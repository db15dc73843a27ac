//! An image of the first mesh carried to the second, by the code of [`crate::app::transfer`].

use super::Diffusion;
use super::lookup::{Lookup, Place};
use crate::app::texture::Textures;
use crate::app::transfer::{Carriage, TransferOptions, TransferReport};
use crate::app::uv::{Tile, UvTriangles};
use crate::error::Result;
use crate::gpu::Compute;
use crate::map::file_order::Onto;
use crate::map::transport::Arrival;
use crate::mesh::io::MeshFile;
use crate::mesh::{FaceId, VertexId};
use crate::picture::Picture;
use glam::{DMat2, DVec2};
use std::collections::HashMap;

/// The region of every triangle of a mesh's file, and (u, v) at its corners, in the file's order.
pub fn by_triangle(diffusion: &Diffusion, triangles: &[[VertexId; 3]]) -> Vec<(usize, [DVec2; 3])> {
    let mut all = vec![(0, [DVec2::NAN; 3]); triangles.len()];
    for (r, piece) in diffusion.pieces.iter().enumerate() {
        let number: HashMap<VertexId, usize> = piece.disc.vertices.iter().copied().zip(0..).collect();
        for f in &piece.disc.faces {
            let t = f.0 as usize;
            all[t] = (r, triangles[t].map(|v| number.get(&v).map_or(DVec2::NAN, |&i| piece.uv(i))));
        }
    }
    all
}

/// Carries the image of the first mesh of a pair onto triangles of the second.
///
/// # Errors
/// Those of `take`; usage, for a size out of range.
pub fn carry_image(
    compute: &Compute,
    [first, second]: [(&Diffusion, &MeshFile); 2],
    textures: &Textures,
    onto: &UvTriangles,
    options: &TransferOptions,
    take: impl FnMut(Tile, Picture) -> Result<()>,
) -> Result<TransferReport> {
    let triangles = [first.1, second.1].map(MeshFile::triangles);
    let places = [by_triangle(first.0, &triangles[0]), by_triangle(second.0, &triangles[1])];
    let source = UvTriangles::of(first.1);
    let lookup = Lookup::new(first.0.mesh, &first.0.pieces);
    let file = Onto { mesh: first.0.mesh, triangles: &triangles[0], omitted: &[] };
    let way = |triangle: u32, weights: [f64; 3]| {
        let (region, corners) = places[1][triangle as usize];
        let uv: DVec2 = corners.iter().zip(weights).map(|(&c, w)| c * w).sum();
        if !uv.is_finite() {
            return None;
        }
        let found = lookup.point(Place { region, uv });
        let face: FaceId = first.0.pieces[region].disc.faces[found.triangle];
        let (face, b) = file.to_file_order(face, found.weights);
        let derivative = edges(places[0][face.0 as usize].1).inverse() * edges(corners);
        Some(Arrival { face: face.0, b, derivative })
    };
    let carriage = Carriage { source: &source, onto, textures, way: &way, frames: None };
    let every_tile = onto.tiles().len() > 1;
    carriage.draw(compute, every_tile, options, take)
}

/// The matrix that takes the unit vectors to a triangle's edges at its first corner.
fn edges([a, b, c]: [DVec2; 3]) -> DMat2 {
    DMat2::from_cols(b - a, c - a)
}
