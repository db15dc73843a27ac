//! The folder of a parametrization: meshes with (u, v) and a grid, tables, regions, pictures, the report.

use super::carry::by_triangle;
use super::page::{page, scene};
use super::picture::{Cells, grid, preview, tint};
use super::report::DiffusionReport;
use super::{Correspondence, Diffusion};
use crate::error::Result;
use crate::map::file_order::Onto;
use crate::mesh::io::{Keyword, MeshFile, SIDES, Statement, write_obj};
use crate::picture::{Picture, file::format_for};
use crate::stage::write::OutputFolder;
use crate::stage::write::folder::REPORT_FILE;
use crate::stage::write::points_csv::write_points;
use serde_json::json;
use std::io::{Cursor, Write};
use std::path::Path;

/// The material library of the written meshes.
const LIBRARY: &str = "mesh.mtl";
/// Its texture.
const GRID_FILE: &str = "grid.png";

/// Everything that is written.
pub struct Output<'a> {
    /// The mesh as it was read, and with (u, v).
    pub mesh: (&'a MeshFile, &'a Diffusion<'a>),
    /// The second mesh likewise.
    pub onto: Option<(&'a MeshFile, &'a Diffusion<'a>)>,
    /// The maps there and back.
    pub maps: Option<&'a [Correspondence; 2]>,
    /// The second mesh's images, by file name.
    pub images: &'a [(String, Picture)],
    /// True if the images lie in an atlas of the regions, which a mesh of its own has as texture coordinates.
    pub in_atlas: bool,
}

/// Writes the folder, which appears complete or not at all; `report` is asked for last. With a command, or an empty text in its
/// place, `report.html` is written as well.
///
/// # Errors
/// Usage, if something else is at the place; input, if it cannot be written.
pub fn write(
    output: &Output,
    dir: &Path,
    command: Option<&str>,
    report: impl FnOnce() -> DiffusionReport,
) -> Result<DiffusionReport> {
    let folder = OutputFolder::create(dir)?;
    let (file, diffusion) = output.mesh;
    write_mesh(&folder, ["mesh.obj", "uv.csv", "regions.json"], file, diffusion)?;
    if let Some(onto) = output.onto {
        write_mesh(&folder, ["onto.obj", "onto_uv.csv", "onto_regions.json"], onto.0, onto.1)?;
        write_maps(&folder, output, onto)?;
    }
    folder.write(LIBRARY, |out| write_library(out, diffusion))?;
    write_picture(&folder, GRID_FILE, &grid())?;
    let shown: Vec<&Diffusion> = std::iter::once(diffusion).chain(output.onto.map(|(_, d)| d)).collect();
    write_picture(&folder, "preview.png", &preview(&shown))?;
    for (name, picture) in output.images {
        write_picture(&folder, name, picture)?;
    }
    let shown = command.map(|command| (scene(output), command));
    let report = report();
    if let Some((scene, command)) = &shown {
        folder.write("report.html", |out| out.write_all(page(scene, &report, command).as_bytes()))?;
    }
    folder.write(REPORT_FILE, |out| Ok(serde_json::to_writer_pretty(out, &report)?))?;
    folder.commit()?;
    Ok(report)
}

/// What there is of two meshes: the maps, and the atlas if an image lies in it.
fn write_maps(folder: &OutputFolder, output: &Output, second: (&MeshFile, &Diffusion)) -> Result<()> {
    let place = folder.place();
    if output.in_atlas {
        let atlas = in_atlas(second.1, second.0);
        folder.write("target_atlas.obj", |mut out| write_obj(&mut out, place, &atlas, &atlas.positions))?;
    }
    for (k, name) in ["source_on_target", "target_on_source"].into_iter().enumerate() {
        let Some(map) = output.maps.map(|maps| &maps[k]) else { continue };
        let (from, to) = if k == 0 { (output.mesh, second) } else { (second, output.mesh) };
        let triangles = to.0.triangles();
        let onto = Onto { mesh: to.1.mesh, triangles: &triangles, omitted: &[] };
        folder.write(&format!("{name}.csv"), |out| write_points(out, &map.image, onto))?;
        folder.write(&format!("{name}.obj"), |mut out| write_obj(&mut out, place, from.0, &map.positions.raw))?;
    }
    Ok(())
}

fn write_picture(folder: &OutputFolder, name: &str, picture: &Picture) -> Result<()> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write(format_for(Path::new(name), picture.depth)?, &mut bytes)?;
    folder.write(name, |out| out.write_all(&bytes.into_inner()))
}

/// One mesh with its (u, v) as texture coordinates, their table, and its regions as a file that can be read again.
fn write_mesh(folder: &OutputFolder, names: [&str; 3], file: &MeshFile, diffusion: &Diffusion) -> Result<()> {
    let textured = textured(diffusion, file, &folder.place().join(names[0]));
    folder.write(names[0], |mut out| write_obj(&mut out, folder.place(), &textured, &textured.positions))?;
    folder.write(names[1], |out| write_table(out, diffusion))?;
    folder.write(names[2], |out| Ok(serde_json::to_writer(out, &regions_json(diffusion, file))?))
}

/// The mesh with (u, v) of its regions as texture coordinates and a material for every region.
fn textured(diffusion: &Diffusion, file: &MeshFile, path: &Path) -> MeshFile {
    let region_of = by_polygon(diffusion, file);
    let mut mesh = MeshFile {
        path: path.to_owned(),
        positions: file.positions.clone(),
        offsets: file.offsets.clone(),
        corners: file.corners.clone(),
        material_libraries: vec![LIBRARY.to_owned()],
        ..MeshFile::default()
    };
    mesh.uv.corners = vec![0; mesh.corners.len()];
    let mut number = vec![0; mesh.positions.len()];
    for (r, piece) in (0u32..).zip(&diffusion.pieces) {
        (mesh.uv.values.len() as u32..).zip(&piece.disc.vertices).for_each(|(i, v)| number[v.0 as usize] = i);
        mesh.uv.values.extend((0..piece.st.len()).map(|v| piece.uv(v)));
        for c in (0..region_of.len()).filter(|&p| region_of[p] == r).flat_map(|p| file.polygon(p)) {
            mesh.uv.corners[c] = number[file.corners[c].0 as usize];
        }
    }
    for (p, &r) in region_of.iter().enumerate() {
        if p == 0 || region_of[p - 1] != r {
            let text = material_name(&diffusion.pieces[r as usize].name);
            mesh.statements.push(Statement { polygon: p, keyword: Keyword::Material, text });
        }
    }
    mesh
}

/// The region of every polygon of a mesh's file.
fn by_polygon(diffusion: &Diffusion, file: &MeshFile) -> Vec<u32> {
    let mut region_of = vec![0u32; file.polygon_count()];
    let triangles = file.triangle_polygons().into_iter().zip(&diffusion.regions.of_triangle);
    triangles.for_each(|(p, &r)| region_of[p as usize] = r);
    region_of
}

/// Names with spaces are not read alike everywhere.
fn material_name(region: &str) -> String {
    region.split_whitespace().collect::<Vec<_>>().join("_")
}

fn write_library(out: &mut dyn Write, diffusion: &Diffusion) -> std::io::Result<()> {
    for (r, piece) in diffusion.pieces.iter().enumerate() {
        let [red, green, blue] = tint(r);
        writeln!(out, "newmtl {}\nKd {red:.4} {green:.4} {blue:.4}\nmap_Kd {GRID_FILE}\n", material_name(&piece.name))?;
    }
    Ok(())
}

/// A row for every vertex of every region; a vertex on a border is in the table of each region that it bounds.
fn write_table(out: &mut dyn Write, diffusion: &Diffusion) -> std::io::Result<()> {
    writeln!(out, "vertex,region,u,v,sides")?;
    for piece in &diffusion.pieces {
        let name = if piece.name.contains([',', '"']) {
            format!("\"{}\"", piece.name.replace('"', "\"\""))
        } else {
            piece.name.clone()
        };
        let mut order: Vec<u32> = (0..piece.st.len() as u32).collect();
        order.sort_by_key(|&v| piece.disc.vertices[v as usize]);
        for v in order {
            let uv = piece.uv(v as usize);
            let is_on_rim = (v as usize) < piece.disc.rim.len();
            let sides: Vec<&str> = if is_on_rim { piece.sides_at(v).collect() } else { Vec::new() };
            writeln!(out, "{},{name},{},{},{}", piece.disc.vertices[v as usize].0, uv.x, uv.y, sides.join(" "))?;
        }
    }
    Ok(())
}

/// The regions with their faces, by polygons of the file, and their sides.
fn regions_json(diffusion: &Diffusion, file: &MeshFile) -> serde_json::Value {
    let polygons = file.triangle_polygons();
    let mut list = Vec::new();
    for piece in &diffusion.pieces {
        let mut faces: Vec<u32> = piece.disc.faces.iter().map(|f| polygons[f.0 as usize]).collect();
        faces.sort_unstable();
        faces.dedup();
        let order = if piece.mirrored { ["v0", "u0", "v1", "u1"] } else { ["v0", "u1", "v1", "u0"] };
        let side = |name: &&str| {
            let k = order.iter().position(|n| n == name).unwrap_or(0);
            piece.sides[k].vertices.iter().map(|&v| piece.disc.vertices[v as usize].0).collect::<Vec<u32>>()
        };
        let sides: serde_json::Map<String, serde_json::Value> =
            SIDES.iter().map(|name| ((*name).to_owned(), json!(side(name)))).collect();
        list.push(json!({ "name": piece.name, "faces": faces, "sides": sides }));
    }
    json!({ "regions": list })
}

/// The mesh with the atlas of its regions as texture coordinates.
fn in_atlas(diffusion: &Diffusion, file: &MeshFile) -> MeshFile {
    let cells = Cells::new(diffusion.pieces.len());
    let triangles = file.triangles();
    let mut mesh = MeshFile { positions: file.positions.clone(), ..MeshFile::default() };
    for (t, (r, uv)) in by_triangle(diffusion, &triangles).into_iter().enumerate() {
        let first = mesh.uv.values.len() as u32;
        mesh.uv.values.extend(uv.map(|uv| cells.place(r, uv)));
        mesh.push_polygon(triangles[t].map(|v| v.0));
        mesh.uv.corners.extend([first, first + 1, first + 2]);
    }
    mesh
}
