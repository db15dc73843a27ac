//! Points of one mesh as text: plain index lists, 3D Slicer `.fcsv`, MeshLab `.pp`.

use super::place::{Axes, Entry, Place, PointFile, row};
use super::table::{coordinate, split, vertex_index};
use crate::{Error, Result};
use glam::DVec3;

/// Columns of an `.fcsv` file that does not say which it has.
const FCSV_COLUMNS: &str = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID";

/// The text of a line before a comment.
fn before_comment(line: &str) -> &str {
    line.split('#').next().unwrap_or_default().trim()
}

/// True if the first thing in the text is a whole number.
pub fn is_index_list(content: &str) -> bool {
    let first = content.lines().map(before_comment).find(|line| !line.is_empty());
    first.is_some_and(|line| line.split([',', ' ', '\t', ';']).next().is_some_and(|word| word.parse::<i64>().is_ok()))
}

/// Parses vertex indices separated by blanks, commas or line breaks.
pub fn parse_index_list(content: &str) -> Result<PointFile> {
    let mut points = PointFile::default();
    for (i, line) in content.lines().enumerate() {
        let words = before_comment(line).split([',', ' ', '\t', ';']).filter(|word| !word.is_empty());
        for word in words {
            let (number, line) = (points.entries.len() + 1, Some(i + 1));
            let v = vertex_index("vertex", word).map_err(|e| e.at(row(number, line)))?;
            points.entries.push(Entry { number, line, name: None, place: Place::Vertex(v) });
        }
    }
    Ok(points)
}

/// Parses 3D Slicer's older fiducial list.
pub fn parse_fcsv(content: &str) -> Result<PointFile> {
    let mut points = PointFile { axes: Axes::Ras, ..PointFile::default() };
    let mut columns = split(FCSV_COLUMNS, ',')?;
    for (i, line) in content.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        if let Some(comment) = line.strip_prefix('#') {
            match comment.split_once('=').map(|(key, value)| (key.trim(), value.trim())) {
                Some(("CoordinateSystem", system)) => {
                    points.axes = axes(system).map_err(|e| e.at(format!("line {}", i + 1)))?
                }
                Some(("columns", names)) => columns = split(names, ',')?,
                _ => {}
            }
            continue;
        }
        let number = points.entries.len() + 1;
        let entry = fcsv_entry(line, &columns, number, i + 1).map_err(|e| e.at(row(number, Some(i + 1))))?;
        points.entries.push(entry);
    }
    Ok(points)
}

/// The axes by the name or number that 3D Slicer gives them.
pub fn axes(system: &str) -> Result<Axes> {
    match system {
        "LPS" | "1" => Ok(Axes::Lps),
        "RAS" | "0" => Ok(Axes::Ras),
        _ => Err(Error::input(format!("unknown coordinate system \"{system}\"")).remedy("use LPS or RAS")),
    }
}

fn fcsv_entry(line: &str, columns: &[String], number: usize, line_number: usize) -> Result<Entry> {
    let fields = split(line, ',')?;
    let field = |name: &str| {
        let place = columns.iter().position(|c| c == name)?;
        fields.get(place).map(String::as_str).filter(|f| !f.is_empty())
    };
    let position = position(field)?;
    let name = field("label").map(str::to_owned);
    Ok(Entry { number, line: Some(line_number), name, place: position })
}

/// The position in the fields x, y and z.
fn position<'a>(field: impl Fn(&str) -> Option<&'a str>) -> Result<Place> {
    let mut p = [0.0; 3];
    for (x, name) in p.iter_mut().zip(["x", "y", "z"]) {
        let text = field(name).ok_or_else(|| Error::input(format!("no {name}")).remedy("give x, y and z"))?;
        *x = coordinate(name, text)?;
    }
    Ok(Place::Position(DVec3::from_array(p)))
}

/// Parses MeshLab's picked points.
pub fn parse_pp(content: &str) -> Result<PointFile> {
    let mut points = PointFile::default();
    for tag in content.split('<').skip(1).filter_map(|tag| tag.strip_prefix("point")) {
        if !tag.starts_with(char::is_whitespace) {
            continue; // another element whose name begins alike
        }
        let number = points.entries.len() + 1;
        points.entries.push(pp_entry(tag, number).map_err(|e| e.at(row(number, None)))?);
    }
    Ok(points)
}

fn pp_entry(tag: &str, number: usize) -> Result<Entry> {
    let Some((tag, _)) = tag.split_once('>') else {
        return Err(
            Error::input("a point element is not closed").remedy("the file is cut short: save the points again")
        );
    };
    let field = |name: &str| attribute(tag, name);
    if field("active") == Some("0") {
        return Err(Error::input("a point that was never picked").remedy("pick it or delete it"));
    }
    let name = field("name").filter(|n| !n.is_empty()).map(str::to_owned);
    Ok(Entry { number, line: None, name, place: position(field)? })
}

/// The value of an XML attribute, entities left as they are.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let mut rest = tag;
    loop {
        let (key, tail) = rest.split_once('=')?;
        let tail = tail.trim_start();
        let quote = tail.chars().next().filter(|q| matches!(q, '"' | '\''))?;
        let (value, tail) = tail[1..].split_once(quote)?;
        if key.trim() == name {
            return Some(value);
        }
        rest = tail;
    }
}
