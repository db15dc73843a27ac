//! Checks that triangles form an oriented manifold and names every fault with its element.
//!
//! Faces that were turned over are turned back where that is all it takes, and a closed component that is inside out is
//! turned over as a whole. Whatever else stands in the way of a manifold is a fault; what a map survives (zero-area faces,
//! unused or doubled vertices) is a warning.

mod diagnose;
mod geometry;
mod parity;
mod report;

pub use report::{BoundaryLoop, Component, Fault, Report, Warning};

use super::{FaceId, TriMesh, VertexId};
use diagnose::diagnose;
use glam::DVec3;

/// Checks a mesh. The report owns the repaired mesh if it has no fault; see [`Report::take_mesh`].
pub fn check(positions: &[DVec3], triangles: &[[VertexId; 3]]) -> Report {
    let mut report = Report { vertices: positions.len(), faces: triangles.len(), ..Report::default() };
    let finite = |(v, p): (u32, &DVec3)| (!p.is_finite()).then_some(Fault::NotFinite { vertex: VertexId(v) });
    report.faults.extend((0..).zip(positions).filter_map(finite));
    report.warnings = geometry::oddities(positions, triangles);
    if triangles.is_empty() {
        report.faults.push(Fault::NoFaces);
    }
    // A mesh that can be joined as it is has no fault of connectivity: only the others are searched for them.
    let mesh = TriMesh::new(positions.to_vec(), triangles).or_else(|_| {
        let diagnosis = diagnose(positions.len(), triangles);
        report.faults.extend(diagnosis.faults);
        report.flipped = diagnosis.flipped;
        report.components = diagnosis.components;
        let mut repaired = triangles.to_vec();
        report.flipped.iter().for_each(|f| repaired[f.0 as usize].swap(1, 2));
        TriMesh::new(positions.to_vec(), &repaired)
    });
    if let (Ok(mesh), true) = (mesh, report.faults.is_empty()) {
        let inside_out = geometry::measure(&mesh, &mut report);
        report.mesh = if inside_out.is_empty() { Some(mesh) } else { turned_over(&mesh, &inside_out) };
        if !report.faults.is_empty() {
            (report.mesh, report.genus) = (None, None);
        }
    }
    report
}

/// The mesh with these faces turned over: whole components, so that it stays a manifold.
fn turned_over(mesh: &TriMesh, faces: &[FaceId]) -> Option<TriMesh> {
    let mut triangles = mesh.faces();
    faces.iter().for_each(|f| triangles[f.0 as usize].swap(1, 2));
    TriMesh::new(mesh.positions.raw.clone(), &triangles).ok()
}
