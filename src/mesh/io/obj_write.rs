//! Wavefront OBJ writer: the connectivity of a file that was read, at new positions.

use super::library_path::library_from;
use super::mesh_file::MeshFile;
use super::normals::vertex_normals;
use glam::DVec3;
use std::io::{BufWriter, Result, Write};
use std::path::Path;

/// Writes `mesh` with `positions`, one per vertex, in place of its own: same vertices, polygons, texture coordinates and groups.
///
/// Material libraries are named as seen from `folder`, where the file is to lie. Numbers are the shortest that read back to the same value. Normals are written if `mesh` has some: one per vertex,
/// the area-weighted mean over its polygons at the new positions.
pub fn write_obj(out: &mut impl Write, folder: &Path, mesh: &MeshFile, positions: &[DVec3]) -> Result<()> {
    let mut out = BufWriter::new(out);
    for name in &mesh.material_libraries {
        writeln!(out, "mtllib {}", library_from(folder, &mesh.path, name))?;
    }
    for p in positions {
        writeln!(out, "v {} {} {}", p.x, p.y, p.z)?;
    }
    for uv in &mesh.uv.values {
        writeln!(out, "vt {} {}", uv.x, uv.y)?;
    }
    let with_normals = !mesh.normals.values.is_empty();
    if with_normals {
        for n in vertex_normals(mesh, positions) {
            writeln!(out, "vn {} {} {}", n.x, n.y, n.z)?;
        }
    }
    let mut statements = mesh.statements.iter().peekable();
    for p in 0..mesh.polygon_count() {
        while let Some(s) = statements.next_if(|s| s.polygon <= p) {
            writeln!(out, "{} {}", s.keyword.word(), s.text)?;
        }
        write_face(&mut out, mesh, p, with_normals)?;
    }
    out.flush()
}

fn write_face(out: &mut impl Write, mesh: &MeshFile, polygon: usize, with_normals: bool) -> Result<()> {
    out.write_all(b"f")?;
    for c in mesh.polygon(polygon) {
        let v = u64::from(mesh.corners[c].0) + 1;
        match (mesh.uv.index(c).map(|t| u64::from(t) + 1), with_normals) {
            (None, false) => write!(out, " {v}")?,
            (Some(t), false) => write!(out, " {v}/{t}")?,
            (None, true) => write!(out, " {v}//{v}")?,
            (Some(t), true) => write!(out, " {v}/{t}/{v}")?,
        }
    }
    out.write_all(b"\n")
}
