//! Writes a finished map: meshes, image points, layout, report, into a folder that appears complete or not at all.

pub mod file;
pub mod folder;
pub mod points_csv;

pub use file::{OutputFile, write_file};
pub use folder::{OutputFolder, check_place};

use crate::error::Result;
use crate::map::distortion::Distortion;
use crate::map::file_order::{Onto, number_in_file};
use crate::map::layout_file::{LandmarkEntry, LayoutFile, Polyline, base_entries, polylines};
use crate::map::product::{Finest, Product, Shown, Side};
use crate::map::refined::RefinedMesh;
use crate::map::report::{Report, peak_bytes};
use crate::mesh::io::write_obj;
use crate::mesh::{FaceId, Id};
use crate::view::MapPictures;
use folder::REPORT_FILE;
use std::collections::BTreeMap;
use std::path::Path;

/// Writes all files of a finished map into `dir`, which appears as a whole at the end, and returns the report.
///
/// `seconds` is asked for the time per stage just before the report, the last file, is written.
pub fn write(product: &Product, dir: &Path, seconds: impl FnOnce() -> BTreeMap<&'static str, f64>) -> Result<Report> {
    let folder = OutputFolder::create(dir)?;
    write_side(&folder, "source_on_target", &product.source, &product.target)?;
    write_side(&folder, "target_on_source", &product.target, &product.source)?;
    for (name, side) in [("source_refined", &product.source), ("target_refined", &product.target)] {
        if let Some(RefinedMesh { file, .. }) = side.refined {
            let place = folder.place();
            folder.write(&format!("{name}.obj"), |mut out| write_obj(&mut out, place, file, &file.positions))?;
        }
    }
    for (name, bytes) in product.images.iter().flat_map(|images| &images.files) {
        folder.write(&format!("geometry/{name}"), |out| out.write_all(bytes))?;
    }
    for (name, bytes) in product.files {
        folder.write(name, |out| out.write_all(bytes))?;
    }
    folder.write("layout.json", |out| Ok(serde_json::to_writer(out, &layout_file(product))?))?;
    let measured = [product.source.distortion(&product.target), product.target.distortion(&product.source)];
    let pictures = product.shown.map(|shown| (shown, pictures(product, &shown, &measured)));
    if let Some((_, pictures)) = &pictures {
        folder.write("preview.png", |out| out.write_all(&pictures.preview))?;
    }
    let report = report(product, measured, seconds);
    if let Some((shown, pictures)) = pictures {
        let page = pictures.page(product, &shown, &report);
        folder.write("report.html", |out| out.write_all(page.as_bytes()))?;
    }
    folder.write(REPORT_FILE, |out| Ok(serde_json::to_writer_pretty(out, &report)?))?;
    folder.commit()?;
    Ok(report)
}

/// The compatible mesh of `side` at the shape of `other`, and its vertices' places there.
fn write_side(folder: &OutputFolder, name: &str, side: &Side, other: &Side) -> Result<()> {
    let positions = side.image_positions(other);
    let triangles = other.file.triangles();
    let onto = Onto { mesh: other.mesh, triangles: &triangles, omitted: other.omitted };
    let Finest { file, image, .. } = side.finest();
    folder.write(&format!("{name}.obj"), |mut out| write_obj(&mut out, folder.place(), file, &positions.raw))?;
    folder.write(&format!("{name}.csv"), |out| points_csv::write_points(out, image, onto))
}

fn layout_file(product: &Product) -> LayoutFile {
    let given = product.landmarks;
    let landmark = |(i, name): (usize, &String)| LandmarkEntry {
        name: name.clone(),
        source_vertex: given.source[i].0,
        target_vertex: given.target[i].0,
    };
    let (arcs, patches) = base_entries(product.base);
    LayoutFile {
        landmarks: given.names.iter().enumerate().map(landmark).collect(),
        arcs,
        patches,
        atlas: product.images.map(|images| images.table.clone()),
        source: side_arcs(&product.source),
        target: side_arcs(&product.target),
    }
}

fn side_arcs(side: &Side) -> Vec<Polyline> {
    polylines(side.arcs, Onto { mesh: side.mesh, triangles: &side.file.triangles(), omitted: side.omitted })
}

/// The measures of a compatible mesh, and its turned-over triangles.
type Measured = (Distortion, Vec<FaceId>);

/// The preview and the scene of the page. Refined meshes are shown as they came, so their turned-over triangles are found anew.
fn pictures(product: &Product, shown: &Shown, measured: &[Measured; 2]) -> MapPictures {
    let as_it_came = |side: &Side, other: &Side, found: &[FaceId]| match side.refined {
        Some(_) => Side { refined: None, ..*side }.distortion(other).1,
        None => found.to_vec(),
    };
    let (source, target) = (&product.source, &product.target);
    let flips = [as_it_came(source, target, &measured[0].1), as_it_came(target, source, &measured[1].1)];
    MapPictures::new(product, shown, [&flips[0], &flips[1]])
}

fn report(product: &Product, measured: [Measured; 2], seconds: impl FnOnce() -> BTreeMap<&'static str, f64>) -> Report {
    let [(forward, flips), (backward, flips_back)] = measured;
    let mut warnings = product.warnings.clone();
    warnings.extend(flip_warning("source_on_target.obj", &product.source, &flips));
    warnings.extend(flip_warning("target_on_source.obj", &product.target, &flips_back));
    Report {
        version: env!("CARGO_PKG_VERSION"),
        device: product.device.to_owned(),
        source: product.source.summary(),
        target: product.target.summary(),
        landmarks: product.landmarks.names.len(),
        layout: product.layout.clone(),
        relaxation: product.relaxation.clone(),
        certificate: product.certificate,
        distortion: forward,
        distortion_target_on_source: backward,
        seconds: seconds(),
        peak_bytes: peak_bytes(),
        warnings,
    }
}

/// Turned-over faces named in a warning at most; the count says how many there are.
const NAMED_FLIPS: usize = 5;

/// A map that does not fold can still have turned-over samples.
fn flip_warning(file: &str, side: &Side, flips: &[FaceId]) -> Option<String> {
    let Finest { file: mesh_file, omitted, .. } = side.finest();
    let polygons = mesh_file.triangle_polygons();
    let polygon = |&f: &FaceId| polygons[number_in_file(f, omitted).index()];
    let mut names: Vec<String> = flips.iter().take(NAMED_FLIPS).map(|f| polygon(f).to_string()).collect();
    if flips.len() > names.len() {
        names.push("...".to_owned());
    }
    (!flips.is_empty()).then(|| {
        format!(
            "{file}: triangles collapsed or turned over: {} (in faces {}, counted from 0): the map does not fold, but \
             this mesh has it at the vertices only, and a coarse triangle that spans a fold of the other shape can turn",
            flips.len(),
            names.join(", ")
        )
    })
}
