//! Points of one mesh as JSON: Wrap, 3D Slicer `.mrk.json`, scalismo, plain index lists.
//!
//! Wrap writes `[[triangle, u, v], ...]` for the points A u + B v + C (1 - u - v) of triangle (A, B, C), polygons counted
//! as fans of triangles, or `[[x, y, z], ...]`; with names, an object of such triples.

use super::place::{Axes, Entry, Place, PointFile, row};
use super::text::axes;
use crate::{Error, Result};
use glam::DVec3;
use serde_json::Value;

/// Remedy for JSON of an unknown shape.
const SHAPES: &str = "expected vertex indices, Wrap or scalismo points, or a 3D Slicer markups file";

/// Parses any of the formats.
pub fn parse(content: &str) -> Result<PointFile> {
    let value: Value = serde_json::from_str(content).map_err(|e| {
        Error::input("not valid JSON")
            .at(format_args!("line {}, column {}", e.line(), e.column()))
            .remedy("save it again")
    })?;
    match &value {
        Value::Object(fields) => match fields.get("markups") {
            Some(markups) => parse_slicer(markups),
            None => parse_wrap(&fields.iter().map(|(name, point)| (Some(name.clone()), point)).collect::<Vec<_>>()),
        },
        Value::Array(items) => match items.first() {
            Some(Value::Array(_)) => parse_wrap(&items.iter().map(|point| (None, point)).collect::<Vec<_>>()),
            Some(Value::Object(_)) => collect(items.iter().map(scalismo_point)),
            _ => collect(items.iter().map(index)),
        },
        _ => Err(Error::input("no list of points").remedy(SHAPES)),
    }
}

/// Numbers the points of a file and names the row of the first error.
fn collect(points: impl Iterator<Item = Result<(Option<String>, Place)>>) -> Result<PointFile> {
    let entry = |(i, point): (usize, Result<(Option<String>, Place)>)| match point {
        Ok((name, place)) => Ok(Entry { number: i + 1, line: None, name: name.filter(|n| !n.is_empty()), place }),
        Err(e) => Err(e.at(row(i + 1, None))),
    };
    Ok(PointFile { entries: points.enumerate().map(entry).collect::<Result<_>>()?, ..PointFile::default() })
}

fn index(value: &Value) -> Result<(Option<String>, Place)> {
    let error = || Error::input(format!("{value} is not a vertex index")).remedy("write whole numbers counted from 0");
    value.as_u64().map(|v| (None, Place::Vertex(v))).ok_or_else(error)
}

/// Triples are triangles if every first number is written as a whole number, and positions otherwise.
fn parse_wrap(points: &[(Option<String>, &Value)]) -> Result<PointFile> {
    let on_triangles = points.iter().all(|(_, p)| p.get(0).is_some_and(Value::is_u64));
    collect(points.iter().map(|(name, point)| {
        let [x, y, z] = triple(Some(point))?;
        let place = match point.get(0).and_then(Value::as_u64) {
            Some(triangle) if on_triangles => Place::Triangle(triangle, [y, z]),
            _ => Place::Position(DVec3::new(x, y, z)),
        };
        Ok((name.clone(), place))
    }))
}

fn scalismo_point(point: &Value) -> Result<(Option<String>, Place)> {
    let position = triple(point.get("coordinates"))?;
    Ok((string(point, "id"), Place::Position(DVec3::from_array(position))))
}

fn parse_slicer(markups: &Value) -> Result<PointFile> {
    let lists = markups.as_array().map(Vec::as_slice).unwrap_or_default();
    let system = lists.iter().find_map(|list| string(list, "coordinateSystem"));
    let points = lists.iter().filter_map(|list| list.get("controlPoints")?.as_array()).flatten();
    let parsed = collect(points.map(|point| {
        let position = triple(point.get("position"))?;
        Ok((string(point, "label"), Place::Position(DVec3::from_array(position))))
    }))?;
    let axes = system.map_or(Ok(Axes::Lps), |s| axes(&s))?;
    Ok(PointFile { axes, ..parsed })
}

fn string(value: &Value, key: &str) -> Option<String> {
    value.get(key)?.as_str().map(str::to_owned)
}

/// Three finite numbers.
fn triple(value: Option<&Value>) -> Result<[f64; 3]> {
    let numbers = value.and_then(Value::as_array).filter(|items| items.len() == 3);
    let numbers: Option<Vec<f64>> = numbers.and_then(|items| items.iter().map(Value::as_f64).collect());
    let triple = numbers.and_then(|n| <[f64; 3]>::try_from(n).ok());
    triple.ok_or_else(|| Error::input("a point that is not three numbers").remedy(SHAPES))
}
