//! Multi-source geodesic front over the faces of a mesh (VORONOI 5.1).
//!
//! The front walks from face to face; the step between two neighbours is the distance of their centroids after
//! unfolding them about the common edge, so distances do not depend on how the surface bends.

use super::bucket::BucketQueue;
use crate::mesh::{FaceId, HalfedgeId, Id, IdVec, LandmarkId, TriMesh, VertexId, corner, face_of, prev};
use rayon::prelude::*;

/// What a front leaves behind: for every face the nearest source and the distance to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Front {
    /// The nearest source; None where no front arrives.
    pub source: IdVec<FaceId, Option<LandmarkId>>,
    /// Distance along the face graph from the source's vertex to the face's centroid, in mesh units.
    pub distance: IdVec<FaceId, f64>,
}

/// Runs one front from all `sources` at once; every face is labelled with the source that reaches it first, of several at
/// one distance with the lowest.
pub fn front(mesh: &TriMesh, sources: &[VertexId]) -> Front {
    let faces = mesh.conn.face_count();
    let steps = steps(mesh);
    let longest = steps.iter().copied().fold(0.0, f64::max);
    let mean = steps.iter().sum::<f64>() / steps.len().max(1) as f64;
    let mut front = Front { source: IdVec::filled(None, faces), distance: IdVec::filled(f64::INFINITY, faces) };
    let mut queue = BucketQueue::new(faces, mean, longest);
    for (i, &v) in sources.iter().enumerate() {
        for f in mesh.conn.outgoing(v).map(face_of) {
            front.arrive(&mut queue, f, centroid(mesh, f).distance(mesh.positions[v]), LandmarkId::new(i));
        }
    }
    while let Some(f) = queue.pop().map(FaceId) {
        let (d, Some(label)) = (front.distance[f], front.source[f]) else { continue };
        for h in (0..3).map(|i| corner(f, i)) {
            if let Some(t) = mesh.conn.twin(h) {
                front.arrive(&mut queue, face_of(t), d + steps[h.index()], label);
            }
        }
    }
    front
}

impl Front {
    /// Takes note that a source is so far from a face, if none is nearer.
    #[inline]
    fn arrive(&mut self, queue: &mut BucketQueue, f: FaceId, d: f64, label: LandmarkId) {
        let known = self.distance[f];
        if d < known || (d == known && self.source[f].is_none_or(|other| label < other)) {
            self.distance[f] = d;
            self.source[f] = Some(label);
            queue.push(f.0, d);
        }
    }
}

/// For every half-edge the step from the face at its left to the one behind it; zero on the boundary.
fn steps(mesh: &TriMesh) -> Vec<f64> {
    let conn = &mesh.conn;
    let first = |h: HalfedgeId| match conn.twin(h) {
        Some(t) if h < t => step(mesh, h, t),
        _ => 0.0,
    };
    let mut steps: Vec<f64> = (0..3 * conn.face_count()).into_par_iter().map(|h| first(HalfedgeId::new(h))).collect();
    for h in conn.halfedges() {
        if let Some(t) = conn.twin(h).filter(|&t| t < h) {
            steps[h.index()] = steps[t.index()];
        }
    }
    steps
}

fn centroid(mesh: &TriMesh, f: FaceId) -> glam::DVec3 {
    let [a, b, c] = mesh.triangle(f);
    (a + b + c) / 3.0
}

/// Distance between the centroids of the faces at both halves of an edge, unfolded about it: a third of that of the corners
/// opposite to the edge.
fn step(mesh: &TriMesh, h: HalfedgeId, t: HalfedgeId) -> f64 {
    let at = |h: HalfedgeId| mesh.positions[mesh.conn.from(h)];
    let (start, edge) = (at(h), at(t) - at(h));
    let length = edge.length();
    let [(x, y), (z, w)] = [at(prev(h)) - start, at(prev(t)) - start].map(|far| match length > 0.0 {
        true => (far.dot(edge) / length, far.cross(edge).length() / length),
        false => (0.0, far.length()),
    });
    (x - z).hypot(y + w) / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::fixture::{disc, uneven};
    use crate::shape::random_landmarks;

    /// Every face has the least of what its neighbours and the sources at its corners offer, of several the lowest source.
    #[test]
    fn no_face_is_offered_anything_better() {
        for mesh in [disc(9), uneven(20.0, 16)] {
            let sources = random_landmarks(&mesh, 7, 3);
            let Front { source, distance } = front(&mesh, &sources);
            let mut best: IdVec<FaceId, (f64, Option<LandmarkId>)> =
                IdVec::filled((f64::INFINITY, None), mesh.conn.face_count());
            let mut offer = |f: FaceId, d: f64, label: Option<LandmarkId>| {
                if d < best[f].0 || (d == best[f].0 && label < best[f].1) {
                    best[f] = (d, label);
                }
            };
            for (i, &v) in sources.iter().enumerate() {
                for f in mesh.conn.outgoing(v).map(face_of) {
                    offer(f, centroid(&mesh, f).distance(mesh.positions[v]), Some(LandmarkId::new(i)));
                }
            }
            for h in mesh.conn.halfedges() {
                let Some(t) = mesh.conn.twin(h) else { continue };
                let (f, g) = (face_of(h), face_of(t));
                offer(g, distance[f] + step(&mesh, h.min(t), h.max(t)), source[f]);
            }
            assert!(mesh.conn.faces().all(|f| best[f] == (distance[f], source[f])));
        }
    }
}
