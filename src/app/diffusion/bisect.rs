//! Divides a set of faces in two by fronts from two places.

use super::borders::{vertex_at_share, walked};
use super::disc::{Labels, is_border, rims_of};
use crate::mesh::{FaceId, HalfedgeId, IdVec, TriMesh, VertexId, corner, face_of};
use crate::solve::nearest::Nearest;
use glam::DVec3;
use std::collections::BinaryHeap;

/// What fronts over the faces of one region leave behind.
pub struct Spread {
    /// For every face reached the number of the seed set that reached it first.
    pub from: IdVec<FaceId, Option<usize>>,
    /// Distance from it along centroids, mesh units.
    pub distance: IdVec<FaceId, f64>,
    /// The face before it on the way.
    pub before: IdVec<FaceId, Option<FaceId>>,
}

/// Runs fronts from sets of faces at once, inside the region of each; ties go to the lower set, then the lower face.
pub fn spread(mesh: &TriMesh, labels: &Labels, seeds: &[Vec<FaceId>]) -> Spread {
    let n = mesh.conn.face_count();
    let centroid = |f: FaceId| mesh.triangle(f).into_iter().sum::<DVec3>() / 3.0;
    let mut reached = Spread {
        from: IdVec::filled(None, n),
        distance: IdVec::filled(f64::INFINITY, n),
        before: IdVec::filled(None, n),
    };
    let mut queue = BinaryHeap::new();
    for (k, &f) in seeds.iter().enumerate().flat_map(|(k, set)| set.iter().map(move |f| (k, f))).rev() {
        (reached.distance[f], reached.from[f]) = (0.0, Some(k));
        queue.push(Nearest(0.0, f));
    }
    while let Some(Nearest(d, f)) = queue.pop() {
        if d > reached.distance[f] {
            continue;
        }
        for h in (0..3).map(|i| corner(f, i)).filter(|&h| !is_border(mesh, labels, h)) {
            let Some(g) = mesh.conn.twin(h).map(face_of) else { continue };
            let length = d + centroid(f).distance(centroid(g));
            if length < reached.distance[g] {
                (reached.distance[g], reached.from[g], reached.before[g]) = (length, reached.from[f], Some(f));
                queue.push(Nearest(length, g));
            }
        }
    }
    reached
}

impl Spread {
    /// The face among some that is farthest from the seeds; faces that are not reached count as farther.
    pub fn farthest(&self, faces: &[FaceId]) -> Option<FaceId> {
        let farther = |f: &FaceId, g: &FaceId| self.distance[*f].total_cmp(&self.distance[*g]).then(g.cmp(f));
        faces.iter().copied().max_by(farther)
    }

    /// The faces on the way to a face.
    fn way_to(&self, f: FaceId) -> Vec<FaceId> {
        std::iter::successors(Some(f), |&f| self.before[f]).collect()
    }
}

/// Divides a region around two faces that are far apart. Both parts are connected if the region is.
pub fn across(mesh: &TriMesh, labels: &Labels, faces: &[FaceId]) -> Vec<FaceId> {
    let far_from = |f: FaceId| spread(mesh, labels, &[vec![f]]).farthest(faces).unwrap_or(f);
    let first = far_from(faces[0]);
    let second = far_from(first);
    part(mesh, labels, faces, [vec![first], vec![second]])
}

/// Where a limb is divided lengthwise: a vertex of one of its rims; the other seam starts opposite.
#[derive(Clone, Copy, Debug)]
pub struct Seam {
    /// The rim.
    pub rim: usize,
    /// The place on it.
    pub place: usize,
}

/// Divides a tube with two or more rims, or the end of a limb with one, along its length: around a path from a place of a
/// rim to the next rim, or to the tip, and one that starts opposite. The part with the seam's start is returned.
pub fn lengthwise(mesh: &TriMesh, labels: &Labels, faces: &[FaceId], seam: Seam) -> Vec<FaceId> {
    let rims = rims_of(mesh, labels, faces);
    let rim = &rims[seam.rim];
    let starts = [seam.place, opposite(mesh, rim, seam.place)].map(|i| face_of(rim[i]));
    let reached = spread(mesh, labels, &[vec![starts[0]]]);
    let ends = match (0..rims.len()).find(|&k| k != seam.rim) {
        Some(other) => {
            let other = &rims[other];
            let nearer = |i: &usize, j: &usize| {
                let [a, b] = [*i, *j].map(|i| face_of(other[i]));
                reached.distance[a].total_cmp(&reached.distance[b]).then(a.cmp(&b))
            };
            let end = (0..other.len()).min_by(nearer).unwrap_or(0);
            [end, opposite(mesh, other, end)].map(|i| face_of(other[i]))
        }
        None => {
            let rim_faces = rim.iter().map(|&h| face_of(h)).collect();
            let tip = spread(mesh, labels, &[rim_faces]).farthest(faces).unwrap_or(starts[0]);
            [tip, tip]
        }
    };
    let first = reached.way_to(ends[0]);
    let mut second = spread(mesh, labels, &[vec![starts[1]]]).way_to(ends[1]);
    second.retain(|f| !first.contains(f));
    part(mesh, labels, faces, [first, second])
}

/// The faces nearer to the first set of seeds.
fn part(mesh: &TriMesh, labels: &Labels, faces: &[FaceId], seeds: [Vec<FaceId>; 2]) -> Vec<FaceId> {
    let reached = spread(mesh, labels, &seeds);
    faces.iter().copied().filter(|&f| reached.from[f] != Some(1)).collect()
}

/// The place half the length around a rim.
fn opposite(mesh: &TriMesh, rim: &[HalfedgeId], place: usize) -> usize {
    let n = rim.len();
    let path: Vec<VertexId> = (0..=n).map(|i| mesh.conn.from(rim[(place + i) % n])).collect();
    vertex_at_share(mesh, &path, 0.5).map_or(place, |k| (place + k) % n)
}

/// The place on a rim farthest from its middle: if there is a corner, it is there.
pub fn corner_of(mesh: &TriMesh, rim: &[HalfedgeId]) -> usize {
    let points: Vec<DVec3> = rim.iter().map(|&h| mesh.positions[mesh.conn.from(h)]).collect();
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let far = |i: &usize| points[*i].distance_squared(middle);
    (0..points.len()).max_by(|i, j| far(i).total_cmp(&far(j)).then(j.cmp(i))).unwrap_or(0)
}

/// The length of a rim, mesh units.
pub fn rim_length(mesh: &TriMesh, rim: &[HalfedgeId]) -> f64 {
    let n = rim.len();
    let path: Vec<VertexId> = (0..=n).map(|i| mesh.conn.from(rim[i % n])).collect();
    walked(mesh, &path).last().copied().unwrap_or(0.0)
}
