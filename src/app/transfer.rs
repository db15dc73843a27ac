//! Carries an image from one mesh of a finished map to the other.
//!
//! Input: both meshes, the map at every point, the source's image. Output: the image in the target's texture coordinates.
//! Every texel of the target goes through the map to the source, and there to the source's image, which is averaged over
//! the texel's footprint. Invariant: texels inside the mask show what the source shows at the point that the map gives;
//! gutters show what the nearest of them does.

use super::canvas::{Canvas, Padding, check_size};
use super::frames::Frames;
use super::texture::Textures;
use super::udim::{file_of, is_pattern};
use super::uv::UvTriangles;
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

/// The largest side of an image: it is held in memory as a whole.
pub const LARGEST: usize = 16384;

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

/// Carries the source's image into the texture coordinates of the target, into `out`, or one file per tile where its
/// name has `<UDIM>`.
///
/// # Errors
/// Input, if a mesh has no texture coordinates or a file cannot be written; usage, for a size or file name that does not fit.
pub fn transfer(
    compute: &Compute,
    [source, target]: [&MeshFile; 2],
    charts: &Charts,
    textures: &Textures,
    out: &Path,
    options: &TransferOptions,
) -> Result<TransferReport> {
    let size = options.size.unwrap_or(textures.largest_side());
    check_size(size, LARGEST)?;
    let format = format_for(out, textures.depth())?;
    let (from, onto) = (UvTriangles::of(target), UvTriangles::of(source));
    let points = reference_points(&charts.meshes[0]);
    let carrier = Carrier {
        transport: Transport::new(charts, 1, &points),
        source: &onto,
        textures,
        frames: options.normal_map.then(|| Frames::new([source, target], [&onto, &from])),
    };
    let mut report = TransferReport::default();
    let tiles = if is_pattern(out) { from.tiles() } else { vec![[0, 0]] };
    for tile in tiles {
        let canvas = Canvas::new(size, size, &from.seen_from(tile));
        let mut pixels = Vec::with_capacity(size * size);
        canvas.bands(compute, options.padding, |band| {
            let covered = |t: &&Texel| t.covers > 0;
            let shown: Vec<Option<[f32; 4]>> = band.texels.par_iter().map(|t| carrier.shown(&canvas, t)).collect();
            report.covered += band.texels.iter().filter(covered).count();
            report.unfilled += band.texels.iter().zip(&shown).filter(|(t, c)| t.covers > 0 && c.is_none()).count();
            pixels.extend(shown.into_iter().map(Option::unwrap_or_default));
            Ok(())
        })?;
        let channels = textures.channels();
        let picture = Picture { width: size, height: size, channels, depth: textures.depth(), pixels };
        let path = file_of(out, tile)?;
        let mut file = OutputFile::create(&path)?;
        picture.write(format, file.writer()).map_err(|e| e.file(&path))?;
        file.commit()?;
        report.files.push(path);
    }
    Ok(report)
}

/// Everything a texel needs.
struct Carrier<'a> {
    transport: Transport<'a>,
    source: &'a UvTriangles,
    textures: &'a Textures,
    frames: Option<Frames>,
}

impl Carrier<'_> {
    /// What a texel of the target shows of the source's image.
    fn shown(&self, canvas: &Canvas, texel: &Texel) -> Option<[f32; 4]> {
        if texel.triangle == NO_TRIANGLE {
            return None;
        }
        let weights = texel.weights().map(f64::from);
        let arrival = self.transport.image(texel.triangle, weights)?;
        let corners = self.source.corners[arrival.face as usize];
        let uv: DVec2 = corners.iter().zip(arrival.b).map(|(&c, b)| c * b).sum();
        if !uv.is_finite() {
            return None;
        }
        let by_weights = DMat2::from_cols(corners[1] - corners[0], corners[2] - corners[0]);
        let by_texel = by_weights * arrival.derivative * canvas.weights_by_texel(texel.triangle);
        let sample = self.textures.sample(uv, by_texel)?;
        Some(self.turned(texel.triangle, weights, &arrival, sample))
    }

    /// A normal in the target's frame; anything else as it is.
    fn turned(&self, triangle: u32, weights: [f64; 3], arrival: &Arrival, sample: [f32; 4]) -> [f32; 4] {
        match &self.frames {
            Some(frames) => frames.turn(triangle, weights, arrival, sample),
            None => sample,
        }
    }
}
