//! Bakes maps of a mesh into its own texture coordinates.
//!
//! Input: a mesh with texture coordinates. Output: an EXR file per tile, and beside it the mask of the texels that
//! triangles cover. Invariant: a texel inside the mask holds the value at the surface point it shows; those in the
//! gutters hold that of the nearest texel inside, as far as the padding goes; the rest is zero.

use super::attributes::{BakeMap, corner_values, require_uv};
use super::canvas::{Band, Canvas, Padding, check_size};
use super::udim::{beside, file_of, is_pattern};
use super::uv::{Tile, UvTriangles};
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::kernel::Lanes;
use crate::mesh::io::MeshFile;
use crate::stage::exr::{BandSink, Compression, Format, write_bands};
use crate::stage::write::OutputFile;
use glam::Vec4;
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What to bake.
#[derive(Clone, Copy, Debug)]
pub struct BakeOptions {
    /// The map.
    pub map: BakeMap,
    /// Texels along a side, at most [`super::canvas::LARGEST`].
    pub size: usize,
    /// How far gutters are filled.
    pub padding: Padding,
    /// Of the EXR files.
    pub compression: Compression,
}

/// What was baked, and what is odd about the texture coordinates.
#[derive(Clone, Debug, Default, Serialize)]
pub struct BakeReport {
    /// The images.
    pub files: Vec<PathBuf>,
    /// Texels inside the masks.
    pub covered: usize,
    /// Texels that several triangles cover; the first of them shows.
    pub overlapping: Oddity,
    /// Triangles that are turned over in texture space.
    pub flipped: Oddity,
    /// Triangles without texture coordinates.
    pub missing: Oddity,
    /// Triangles that reach beyond the unit square although there is one tile only.
    pub outside: Oddity,
}

/// How often something odd occurs, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Oddity {
    /// How often.
    pub count: usize,
    /// A face with it: the polygon's number in the file.
    pub face: Option<u32>,
}

impl Oddity {
    fn of(triangles: &[u32], polygons: &[u32]) -> Oddity {
        Oddity { count: triangles.len(), face: triangles.first().map(|&t| polygons[t as usize]) }
    }
}

/// Bakes a map of `mesh` into `out`, an EXR file, or one per tile where its name has `<UDIM>`.
///
/// # Errors
/// Usage, for a size out of range; input, for a mesh without texture coordinates or a file that cannot be written.
pub fn bake(compute: &Compute, mesh: &MeshFile, out: &Path, options: &BakeOptions) -> Result<BakeReport> {
    require_uv(mesh)?;
    check_size(options.size)?;
    let uv = UvTriangles::of(mesh);
    let values = corner_values(mesh, &uv.corners, options.map);
    let polygons = mesh.triangle_polygons();
    let tiles = if is_pattern(out) { uv.tiles() } else { vec![[0, 0]] };
    let outside = if is_pattern(out) { Vec::new() } else { uv.outside() };
    let mut report = BakeReport {
        flipped: Oddity::of(&uv.flipped, &polygons),
        missing: Oddity::of(&uv.missing, &polygons),
        outside: Oddity::of(&outside, &polygons),
        ..BakeReport::default()
    };
    for tile in tiles {
        bake_tile(compute, out, options, (&uv, tile), &values, &polygons, &mut report)?;
    }
    Ok(report)
}

fn bake_tile(
    compute: &Compute,
    out: &Path,
    options: &BakeOptions,
    (uv, tile): (&UvTriangles, Tile),
    values: &[[Lanes; 3]],
    polygons: &[u32],
    report: &mut BakeReport,
) -> Result<()> {
    let seen = uv.seen_from(tile);
    let canvas = Canvas::new(options.size, options.size, &seen);
    let path = file_of(out, tile)?;
    let mask_path = beside(&path, "mask");
    let (mut image, mut mask) = (OutputFile::create(&path)?, OutputFile::create(&mask_path)?);
    let [name, unit] = options.map.words();
    let names: &[&str] = if options.map.is_vector() { &["B", "G", "R"] } else { &["Y"] };
    let mut rows = Rows::default();
    let format = |names| Format { size: [options.size; 2], names, compression: options.compression };
    write_bands(format(names), &metadata(name, unit)?, image.writer(), |image| {
        write_bands(format(&["Y"]), &metadata("mask", "1 inside, 0 outside")?, mask.writer(), |mask| {
            canvas.bands(compute, options.padding, Some(values), |band| {
                count(band, polygons, report);
                rows.write_mask(band, mask)?;
                rows.write_planes(&band.pixels, names.len(), options.map.is_direction(), image)
            })
        })
    })
    .map_err(|e| if e.file.is_empty() { e.file(&path) } else { e })?;
    image.commit()?;
    mask.commit()?;
    report.files.extend([path, mask_path]);
    Ok(())
}

fn count(band: &Band, polygons: &[u32], report: &mut BakeReport) {
    report.covered += band.texels.par_iter().filter(|t| t.covers > 0).count();
    let several = || band.texels.par_iter().filter(|t| t.covers > 1);
    report.overlapping.count += several().count();
    if report.overlapping.count > 0 && report.overlapping.face.is_none() {
        report.overlapping.face = several().find_first(|_| true).map(|t| polygons[t.triangle as usize]);
    }
}

/// Rows on their way into files: memory that serves every band.
#[derive(Default)]
struct Rows {
    mask: Vec<f32>,
    planes: [Vec<f32>; 3],
}

impl Rows {
    fn write_mask(&mut self, band: &Band, sink: &mut BandSink) -> Result<()> {
        let inside = band.texels.par_iter().map(|t| f32::from(u8::from(t.covers > 0)));
        inside.collect_into_vec(&mut self.mask);
        sink(&[&self.mask])
    }

    /// Hands over the first lanes of pixels, as unit vectors if they are `directions`, the last channel first: `B`, `G`, `R`.
    fn write_planes(&mut self, pixels: &[Lanes], channels: usize, directions: bool, sink: &mut BandSink) -> Result<()> {
        let unit = |p: &Lanes| Vec4::from_array(*p).normalize_or_zero().to_array();
        for (k, plane) in (0..channels).rev().zip(&mut self.planes) {
            let value = |p: &Lanes| if directions { unit(p)[k] } else { p[k] };
            pixels.par_iter().map(value).collect_into_vec(plane);
        }
        sink(&self.planes.each_ref().map(Vec::as_slice)[..channels])
    }
}

/// The JSON text of a baked image.
#[derive(Serialize)]
struct Metadata<'a> {
    version: u32,
    image: &'a str,
    units: &'a str,
    #[serde(rename = "colorInteropID")]
    color_interop_id: &'a str,
}

fn metadata(image: &str, units: &str) -> Result<String> {
    let metadata = Metadata { version: crate::stage::bake::METADATA_VERSION, image, units, color_interop_id: "data" };
    serde_json::to_string(&metadata).map_err(|error| Error::bug(error.to_string()))
}
