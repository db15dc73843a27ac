//! Limbs divided in two along their length (DIFFUSION 2.7, figure 7): the coordinates of a whole end stretch its edges.

use super::bisect::{Seam, corner_of, lengthwise};
use super::disc::{Bounds, Labels, faces_by_region, labels_of, rims_of};
use crate::mesh::io::{Region, Regions};
use crate::mesh::{FaceId, HalfedgeId, TriMesh, face_of};
use glam::DVec3;
use std::collections::BTreeMap;

/// The ends of limbs that were divided, and for each where its seam starts in the box around the mesh.
pub type Ends = BTreeMap<String, DVec3>;

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
        let seam = seam(mesh, &labels, &rims, like.and_then(|like| like.get(name)), &bounds);
        let start = mesh.positions[mesh.conn.from(rims[seam.rim][seam.place])];
        let part = lengthwise(mesh, &labels, &faces, seam);
        let other = list.len() as u32;
        let is_part: std::collections::HashSet<FaceId> = part.into_iter().collect();
        faces.iter().filter(|f| !is_part.contains(f)).for_each(|&f| divided[f] = other);
        ends.insert(name.clone(), bounds.share(start));
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

/// The rim behind which the first region lies, and its corner; or the place of it most like the given one.
fn seam(mesh: &TriMesh, labels: &Labels, rims: &[Vec<HalfedgeId>], like: Option<&DVec3>, bounds: &Bounds) -> Seam {
    let beyond = |k: &usize| rims[*k].iter().map(|&h| mesh.conn.twin(h).map_or(u32::MAX, |t| labels[face_of(t)])).min();
    let rim = (0..rims.len()).min_by_key(beyond).unwrap_or(0);
    let place = match like {
        None => corner_of(mesh, &rims[rim]),
        Some(goal) => {
            let apart = |i: &usize| bounds.share(mesh.positions[mesh.conn.from(rims[rim][*i])]).distance_squared(*goal);
            (0..rims[rim].len()).min_by(|i, j| apart(i).total_cmp(&apart(j))).unwrap_or(0)
        }
    };
    Seam { rim, place }
}
