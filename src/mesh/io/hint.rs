//! Hint files: closed curves that must correspond, where landmarks leave open how a map winds around a handle.
//!
//! JSON `{"loops": [{"name": "handle", "source": [vertices], "target": [vertices]}]}`. Vertices are counted from 0, in
//! order along the curve, in the same direction on both meshes; neighbours in the list need not be neighbours on the mesh.

use super::mesh_file::MeshFile;
use crate::mesh::{Id, VertexId};
use crate::{Error, Result};
use serde_json::Value;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Fewer vertices leave open which way around a curve goes.
const LEAST_VERTICES: usize = 3;
/// Remedy for JSON of another shape.
const SHAPE: &str = "write {\"loops\": [{\"name\": \"handle\", \"source\": [vertices], \"target\": [vertices]}]}";

/// Closed curves on a pair of meshes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hint {
    /// Where they were read from.
    pub path: PathBuf,
    /// The curves.
    pub loops: Vec<HintLoop>,
}

/// A closed curve on both meshes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HintLoop {
    /// Its name, which no other has.
    pub name: String,
    /// Vertices in order along it on the source and on the target: at least three, all different.
    pub vertices: [Vec<VertexId>; 2],
}

/// Reads the hint for a pair.
pub fn read_hint(path: &Path, source: &MeshFile, target: &MeshFile) -> Result<Hint> {
    parse_hint(path, &super::read_bytes(path)?, [source, target])
}

/// The same for a file in memory; only errors speak of its path.
///
/// # Errors
/// Bad input: no JSON of that shape, two loops of one name, a loop with too few vertices, with one twice, or with one
/// that its mesh lacks.
pub fn parse_hint(path: &Path, bytes: &[u8], meshes: [&MeshFile; 2]) -> Result<Hint> {
    let value: Value = serde_json::from_slice(bytes).map_err(|e| {
        Error::input("not valid JSON")
            .at(format_args!("line {}, column {}", e.line(), e.column()))
            .remedy(SHAPE)
            .file(path)
    })?;
    let counts = meshes.map(|m| m.positions.len());
    let loops = parse_loops(&value, counts).map_err(|e| e.file(path))?;
    Ok(Hint { path: path.to_owned(), loops })
}

fn parse_loops(value: &Value, counts: [usize; 2]) -> Result<Vec<HintLoop>> {
    let list = value.get("loops").and_then(Value::as_array).filter(|list| !list.is_empty());
    let list = list.ok_or_else(|| Error::input("no list of loops").remedy(SHAPE))?;
    let mut names = HashSet::new();
    let mut loops = Vec::with_capacity(list.len());
    for (i, one) in list.iter().enumerate() {
        let given = one.get("name").and_then(Value::as_str).filter(|name| !name.is_empty());
        let name = given.map_or_else(|| (i + 1).to_string(), str::to_owned);
        if !names.insert(name.clone()) {
            return Err(Error::input(format!("two loops are called \"{name}\"")).remedy("rename one of them"));
        }
        let vertices = |k: usize| parse_vertices(one, ["source", "target"][k], &name, counts[k]);
        loops.push(HintLoop { vertices: [vertices(0)?, vertices(1)?], name });
    }
    Ok(loops)
}

fn parse_vertices(one: &Value, side: &str, name: &str, count: usize) -> Result<Vec<VertexId>> {
    let here = || format!("loop \"{name}\", {side}");
    let list = one.get(side).and_then(Value::as_array);
    let list = list.ok_or_else(|| Error::input("a loop without a list of vertices").at(here()).remedy(SHAPE))?;
    let mut seen = HashSet::new();
    let mut vertices = Vec::with_capacity(list.len());
    for item in list {
        let index = item.as_u64().and_then(|v| usize::try_from(v).ok()).filter(|&v| v < count);
        let index = index.ok_or_else(|| {
            Error::input(format!("{item} is no vertex of the {side}"))
                .at(here())
                .remedy(format!("its {count} vertices are counted from 0"))
        })?;
        if !seen.insert(index) {
            return Err(Error::input(format!("vertex {index} stands twice in one loop"))
                .at(here())
                .remedy("list every vertex once: a loop closes by itself and does not cross itself"));
        }
        vertices.push(VertexId::new(index));
    }
    if vertices.len() < LEAST_VERTICES {
        return Err(Error::input(format!("a loop of {} vertices", vertices.len()))
            .at(here())
            .remedy("list at least three, so that it is clear which way around it goes"));
    }
    Ok(vertices)
}
