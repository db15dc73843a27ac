//! Multi-source geodesic front over the faces of a mesh (VORONOI 5.1).
//!
//! The front walks from face to face; the step between two neighbours is the distance of their centroids after
//! unfolding them about the common edge, so distances do not depend on how the surface bends.

use crate::mesh::{FaceId, Id, IdVec, LandmarkId, TriMesh, VertexId, corner, face_of, metric};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// What a front leaves behind: for every face the nearest source and the distance to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Front {
    /// The nearest source; None where no front arrives.
    pub source: IdVec<FaceId, Option<LandmarkId>>,
    /// Distance along the face graph from the source's vertex to the face's centroid, in mesh units.
    pub distance: IdVec<FaceId, f64>,
}

/// An entry of the queue; the smallest distance comes first, ties go to the lower source, then the lower face.
#[derive(PartialEq)]
struct Arrival(f64, LandmarkId, FaceId);

impl Eq for Arrival {}

impl Ord for Arrival {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1)).then(other.2.cmp(&self.2))
    }
}

impl PartialOrd for Arrival {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Runs one front from all `sources` at once; every face is labelled with the source that reaches it first.
pub fn front(mesh: &TriMesh, sources: &[VertexId]) -> Front {
    let faces = mesh.conn.face_count();
    let mut source = IdVec::filled(None, faces);
    let mut distance = IdVec::filled(f64::INFINITY, faces);
    let mut queue = BinaryHeap::new();
    for (i, &v) in sources.iter().enumerate() {
        for h in mesh.conn.outgoing(v) {
            let f = face_of(h);
            queue.push(Arrival(centroid(mesh, f).distance(mesh.positions[v]), LandmarkId::new(i), f));
        }
    }
    while let Some(Arrival(d, label, f)) = queue.pop() {
        if source[f].is_some() {
            continue;
        }
        source[f] = Some(label);
        distance[f] = d;
        for i in 0..3 {
            if let Some(t) = mesh.conn.twin(corner(f, i)).filter(|&t| source[face_of(t)].is_none()) {
                queue.push(Arrival(d + step(mesh, f, i, face_of(t), t.index() % 3), label, face_of(t)));
            }
        }
    }
    Front { source, distance }
}

fn centroid(mesh: &TriMesh, f: FaceId) -> glam::DVec3 {
    let [a, b, c] = mesh.triangle(f);
    (a + b + c) / 3.0
}

/// Distance between the centroids of `f` and `g` unfolded about their common edge: side `i` of `f`, side `j` of `g`.
fn step(mesh: &TriMesh, f: FaceId, i: usize, g: FaceId, j: usize) -> f64 {
    let turned = |t: [glam::DVec3; 3], i: usize| [t[i], t[(i + 1) % 3], t[(i + 2) % 3]];
    let [_, p, q] = metric::flatten(turned(mesh.triangle(f), i));
    let [_, r, s] = metric::flatten(turned(mesh.triangle(g), j));
    let along = (p.x + q.x) / 3.0 - (r.x - (r.x + s.x) / 3.0);
    along.hypot((q.y + s.y) / 3.0)
}
