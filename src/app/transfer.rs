//! Carries an image from one mesh of a finished map to the other.
//!
//! Input: both meshes, the map at every point, the source's image. Output: the image in the target's texture coordinates.
//! Every texel of the target goes through the map to the source, and there to the source's image, which is averaged over
//! the texel's footprint. Invariant: texels inside the mask show what the source shows at the point that the map gives;
//! gutters show what the nearest of them does.

use super::canvas::{Canvas, Padding, check_size};
use super::destination::Destination;
use super::frames::Frames;
use super::texture::Textures;
use super::udim::{file_of, is_pattern};
use super::uv::{Tile, UvTriangles};
use crate::error::Result;
use crate::gpu::Compute;
use crate::kernel::{NO_TRIANGLE, Texel};
use crate::map::charts::Charts;
use crate::map::transport::{Arrival, Transport, reference_points};
use crate::mesh::io::MeshFile;
use crate::picture::{Picture, file::format_for};
use crate::stage::write::OutputFile;
use glam::{DMat2, DVec2};
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// How to carry an image.
#[derive(Clone, Copy, Debug)]
pub struct TransferOptions {
    /// Texels along a side; none for the size of the source's image.
    pub size: Option<usize>,
    /// How far gutters are filled.
    pub padding: Padding,
    /// The image holds normals in the source's tangent frames; the new one in the target's.
    pub normal_map: bool,
}

/// What was carried.
#[derive(Clone, Debug, Default, Serialize)]
pub struct TransferReport {
    /// The images.
    pub files: Vec<PathBuf>,
    /// Texels inside the masks.
    pub covered: usize,
    /// Texels inside the masks for which the source has no image: its face has no texture coordinates or is left out of the
    /// map. They are transparent black.
    pub unfilled: usize,
}

/// A source with its image, a target to carry it to, and the map between them.
#[derive(Clone, Copy)]
pub struct Journey<'a> {
    /// The source and the target.
    pub meshes: [&'a MeshFile; 2],
    /// The map.
    pub charts: &'a Charts,
    /// The source's image.
    pub textures: &'a Textures,
    /// Where the target's texels lie.
    pub destination: &'a Destination<'a>,
}

/// Carries the source's image to the target, into `out`, or one file per tile where its name has `<UDIM>`.
///
/// # Errors
/// Input, if a file cannot be written; usage, for a size or file name that does not fit.
pub fn transfer(compute: &Compute, journey: Journey, out: &Path, options: &TransferOptions) -> Result<TransferReport> {
    let format = format_for(out, journey.textures.depth())?;
    let mut files = Vec::new();
    let report = carry(compute, journey, is_pattern(out), options, |tile, picture| {
        let path = file_of(out, tile)?;
        let mut file = OutputFile::create(&path)?;
        picture.write(format, file.writer()).map_err(|e| e.file(&path))?;
        file.commit()?;
        files.push(path);
        Ok(())
    })?;
    Ok(TransferReport { files, ..report })
}

/// Makes the target's image, or one for `every_tile`, and hands them over one by one.
///
/// # Errors
/// Those of `take`; usage, for a size out of range.
pub fn carry(
    compute: &Compute,
    journey: Journey,
    every_tile: bool,
    options: &TransferOptions,
    take: impl FnMut(Tile, Picture) -> Result<()>,
) -> Result<TransferReport> {
    let Journey { meshes, charts, textures, destination } = journey;
    let source = UvTriangles::of(meshes[0]);
    let points = reference_points(&charts.meshes[0]);
    let frames = destination.own().filter(|_| options.normal_map).map(|own| Frames::new(meshes, [&source, own]));
    let transport = Transport::new(charts, 1, &points);
    let way = |triangle: u32, weights: [f64; 3]| destination.image(&transport, triangle, weights);
    let carriage = Carriage { source: &source, onto: destination.uv(), textures, way: &way, frames };
    carriage.draw(compute, every_tile, options, take)
}

/// Gives the point of the source for a point of a triangle of the target.
pub type Way<'a> = &'a (dyn Fn(u32, [f64; 3]) -> Option<Arrival> + Sync);

/// Everything that an image of the target follows from.
pub struct Carriage<'a> {
    /// The source's texture coordinates.
    pub source: &'a UvTriangles,
    /// Where the target's texels lie.
    pub onto: &'a UvTriangles,
    /// The source's image.
    pub textures: &'a Textures,
    /// The map.
    pub way: Way<'a>,
    /// Both meshes' tangent frames, for an image of normals.
    pub frames: Option<Frames>,
}

impl Carriage<'_> {
    /// Makes the target's image, or one for `every_tile`, and hands them over one by one.
    ///
    /// # Errors
    /// Those of `take`; usage, for a size out of range.
    pub fn draw(
        &self,
        compute: &Compute,
        every_tile: bool,
        options: &TransferOptions,
        mut take: impl FnMut(Tile, Picture) -> Result<()>,
    ) -> Result<TransferReport> {
        let textures = self.textures;
        let size = options.size.unwrap_or(textures.largest_side());
        check_size(size)?;
        let mut report = TransferReport::default();
        for tile in if every_tile { self.onto.tiles() } else { vec![[0, 0]] } {
            let seen = self.onto.seen_from(tile);
            let canvas = Canvas::new(size, size, &seen);
            let mut pixels = Vec::with_capacity(size * size);
            canvas.bands(compute, options.padding, None, |band| {
                let shown: Vec<Option<[f32; 4]>> = band.texels.par_iter().map(|t| self.shown(&canvas, t)).collect();
                let inside = || band.texels.iter().zip(&shown).filter(|(t, _)| t.covers > 0);
                report.covered += inside().count();
                report.unfilled += inside().filter(|(_, colour)| colour.is_none()).count();
                pixels.extend(shown.into_iter().map(Option::unwrap_or_default));
                Ok(())
            })?;
            let (channels, depth) = (textures.channels(), textures.depth());
            take(tile, Picture { width: size, height: size, channels, depth, pixels })?;
        }
        Ok(report)
    }

    /// What a texel of the target shows of the source's image.
    fn shown(&self, canvas: &Canvas, texel: &Texel) -> Option<[f32; 4]> {
        if texel.triangle == NO_TRIANGLE {
            return None;
        }
        let weights = texel.weights().map(f64::from);
        let arrival = (self.way)(texel.triangle, weights)?;
        let corners = self.source.corners[arrival.face as usize];
        let uv: DVec2 = corners.iter().zip(arrival.b).map(|(&c, b)| c * b).sum();
        if !uv.is_finite() {
            return None;
        }
        let by_weights = DMat2::from_cols(corners[1] - corners[0], corners[2] - corners[0]);
        let by_texel = by_weights * arrival.derivative * canvas.weights_by_texel(texel.triangle);
        let sample = self.textures.sample(uv, by_texel)?;
        Some(match &self.frames {
            Some(frames) => frames.turn(texel.triangle, weights, &arrival, sample),
            None => sample,
        })
    }
}
