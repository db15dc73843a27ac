//! Measures of a sound mesh: components, genus, boundary loops, and what is odd about its positions.

use super::report::{BoundaryLoop, Component, Fault, Report, Warning};
use crate::mesh::{FaceId, IdVec, TriMesh, VertexId, face_of};
use glam::DVec3;
use rayon::prelude::*;

/// A face whose area is below this share of the square of its longest side counts as having none. Coordinates read from
/// decimal text leave collinear corners about 1e-16 off; far larger values would name thin but usable faces.
const NO_AREA: f64 = 1e-12;

/// Areas whose squares neither vanish nor overflow; beyond them no measure of a map can be computed.
const AREAS: std::ops::RangeInclusive<f64> = 1e-140..=1e140;

/// A closed component is inside out if its volume is below minus this share of what a surface of its area could hold;
/// flat ones have a volume of either sign by rounding.
const INSIDE_OUT: f64 = 1e-9;

/// Fills in everything that needs a manifold, faults of size included; returns the faces of components that are inside
/// out.
pub fn measure(mesh: &TriMesh, report: &mut Report) -> Vec<FaceId> {
    let label = mesh.conn.components();
    report.components = components(mesh, &label);
    report.boundary_loops = boundary_loops(mesh, &label);
    for one in &report.boundary_loops {
        report.components[one.component].boundary_loops += 1;
    }
    for component in &mut report.components {
        let loops = component.boundary_loops as i64;
        component.genus = Some((2 - loops - component.euler) / 2);
        if loops > 0 {
            component.volume = None;
        }
    }
    report.genus = report.components.iter().map(|c| c.genus).sum();
    report.faults.extend(sizeless(mesh, &label, &report.components));
    let negative = |c: &Component| c.volume.filter(|&v| v < -INSIDE_OUT * c.area.powf(1.5));
    let warning = |(component, c)| Some(Warning::InsideOut { component, volume: negative(c)? });
    report.warnings.extend(report.components.iter().enumerate().filter_map(warning));
    label.iter_ids().filter(|&(_, &c)| negative(&report.components[c as usize]).is_some()).map(|(f, _)| f).collect()
}

/// The components without area, or of a size that cannot be computed with.
fn sizeless(mesh: &TriMesh, label: &IdVec<FaceId, u32>, components: &[Component]) -> Vec<Fault> {
    let mut solid = vec![false; components.len()];
    for (f, &c) in label.iter_ids() {
        solid[c as usize] |= has_area(mesh.triangle(f));
    }
    let fault = |(component, c): (usize, &Component)| {
        let sized = solid[component] && AREAS.contains(&c.area);
        (!sized).then_some(Fault::NoArea { component, face: c.first_face, area: c.area })
    };
    components.iter().enumerate().filter_map(fault).collect()
}

fn components(mesh: &TriMesh, label: &IdVec<FaceId, u32>) -> Vec<Component> {
    let mut components: Vec<Component> = Vec::new();
    for (f, &c) in label.iter_ids() {
        let c = c as usize;
        if c == components.len() {
            components.push(Component { first_face: f, volume: Some(0.0), ..Component::default() });
        }
        let origin = mesh.triangle(components[c].first_face)[0]; // near by, so that nothing cancels
        let [p, q, r] = mesh.triangle(f).map(|p| p - origin);
        let one = &mut components[c];
        one.faces += 1;
        one.euler += 1;
        one.area += (q - p).cross(r - p).length() * 0.5;
        one.volume = one.volume.map(|volume| volume + p.dot(q.cross(r)) / 6.0);
    }
    let of = |h| label[face_of(h)] as usize;
    for h in mesh.conn.vertices().filter_map(|v| mesh.conn.leaving(v)) {
        components[of(h)].vertices += 1;
        components[of(h)].euler += 1;
    }
    for h in mesh.conn.halfedges().filter(|&h| mesh.conn.is_edge_representative(h)) {
        components[of(h)].euler -= 1;
    }
    components
}

fn boundary_loops(mesh: &TriMesh, label: &IdVec<FaceId, u32>) -> Vec<BoundaryLoop> {
    let length = |h| mesh.positions[mesh.conn.from(h)].distance(mesh.positions[mesh.conn.to(h)]);
    let describe = |one: Vec<_>| BoundaryLoop {
        component: label[face_of(one[0])] as usize,
        vertex: mesh.conn.from(one[0]),
        edges: one.len(),
        length: one.iter().map(|&h| length(h)).sum(),
    };
    mesh.conn.boundary_loops().into_iter().map(describe).collect()
}

/// What is odd about positions, whether or not the mesh has faults: areas, unused and doubled vertices.
pub fn oddities(positions: &[DVec3], triangles: &[[VertexId; 3]]) -> Vec<Warning> {
    let corners =
        |t: &[VertexId; 3]| Some([position(positions, t[0])?, position(positions, t[1])?, position(positions, t[2])?]);
    let flat =
        |t: &[VertexId; 3]| corners(t).is_some_and(|p| !has_area(p)) && t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    let faces: Vec<FaceId> = (0..).zip(triangles).filter(|(_, t)| flat(t)).map(|(f, _)| FaceId(f)).collect();
    let mut is_used = vec![false; positions.len()];
    for v in triangles.iter().flatten() {
        if let Some(used) = is_used.get_mut(v.0 as usize) {
            *used = true;
        }
    }
    let (used, vertices): (Vec<VertexId>, Vec<VertexId>) =
        (0..positions.len() as u32).map(VertexId).partition(|v| is_used[v.0 as usize]);
    let mut warnings = Vec::new();
    if !faces.is_empty() {
        warnings.push(Warning::ZeroArea { faces });
    }
    if !vertices.is_empty() {
        warnings.push(Warning::Unreferenced { vertices });
    }
    warnings.extend(duplicate_positions(positions, &used));
    warnings
}

fn position(positions: &[DVec3], v: VertexId) -> Option<DVec3> {
    positions.get(v.0 as usize).copied()
}

/// Phrased so that NaN and faces of a single point have no area.
fn has_area([a, b, c]: [DVec3; 3]) -> bool {
    let longest_sq = [b - a, c - b, a - c].iter().map(|e| e.length_squared()).fold(0.0, f64::max);
    (b - a).cross(c - a).length() * 0.5 > NO_AREA * longest_sq
}

/// Used vertices at the very position of a lower-numbered one.
fn duplicate_positions(positions: &[DVec3], used: &[VertexId]) -> Option<Warning> {
    let bits = |v: VertexId| positions[v.0 as usize].to_array().map(|x| (x + 0.0).to_bits()); // -0 is 0
    let mut keys: Vec<_> = used.iter().map(|&v| (bits(v), v)).collect();
    keys.par_sort_unstable();
    let doubled = keys.windows(2).filter(|w| w[0].0 == w[1].0);
    let count = doubled.clone().count();
    let first = doubled.map(|w| [w[0].1, w[1].1]).min()?;
    Some(Warning::DuplicatePositions { count, first })
}
