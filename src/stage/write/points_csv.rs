//! Image points as CSV, `vertex,face,b0,b1,b2`: where each vertex of one mesh lies on the other.

use crate::error::{Error, Result};
use crate::map::file_order::Onto;
use crate::mesh::{FaceId, Id, IdVec, SurfacePoint, VertexId};
use std::io::Write;
use std::path::Path;

const HEADER: &str = "vertex,face,b0,b1,b2";

/// Writes one row per vertex with an image, in order; floats in their shortest form that reads back to the same value.
pub fn write_points(
    out: &mut dyn Write,
    points: &IdVec<VertexId, Option<SurfacePoint>>,
    onto: Onto,
) -> std::io::Result<()> {
    writeln!(out, "{HEADER}")?;
    for (v, point) in points.iter_ids() {
        if let Some((face, [b0, b1, b2])) = point.and_then(|p| onto.in_file_order(p)) {
            writeln!(out, "{},{},{b0:?},{b1:?},{b2:?}", v.0, face.0)?;
        }
    }
    Ok(())
}

/// Reads what [`write_points`] wrote for `vertices` vertices, with every number checked.
pub fn read_points(path: &Path, vertices: usize, onto: Onto) -> Result<IdVec<VertexId, Option<SurfacePoint>>> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, &e))?;
    let mut lines = text.lines();
    let fail = |what: String, line: usize| Err(Error::input(what).file(path).at(format!("line {line}")));
    if lines.next() != Some(HEADER) {
        return fail(format!("not a file of image points, which starts with {HEADER}"), 1);
    }
    let mut points = IdVec::filled(None, vertices);
    for (i, line) in lines.enumerate() {
        match parse_row(line, vertices, onto) {
            Ok((v, _)) if points[v].is_some() => return fail(format!("{v} stands here a second time"), i + 2),
            Ok((v, point)) => points[v] = Some(point),
            Err(what) => return fail(what, i + 2),
        }
    }
    Ok(points)
}

/// How far three barycentric coordinates may be from summing to one: rounding of three f64 in [0, 1].
const SUM_TOLERANCE: f64 = 1e-12;

fn parse_row(line: &str, vertices: usize, onto: Onto) -> std::result::Result<(VertexId, SurfacePoint), String> {
    let cells: Vec<&str> = line.split(',').collect();
    let [v, f, b @ ..] = cells.as_slice() else { return Err("too few columns".into()) };
    let below = |text: &str, count: usize| text.parse().ok().filter(|&i: &usize| i < count);
    let vertex = below(v, vertices).ok_or_else(|| format!("no vertex {v} in the mesh"))?;
    let face = below(f, onto.triangles.len()).ok_or_else(|| format!("no face {f} in the mesh"))?;
    let b: Option<Vec<f64>> = b.iter().map(|x| x.parse().ok().filter(|x| (0.0..=1.0).contains(x))).collect();
    let b: Option<[f64; 3]> = b.and_then(|b| b.try_into().ok());
    let b = b.ok_or("three barycentric coordinates from 0 to 1 are due")?;
    if (b.iter().sum::<f64>() - 1.0).abs() <= SUM_TOLERANCE {
        let point = onto.from_file_order(FaceId::new(face), b);
        Ok((VertexId::new(vertex), point.ok_or_else(|| format!("face {f} is left out of the map"))?))
    } else {
        Err("the barycentric coordinates do not sum to one".into())
    }
}
