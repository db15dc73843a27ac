//! Where a landmark file says a point is, and which vertex that means.

use crate::mesh::VertexId;
use crate::mesh::io::mesh_file::MeshFile;
use crate::{Error, Result};
use glam::DVec3;
use rayon::prelude::*;
use std::path::PathBuf;

/// A point that lies further from its vertex than this share of the mesh's diagonal is named in the notes.
const FAR: f64 = 0.01;
/// Remedy for an index without an element.
const COUNT_FROM_ZERO: &str = "indices count from 0; is this the file of another mesh?";

/// A place on a mesh as written in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A vertex by its index.
    Vertex(u64),
    /// A point of a triangle (polygons counted as fans) with the first two barycentric coordinates.
    Triangle(u64, [f64; 2]),
    /// A position near the surface.
    Position(DVec3),
}

/// A row of a landmark file, for one mesh.
#[derive(Clone, Debug)]
pub struct Entry {
    /// The row, from 1, the header not counted.
    pub number: usize,
    /// The line, from 1, in formats of one row per line.
    pub line: Option<usize>,
    /// The label, if there is one.
    pub name: Option<String>,
    /// The place.
    pub place: Place,
}

impl Entry {
    /// The row as an error names it.
    pub fn row(&self) -> String {
        row(self.number, self.line)
    }

    /// The label, or the row where there is none.
    pub fn label(&self) -> String {
        self.name.clone().unwrap_or_else(|| self.row())
    }
}

/// A row as an error names it.
pub fn row(number: usize, line: Option<usize>) -> String {
    line.map_or_else(|| format!("row {number}"), |line| format!("row {number}, line {line}"))
}

/// The axes of the positions in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// The mesh's own.
    #[default]
    Own,
    /// Left, posterior, superior: patient coordinates that a mesh may hold as they are or with x and y negated.
    Lps,
    /// Right, anterior, superior: likewise.
    Ras,
}

/// A file of points on one mesh.
#[derive(Clone, Debug, Default)]
pub struct PointFile {
    /// Where it was read from.
    pub path: PathBuf,
    /// The points in the order of the file.
    pub entries: Vec<Entry>,
    /// The axes of positions.
    pub axes: Axes,
}

/// A vertex and how far from its point it is.
struct Nearest {
    vertex: VertexId,
    distance: f64,
}

/// The vertices of all points; notes how far positions were moved. Errors name the row, not yet the file.
pub fn vertices(points: &PointFile, mesh: &MeshFile, side: &str, notes: &mut Vec<String>) -> Result<Vec<VertexId>> {
    let surface = Surface::new(mesh);
    let nearest = surface.nearest_all(&points.entries, side)?;
    let nearest = match points.axes {
        Axes::Own => nearest,
        Axes::Lps | Axes::Ras => surface.choose_axes(points, nearest, side, notes)?,
    };
    surface.note_distances(points, &nearest, side, notes);
    Ok(nearest.into_iter().map(|n| n.vertex).collect())
}

/// What points are placed on.
struct Surface<'a> {
    mesh: &'a MeshFile,
    triangles: Vec<[VertexId; 3]>,
    /// The vertices that faces use, in order.
    used: Vec<VertexId>,
}

impl<'a> Surface<'a> {
    fn new(mesh: &'a MeshFile) -> Self {
        let mut is_used = vec![false; mesh.positions.len()];
        mesh.corners.iter().for_each(|v| is_used[v.0 as usize] = true);
        let used = (0..).zip(is_used).filter_map(|(v, used)| used.then_some(VertexId(v))).collect();
        Surface { mesh, triangles: mesh.triangles(), used }
    }

    fn position(&self, v: VertexId) -> DVec3 {
        self.mesh.positions[v.0 as usize]
    }

    fn nearest_all(&self, entries: &[Entry], side: &str) -> Result<Vec<Nearest>> {
        entries.iter().map(|e| self.nearest(e.place, side).map_err(|error| error.at(e.row()))).collect()
    }

    fn nearest(&self, place: Place, side: &str) -> Result<Nearest> {
        match place {
            Place::Vertex(v) => self.vertex(v, side),
            Place::Triangle(t, b) => self.corner(t, b, side),
            Place::Position(p) => Ok(self.closest(&self.used, p)),
        }
    }

    fn vertex(&self, v: u64, side: &str) -> Result<Nearest> {
        let n = self.mesh.positions.len();
        match u32::try_from(v) {
            Ok(v) if (v as usize) < n => Ok(Nearest { vertex: VertexId(v), distance: 0.0 }),
            _ => Err(Error::input(format!("{side} vertex {v} does not exist, the {side} has {n} vertices"))
                .remedy(COUNT_FROM_ZERO)),
        }
    }

    /// The corner of triangle `t` that is nearest to the point A u + B v + C (1 - u - v).
    fn corner(&self, t: u64, [u, v]: [f64; 2], side: &str) -> Result<Nearest> {
        let n = self.triangles.len();
        let Some(corners) = usize::try_from(t).ok().and_then(|t| self.triangles.get(t)) else {
            let what = format!("{side} triangle {t} does not exist, the {side} has {n}");
            return Err(Error::input(what).remedy(COUNT_FROM_ZERO));
        };
        let [a, b, c] = corners.map(|v| self.position(v));
        Ok(self.closest(corners, a * u + b * v + c * (1.0 - u - v)))
    }

    /// The closest of some vertices; the lowest number wins a tie.
    fn closest(&self, candidates: &[VertexId], p: DVec3) -> Nearest {
        let (distance_sq, vertex) = candidates
            .par_iter()
            .map(|&v| (self.position(v).distance_squared(p), v))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .unwrap_or((0.0, VertexId(0))); // meshes have faces, so there are candidates
        Nearest { vertex, distance: distance_sq.sqrt() }
    }

    /// Takes the positions as they are or with x and y negated, whichever lies closer to the mesh.
    fn choose_axes(
        &self,
        points: &PointFile,
        nearest: Vec<Nearest>,
        side: &str,
        notes: &mut Vec<String>,
    ) -> Result<Vec<Nearest>> {
        let mirrored: Vec<Entry> = points.entries.iter().map(half_turn).collect();
        let turned = self.nearest_all(&mirrored, side)?;
        let total = |all: &[Nearest]| all.iter().map(|n| n.distance).sum::<f64>();
        let turn = total(&turned) < total(&nearest);
        let axes = if points.axes == Axes::Lps { "LPS" } else { "RAS" };
        let action = if turn { "turned to the other of LPS and RAS (x and y negated)" } else { "used as written" };
        notes.push(format!("{side} landmarks are given in {axes}: {action}, which lies closer to the mesh"));
        Ok(if turn { turned } else { nearest })
    }

    fn note_distances(&self, points: &PointFile, nearest: &[Nearest], side: &str, notes: &mut Vec<String>) {
        let moved = points.entries.iter().zip(nearest).filter(|(e, _)| !matches!(e.place, Place::Vertex(_)));
        let Some((worst, far)) = moved.clone().max_by(|a, b| a.1.distance.total_cmp(&b.1.distance)) else { return };
        let name = |e: &Entry| if e.name.is_some() { format!("\"{}\", {}", e.label(), e.row()) } else { e.row() };
        notes.push(format!(
            "{} {side} landmarks moved to the nearest vertex, by at most {:.6} ({})",
            moved.clone().count(),
            far.distance,
            name(worst)
        ));
        let limit = FAR * self.diagonal();
        for (entry, n) in moved.filter(|(_, n)| n.distance > limit) {
            let (name, distance, v) = (name(entry), n.distance, n.vertex);
            notes.push(format!("{side} landmark {name} is {distance:.6} away from its {v}: is it on this mesh?"));
        }
    }

    fn diagonal(&self) -> f64 {
        let corners = self.used.iter().map(|&v| self.position(v));
        let (low, high) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        low.distance(high)
    }
}

/// Half a turn about the z axis, which takes LPS to RAS and back.
fn half_turn(entry: &Entry) -> Entry {
    let place = match entry.place {
        Place::Position(p) => Place::Position(DVec3::new(-p.x, -p.y, p.z)),
        other => other,
    };
    Entry { place, ..entry.clone() }
}
