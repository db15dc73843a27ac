//! PLY reader: ASCII and binary of either byte order, any elements and properties.
//!
//! Used are `x y z`, `nx ny nz`, a pair of texture coordinates per vertex, and per face the vertex list and a `texcoord`
//! list with one pair per corner; everything else is read over.
//!
//! Source: G. Turk, "The PLY Polygon File Format", 1994.

mod header;
mod table;
mod values;

pub(super) use table::parse_table;

use super::mesh_file::{Attribute, MeshFile};
use crate::{Error, Result};
use glam::{DVec2, DVec3};
use header::{Element, Encoding, Header, Property};
use values::{Ascii, Binary, Values};

/// Names under which programs store texture coordinates per vertex.
const UV_NAMES: [[&str; 2]; 5] =
    [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"], ["texcoord_u", "texcoord_v"]];
/// Names of the list of a face's vertices.
const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Parses a PLY file.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile> {
    let header = Header::parse(bytes)?;
    match header.encoding {
        Encoding::Ascii => parse_body(&header, Ascii::new(bytes, &header)),
        Encoding::Little => parse_body(&header, Binary::<false>::new(bytes, &header)),
        Encoding::Big => parse_body(&header, Binary::<true>::new(bytes, &header)),
    }
}

fn parse_body<'a>(header: &'a Header, mut values: impl Values<'a>) -> Result<MeshFile> {
    let mut mesh = MeshFile::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => parse_vertices(element, &mut values, &mut mesh)?,
            "face" => parse_faces(element, header.vertices, &mut values, &mut mesh)?,
            "tristrips" => {
                return Err(
                    Error::input("triangle strips are not supported").remedy("export the mesh with plain faces")
                );
            }
            _ => skip(element, &mut values)?,
        }
    }
    mesh.warnings.extend(values.finish()?);
    if mesh.uv.corners.is_empty() {
        mesh.uv.spread(&mesh.corners);
    }
    mesh.normals.spread(&mesh.corners);
    Ok(mesh)
}

fn skip<'a>(element: &'a Element, values: &mut impl Values<'a>) -> Result<()> {
    let mut ignored = Vec::new();
    let rows = if element.properties.is_empty() { 0 } else { element.count }; // nothing is written for empty rows
    for row in 0..rows {
        values.start(element, row)?;
        for property in &element.properties {
            values.list(property, &mut ignored)?;
        }
        values.end()?;
    }
    Ok(())
}

/// Where the properties of a vertex stand in its row.
struct VertexColumns {
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    uv: Option<[usize; 2]>,
}

impl VertexColumns {
    fn find(element: &Element) -> Result<Self> {
        let position = element.columns(["x", "y", "z"]).ok_or_else(|| {
            Error::input("the vertices have no x, y and z").remedy("declare them as properties of element vertex")
        })?;
        let uv = UV_NAMES.into_iter().find_map(|names| element.columns(names));
        Ok(VertexColumns { position, normal: element.columns(["nx", "ny", "nz"]), uv })
    }
}

fn parse_vertices<'a>(element: &'a Element, values: &mut impl Values<'a>, mesh: &mut MeshFile) -> Result<()> {
    let columns = VertexColumns::find(element)?;
    let mut row = vec![0.0; element.properties.len()];
    let mut ignored = Vec::new();
    for v in 0..element.count {
        values.start(element, v)?;
        for (x, property) in row.iter_mut().zip(&element.properties) {
            if property.is_list() {
                values.list(property, &mut ignored)?;
            } else {
                *x = values.value(property.kind)?;
            }
        }
        values.end()?;
        let used = columns.position.iter().chain(columns.normal.iter().flatten()).chain(columns.uv.iter().flatten());
        if !used.clone().all(|&k| row[k].is_finite()) {
            return Err(values.error("a coordinate is not a finite number", "correct or delete the vertex"));
        }
        mesh.positions.push(DVec3::from_array(columns.position.map(|k| row[k])));
        mesh.normals.values.extend(columns.normal.map(|c| DVec3::from_array(c.map(|k| row[k]))));
        mesh.uv.values.extend(columns.uv.map(|c| DVec2::from_array(c.map(|k| row[k]))));
    }
    Ok(())
}

fn parse_faces<'a>(
    element: &'a Element,
    vertices: usize,
    values: &mut impl Values<'a>,
    mesh: &mut MeshFile,
) -> Result<()> {
    if !element.properties.iter().any(|p| p.is_list() && CORNER_LISTS.contains(&p.name.as_str())) {
        return Err(Error::input("the faces have no list of vertices").remedy("declare a list property vertex_indices"));
    }
    let mut corners = Vec::new();
    let mut uv = Vec::new();
    let mut ignored = Vec::new();
    let mut corner_uv = Attribute::default();
    for f in 0..element.count {
        values.start(element, f)?;
        for property in &element.properties {
            match property.name.as_str() {
                name if property.is_list() && CORNER_LISTS.contains(&name) => values.list(property, &mut corners)?,
                "texcoord" if property.is_list() => values.list(property, &mut uv)?,
                _ => values.list(property, &mut ignored)?,
            }
        }
        values.end()?;
        push_face(&corners, vertices, values, mesh)?;
        push_corner_uv(&uv, corners.len(), values, &mut corner_uv)?;
    }
    if !corner_uv.values.is_empty() {
        mesh.uv = corner_uv;
    }
    Ok(())
}

fn push_face<'a>(corners: &[f64], vertices: usize, values: &impl Values<'a>, mesh: &mut MeshFile) -> Result<()> {
    if corners.len() < 3 {
        let what = format!("a face with {} corners", corners.len());
        return Err(values.error(&what, "a face needs at least three: correct or delete it"));
    }
    if let Some(v) = corners.iter().find(|&&v| !(v >= 0.0 && v < vertices as f64 && v.fract() == 0.0)) {
        let what = format!("vertex index {v}, but the file has {vertices} vertices");
        return Err(values.error(&what, "PLY counts vertices from 0; the file may be damaged"));
    }
    mesh.push_polygon(corners.iter().map(|&v| v as u32));
    Ok(())
}

/// Takes the texture coordinates of a face's corners; an empty list means the face has none.
fn push_corner_uv<'a>(uv: &[f64], corners: usize, values: &impl Values<'a>, out: &mut Attribute<DVec2>) -> Result<()> {
    if uv.is_empty() {
        out.corners.extend(std::iter::repeat_n(super::NO_INDEX, corners));
        return Ok(());
    }
    if uv.len() != 2 * corners || !uv.iter().all(|x| x.is_finite()) {
        let what = format!("{} texture coordinates for {corners} corners, or one is not finite", uv.len());
        return Err(values.error(&what, "texcoord needs two finite numbers per corner"));
    }
    for pair in uv.chunks_exact(2) {
        out.corners.push(out.values.len() as u32);
        out.values.push(DVec2::new(pair[0], pair[1]));
    }
    Ok(())
}

impl Property {
    fn is_list(&self) -> bool {
        self.length.is_some()
    }
}
