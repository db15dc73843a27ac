//! Landmarks on the boundary of one mesh that lie just inside the other.
//!
//! No homeomorphism maps a boundary point inside. Where a few faces between such a landmark and the boundary are all
//! that is in the way, these faces are left out of the map, so that the boundary passes the landmark; the user is told.

use super::{LoadedMesh, SIDES};
use crate::map::file_order::number_in_file;
use crate::mesh::io::Landmarks;
use crate::mesh::{Canonical, FaceId, TriMesh, VertexId, face_of};

/// Faces left out for one landmark at most; with more, the boundary would change its shape visibly.
const MOST_FACES: usize = 6;

/// Leaves out what keeps landmarks from the boundary that their counterparts lie on; says which faces and why.
///
/// Landmarks farther inside stay where they are.
pub fn trim(meshes: [&mut LoadedMesh; 2], landmarks: &Landmarks) -> Vec<String> {
    let mut notes = Vec::new();
    let at = [&landmarks.source, &landmarks.target];
    for (i, name) in landmarks.names.iter().enumerate() {
        let outside = [0, 1].map(|k| meshes[k].mesh.conn.is_on_boundary(at[k][i]));
        let Some(inner) = (0..2).find(|&k| !outside[k] && outside[1 - k]) else { continue };
        let wanted = |v: VertexId| {
            let twin = at[inner].iter().position(|&w| w == v).map(|j| at[1 - inner][j]);
            twin.is_none_or(|w| meshes[1 - inner].mesh.conn.is_on_boundary(w))
        };
        let Some(faces) = faces_before(&meshes[inner].mesh, at[inner][i], &wanted) else { continue };
        let mesh = &mut *meshes[inner];
        let numbers: Vec<FaceId> = faces.iter().map(|&f| number_in_file(f, &mesh.omitted)).collect();
        let Some(trimmed) = without(&mesh.mesh, &faces) else { continue };
        mesh.canonical = Canonical::new(&trimmed);
        mesh.mesh = trimmed;
        mesh.omitted.extend(&numbers);
        mesh.omitted.sort_unstable();
        let listed: Vec<String> = numbers.iter().map(|f| f.0.to_string()).collect();
        notes.push(format!(
            "landmark \"{name}\" lies on the boundary of the {} but just inside the {}: triangles {} of the {} (counted \
             from 0) are left out of the map, so that the boundary passes it",
            SIDES[1 - inner],
            SIDES[inner],
            listed.join(", "),
            SIDES[inner]
        ));
    }
    notes
}

/// The fewest faces around one boundary vertex that separate `v` from the boundary, if leaving them out changes neither
/// the kind of surface nor which vertices it has, and puts only `wanted` vertices on the boundary.
fn faces_before(mesh: &TriMesh, v: VertexId, wanted: &dyn Fn(VertexId) -> bool) -> Option<Vec<FaceId>> {
    let mut fans: Vec<Vec<FaceId>> = Vec::new();
    for b in mesh.conn.outgoing(v).map(|h| mesh.conn.to(h)).filter(|&b| mesh.conn.is_on_boundary(b)) {
        let around: Vec<FaceId> = mesh.conn.outgoing(b).map(face_of).collect();
        let at = mesh.conn.outgoing(b).position(|h| mesh.conn.to(h) == v)?;
        fans.extend([around[..at].to_vec(), around[at..].to_vec()]);
    }
    fans.retain(|fan| fan.len() <= MOST_FACES);
    fans.sort_by_key(|fan| (fan.len(), fan.first().copied()));
    let fits = |fan: &Vec<FaceId>| {
        let corners = fan.iter().flat_map(|&f| mesh.face(f));
        corners.into_iter().all(|w| mesh.conn.is_on_boundary(w) || wanted(w)) && without(mesh, fan).is_some()
    };
    fans.into_iter().find(fits)
}

/// The mesh without some of its faces; None if that is no manifold of the same kind with the same vertices.
fn without(mesh: &TriMesh, faces: &[FaceId]) -> Option<TriMesh> {
    let kept: Vec<[VertexId; 3]> = mesh.conn.faces().filter(|f| !faces.contains(f)).map(|f| mesh.face(f)).collect();
    let trimmed = TriMesh::new(mesh.positions.raw.clone(), &kept).ok()?;
    let kind = |m: &TriMesh| (m.conn.euler_characteristic(), m.conn.boundary_loops().len());
    let used = |m: &TriMesh| m.conn.vertices().filter(|&v| m.conn.leaving(v).is_some()).count();
    (kind(&trimmed) == kind(mesh) && used(&trimmed) == used(mesh)).then_some(trimmed)
}
