//! Landmark files: pairs of vertices that a map must take to each other.
//!
//! One table for both meshes, or one file per mesh in the formats of the programs people pick points with. Every error
//! names the file and the row (from 1, the header not counted).

mod json;
mod place;
pub(super) mod table;
mod text;

use super::mesh_file::MeshFile;
use crate::mesh::VertexId;
use crate::{Error, Result};
pub use table::split as split_fields;

use place::{Entry, PointFile};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Landmarks of a pair of meshes; the three lists run in parallel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Landmarks {
    /// Where they were read from: both meshes' or the source's.
    pub path: PathBuf,
    /// Names, all different.
    pub names: Vec<String>,
    /// Vertices of the source, all different.
    pub source: Vec<VertexId>,
    /// Vertices of the target, all different.
    pub target: Vec<VertexId>,
    /// What was decided on the way (snapping, matching, coordinate systems), as sentences.
    pub notes: Vec<String>,
}

/// A point of one mesh with its vertex found.
struct Found {
    entry: Entry,
    vertex: VertexId,
}

/// Reads the landmarks of a pair: one table for both meshes, or one file per mesh.
pub fn read_landmarks(
    path: &Path,
    target_path: Option<&Path>,
    source: &MeshFile,
    target: &MeshFile,
) -> Result<Landmarks> {
    let bytes = super::read_bytes(path)?;
    let others = target_path.map(super::read_bytes).transpose()?;
    parse_landmarks((path, &bytes), target_path.zip(others.as_deref()), source, target)
}

/// The same for files in memory: each with its path, which only errors and notes speak of, and its content.
pub fn parse_landmarks(
    (path, bytes): (&Path, &[u8]),
    other: Option<(&Path, &[u8])>,
    source: &MeshFile,
    target: &MeshFile,
) -> Result<Landmarks> {
    let mut notes = Vec::new();
    let [from, to] = match other {
        None => table::read_pairs(path, text_of(path, bytes)?).map_err(|e| e.file(path))?,
        Some((other, others)) => [parse_points(path, bytes)?, parse_points(other, others)?],
    };
    let from = find_vertices(from, source, "source", &mut notes)?;
    let to = find_vertices(to, target, "target", &mut notes)?;
    let order = match other {
        None => (0..to.len()).collect(),
        Some((other, _)) => match_points(path, &from, other, &to, &mut notes)?,
    };
    let name = |(i, f): (usize, &Found)| {
        let label = f.entry.name.clone().or_else(|| to[order[i]].entry.name.clone());
        label.unwrap_or_else(|| format!("landmark {}", i + 1))
    };
    Ok(Landmarks {
        path: path.to_owned(),
        names: from.iter().enumerate().map(name).collect(),
        source: from.iter().map(|f| f.vertex).collect(),
        target: order.iter().map(|&j| to[j].vertex).collect(),
        notes,
    })
}

/// Parses a file of points of one mesh, in whatever format it is.
fn parse_points(path: &Path, bytes: &[u8]) -> Result<PointFile> {
    let content = text_of(path, bytes)?;
    let head = content.trim_start();
    let parse = match head.chars().next() {
        Some('{' | '[') => json::parse,
        Some('<') => text::parse_pp,
        Some('#') if head.starts_with("# Markups") => text::parse_fcsv,
        _ if text::is_index_list(content) => text::parse_index_list,
        _ => table::read_points,
    };
    let points = parse(content).map_err(|e| e.file(path))?;
    Ok(PointFile { path: path.to_owned(), ..points })
}

fn text_of<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str> {
    let text = super::plain_text(bytes).map_err(|e| e.file(path))?;
    std::str::from_utf8(text)
        .map_err(|_| Error::input("the landmark file is not UTF-8 text").file(path).remedy("save it as UTF-8"))
}

/// Finds the vertices of all points and refuses equal names and equal vertices.
fn find_vertices(points: PointFile, mesh: &MeshFile, side: &str, notes: &mut Vec<String>) -> Result<Vec<Found>> {
    let fail = |e: Error| e.file(&points.path);
    if points.entries.is_empty() {
        let what = "no landmarks: nothing tells which of the infinitely many maps is meant";
        return Err(fail(
            Error::unsolvable(what).at("row 1").remedy("give at least one, better three or more, one per row"),
        ));
    }
    let vertices = place::vertices(&points, mesh, side, notes).map_err(fail)?;
    let mut names = HashMap::new();
    let mut used = HashMap::new();
    for (entry, &vertex) in points.entries.iter().zip(&vertices) {
        let label = entry.label();
        if let Some(first) = entry.name.as_ref().and_then(|name| names.insert(name, entry)) {
            let what = format!("the name \"{label}\" is taken by {}", first.row());
            return Err(fail(Error::input(what).at(entry.row()).remedy("give every landmark a name of its own")));
        }
        if let Some(first) = used.insert(vertex, entry) {
            let (other, row) = (first.label(), first.row());
            let what = format!("{vertex} is the {side} of \"{label}\" and already of \"{other}\" in {row}");
            return Err(fail(Error::input(what).at(entry.row()).remedy("give every landmark a vertex of its own")));
        }
    }
    Ok(points.entries.into_iter().zip(vertices).map(|(entry, vertex)| Found { entry, vertex }).collect())
}

/// For every source point the target point with its label; by order if the files share no label.
fn match_points(
    path: &Path,
    from: &[Found],
    other: &Path,
    to: &[Found],
    notes: &mut Vec<String>,
) -> Result<Vec<usize>> {
    let by_name: HashMap<&str, usize> =
        to.iter().enumerate().filter_map(|(j, t)| Some((t.entry.name.as_deref()?, j))).collect();
    let partner = |f: &Found| f.entry.name.as_deref().and_then(|name| by_name.get(name).copied());
    let partners: Vec<Option<usize>> = from.iter().map(partner).collect();
    if partners.iter().all(Option::is_none) {
        return match_by_order(path, from, other, to, notes);
    }
    if let Some(i) = partners.iter().position(Option::is_none) {
        return Err(unmatched(path, &from[i], other));
    }
    let order: Vec<usize> = partners.into_iter().flatten().collect();
    let mut matched = vec![false; to.len()];
    order.iter().for_each(|&j| matched[j] = true);
    if let Some(j) = matched.iter().position(|m| !m) {
        return Err(unmatched(other, &to[j], path));
    }
    if let Some(i) = (0..order.len()).find(|&i| order[i] != i) {
        let (label, here, there) = (from[i].entry.label(), from[i].entry.row(), to[order[i]].entry.row());
        notes.push(format!("landmarks matched by name, not by order: \"{label}\" is {here} and {there}"));
    }
    Ok(order)
}

fn match_by_order(
    path: &Path,
    from: &[Found],
    other: &Path,
    to: &[Found],
    notes: &mut Vec<String>,
) -> Result<Vec<usize>> {
    if from.len() != to.len() {
        let what = format!("{} landmarks, but {} has {}", from.len(), other.display(), to.len());
        return Err(Error::input(what).file(path).remedy("give both files the same landmarks, by name or by order"));
    }
    notes.push("the landmark files share no names: matched by order".to_owned());
    Ok((0..from.len()).collect())
}

fn unmatched(path: &Path, found: &Found, other: &Path) -> Error {
    Error::input(format!("landmark \"{}\" has no partner in {}", found.entry.label(), other.display()))
        .file(path)
        .at(found.entry.row())
        .remedy("use the same names in both files")
}
