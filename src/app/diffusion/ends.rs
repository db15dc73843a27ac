//! Limbs divided in two along their length (DIFFUSION 2.7, figure 7): the coordinates of a whole end stretch its edges.

use super::bisect::{Seam, corner_of, lengthwise};
use super::disc::{Bounds, Labels, faces_by_region, labels_of, rims_of};
use crate::mesh::io::{Region, Regions};
use crate::mesh::{FaceId, HalfedgeId, TriMesh, face_of};
use glam::DVec3;
use std::collections::BTreeMap;

/// Where the division of a limb starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The first region behind the rim.
    beyond: u32,
    /// The place on the rim, in the box around the mesh.
    at: DVec3,
}

/// The ends of limbs that were divided, by name.
pub type Ends = BTreeMap<String, Start>;

/// Divides every end of a limb, which is a region with one neighbour all around, and every tube, which has two rims, into
/// halves `NAME a` and `NAME b`. Seams start at the places of `like`, those of another mesh.
pub fn split_ends(mesh: &TriMesh, regions: &Regions, like: Option<&Ends>) -> (Regions, Ends) {
    let labels = labels_of(regions);
    let mut divided = labels.clone();
    let mut list = regions.list.clone();
    let mut ends = Ends::new();
    let bounds = Bounds::of(mesh);
    for (r, faces) in faces_by_region(&labels, regions.list.len()).into_iter().enumerate() {
        let name = &regions.list[r].name;
        let rims = rims_of(mesh, &labels, &faces);
        let wanted = like.map_or_else(|| is_limb(mesh, &labels, &rims), |like| like.contains_key(name));
        if !wanted || rims.is_empty() {
            continue;
        }
        let seam = match like.and_then(|like| like.get(name)) {
            Some(start) => seam_like(mesh, &labels, &rims, start, &bounds),
            None => seam(mesh, &labels, &divided, &rims),
        };
        let start = mesh.positions[mesh.conn.from(rims[seam.rim][seam.place])];
        let part = lengthwise(mesh, &labels, &faces, seam);
        let other = list.len() as u32;
        let is_part: std::collections::HashSet<FaceId> = part.into_iter().collect();
        faces.iter().filter(|f| !is_part.contains(f)).for_each(|&f| divided[f] = other);
        let beyond = beyond(mesh, &labels, &rims[seam.rim]);
        ends.insert(name.clone(), Start { beyond, at: bounds.share(start) });
        list[r] = Region { name: format!("{name} a"), sides: None };
        list.push(Region { name: format!("{name} b"), sides: None });
    }
    (Regions { path: regions.path.clone(), list, of_triangle: divided.raw }, ends)
}

/// True for a region with one rim and one neighbour behind all of it, and for one with two rims.
fn is_limb(mesh: &TriMesh, labels: &Labels, rims: &[Vec<HalfedgeId>]) -> bool {
    let beyond = |h: &HalfedgeId| mesh.conn.twin(*h).map(|t| labels[face_of(t)]);
    match rims {
        [rim] => beyond(&rim[0]).is_some() && rim.iter().all(|h| beyond(h) == beyond(&rim[0])),
        _ => rims.len() == 2,
    }
}

/// The first region behind a rim; what lies beyond the boundary comes last.
fn beyond(mesh: &TriMesh, labels: &Labels, rim: &[HalfedgeId]) -> u32 {
    rim.iter().map(|&h| mesh.conn.twin(h).map_or(u32::MAX, |t| labels[face_of(t)])).min().unwrap_or(u32::MAX)
}

/// Where the halves of a neighbour meet, so that the borders between one's own halves end a quarter of the rim from there;
/// or else the corner of the rim behind which the first region lies.
fn seam(mesh: &TriMesh, labels: &Labels, divided: &Labels, rims: &[Vec<HalfedgeId>]) -> Seam {
    for (rim, path) in rims.iter().enumerate() {
        let behind = |i: usize| mesh.conn.twin(path[i % path.len()]).map(face_of);
        let halves_meet = |i: &usize| {
            let pair = behind(i + path.len() - 1).zip(behind(*i));
            pair.is_some_and(|(f, g)| labels[f] == labels[g] && divided[f] != divided[g])
        };
        if let Some(place) = (0..path.len()).find(halves_meet) {
            return Seam { rim, place };
        }
    }
    let rim = (0..rims.len()).min_by_key(|&k| beyond(mesh, labels, &rims[k])).unwrap_or(0);
    Seam { rim, place: corner_of(mesh, &rims[rim]) }
}

/// The place most like one of another mesh.
fn seam_like(mesh: &TriMesh, labels: &Labels, rims: &[Vec<HalfedgeId>], start: &Start, bounds: &Bounds) -> Seam {
    let rim = (0..rims.len()).find(|&k| beyond(mesh, labels, &rims[k]) == start.beyond).unwrap_or(0);
    let apart = |i: &usize| bounds.share(mesh.positions[mesh.conn.from(rims[rim][*i])]).distance_squared(start.at);
    let place = (0..rims[rim].len()).min_by(|i, j| apart(i).total_cmp(&apart(j))).unwrap_or(0);
    Seam { rim, place }
}
