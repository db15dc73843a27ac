//! Constraint files: vertices and where they must lie in texture space.

use super::landmarks::table::{coordinate, split, vertex_index};
use crate::mesh::VertexId;
use crate::{Error, Result};
use glam::DVec2;
use std::collections::HashMap;
use std::path::Path;

/// The columns that a constraint file must have.
const COLUMNS: [&str; 3] = ["vertex", "u", "v"];

/// A vertex with a place in the unit square, v up.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// What messages call it: the name in the file, or the row.
    pub name: String,
    /// The vertex, in the order of the mesh's file.
    pub vertex: VertexId,
    /// Its texture coordinates, exactly as the nearest double to what the file says.
    pub place: DVec2,
}

/// Reads a CSV `vertex,u,v`, with a column `name` if there is one, in any order of columns.
///
/// # Errors
/// Input, with the row: a column is missing or no number, a vertex is none of `vertices` or named twice, a place is
/// outside of the unit square or another's.
pub fn read_constraints(path: &Path, vertices: usize) -> Result<Vec<Constraint>> {
    let bytes = super::read_bytes(path)?;
    let text = String::from_utf8_lossy(&bytes);
    parse(&text, vertices).map_err(|e| e.file(path))
}

fn parse(text: &str, vertices: usize) -> Result<Vec<Constraint>> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let empty = || Error::input("no constraints").remedy("write the header vertex,u,v and a row for each");
    let (_, header) = lines.next().ok_or_else(empty)?;
    let header = split(header.trim_start_matches('\u{feff}'), ',')?;
    let find = |name: &str| header.iter().position(|c| c.eq_ignore_ascii_case(name));
    let columns = COLUMNS.map(|name| {
        let missing = || Error::input(format!("column {name} is missing")).at("the header").remedy("write vertex,u,v");
        find(name).ok_or_else(missing)
    });
    let [vertex, u, v] = columns;
    let columns = [vertex?, u?, v?];
    let mut constraints = Vec::new();
    for (i, line) in lines {
        let read = || -> Result<Constraint> {
            let fields = split(line, ',')?;
            let field = |c: usize| fields.get(c).map_or("", String::as_str);
            let name = find("name").map(field).filter(|n| !n.is_empty());
            let vertex = VertexId(checked_vertex(vertex_index("vertex", field(columns[0]))?, vertices)?);
            let place = DVec2::new(coordinate("u", field(columns[1]))?, coordinate("v", field(columns[2]))?);
            let name = name.map_or_else(|| format!("line {}", i + 1), str::to_owned);
            inside(place)?;
            Ok(Constraint { name, vertex, place })
        };
        constraints.push(read().map_err(|e| e.at(format!("line {}", i + 1)))?);
    }
    if constraints.is_empty() {
        return Err(empty());
    }
    refuse_repeated(&constraints)?;
    Ok(constraints)
}

fn checked_vertex(index: u64, vertices: usize) -> Result<u32> {
    u32::try_from(index).ok().filter(|&v| (v as usize) < vertices).ok_or_else(|| {
        Error::input(format!("vertex {index} is out of range: the mesh has {vertices}"))
            .remedy("indices count from 0; is this the file of another mesh?")
    })
}

fn inside(place: DVec2) -> Result<()> {
    let is_in = |x: f64| x > 0.0 && x < 1.0;
    if is_in(place.x) && is_in(place.y) {
        return Ok(());
    }
    let is_on = |x: f64| (0.0..=1.0).contains(&x);
    let (what, remedy) = if is_on(place.x) && is_on(place.y) {
        ("on the border of the image, which the mesh does not touch", "move it inside: 0 < u, v < 1")
    } else {
        ("outside of the image", "u and v run from 0 to 1, v up")
    };
    Err(Error::input(format!("the place {}, {} is {what}", place.x, place.y)).remedy(remedy))
}

fn refuse_repeated(constraints: &[Constraint]) -> Result<()> {
    let (mut vertices, mut places) = (HashMap::new(), HashMap::new());
    for c in constraints {
        if let Some(first) = vertices.insert(c.vertex, &c.name) {
            return Err(Error::input(format!("{} is constrained twice: \"{first}\" and \"{}\"", c.vertex, c.name))
                .remedy("keep one of the two"));
        }
        // Zero has two signs and one place.
        let place = [c.place.x, c.place.y].map(|x| (x + 0.0).to_bits());
        if let Some(first) = places.insert(place, &c.name) {
            return Err(Error::input(format!("\"{first}\" and \"{}\" have the same place", c.name))
                .at(format!("{}, {}", c.place.x, c.place.y))
                .remedy("move one of the two: two vertices cannot lie at one place without a fold"));
        }
    }
    Ok(())
}
