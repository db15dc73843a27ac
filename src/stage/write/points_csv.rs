//! Image points as CSV, `vertex,face,b0,b1,b2`: where each vertex of one mesh lies on the other.

use crate::error::{Error, Result};
use crate::mesh::{FaceId, Id, IdVec, SurfacePoint, TriMesh, VertexId};
use std::io::Write;
use std::path::Path;

const HEADER: &str = "vertex,face,b0,b1,b2";

/// Writes one row per vertex, in order; floats in their shortest form that reads back to the same value.
///
/// A point at an unreferenced vertex of `onto` lies on no face and is an error of kind `InvalidData`.
pub fn write_points(
    out: &mut dyn Write,
    points: &IdVec<VertexId, SurfacePoint>,
    onto: &TriMesh,
) -> std::io::Result<()> {
    writeln!(out, "{HEADER}")?;
    for (v, point) in points.iter_ids() {
        let (face, [b0, b1, b2]) = point.on_face(onto).ok_or_else(|| {
            std::io::Error::new(std::io::ErrorKind::InvalidData, format!("the image of {v} lies on no face"))
        })?;
        writeln!(out, "{},{},{b0:?},{b1:?},{b2:?}", v.0, face.0)?;
    }
    Ok(())
}

/// Reads what [`write_points`] wrote, with every number checked; `onto` is the mesh that the faces belong to.
pub fn read_points(path: &Path, onto: &TriMesh) -> Result<IdVec<VertexId, SurfacePoint>> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, &e))?;
    let mut lines = text.lines();
    if lines.next() != Some(HEADER) {
        return Err(Error::input("not a file of image points")
            .file(path)
            .at("line 1")
            .remedy(format!("expected {HEADER}")));
    }
    let mut points = IdVec::default();
    for (i, line) in lines.enumerate() {
        let row = parse_row(line, points.len(), onto);
        let (face, b) = row.map_err(|what| Error::input(what).file(path).at(format!("line {}", i + 2)))?;
        points.push(SurfacePoint::from_barycentric(onto, face, b));
    }
    Ok(points)
}

/// How far three barycentric coordinates may be from summing to one: rounding of three f64 in [0, 1].
const SUM_TOLERANCE: f64 = 1e-12;

fn parse_row(line: &str, vertex: usize, onto: &TriMesh) -> std::result::Result<(FaceId, [f64; 3]), String> {
    let cells: Vec<&str> = line.split(',').collect();
    let [v, f, b @ ..] = cells.as_slice() else { return Err("too few columns".into()) };
    if v.parse() != Ok(vertex) {
        return Err(format!("vertex {v} where {vertex} is due"));
    }
    let face = f.parse().ok().filter(|&f: &usize| f < onto.conn.face_count());
    let face = face.ok_or_else(|| format!("no face {f} in the mesh"))?;
    let b: Option<Vec<f64>> = b.iter().map(|x| x.parse().ok().filter(|x| (0.0..=1.0).contains(x))).collect();
    let b: Option<[f64; 3]> = b.and_then(|b| b.try_into().ok());
    let b = b.ok_or("three barycentric coordinates from 0 to 1 are due")?;
    if (b.iter().sum::<f64>() - 1.0).abs() <= SUM_TOLERANCE {
        Ok((FaceId::new(face), b))
    } else {
        Err("the barycentric coordinates do not sum to one".into())
    }
}
