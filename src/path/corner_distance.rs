//! Distances between the corners of a region, from face to face of its cut mesh.

use super::cut_mesh::CutMesh;
use super::search::Terminal;
use crate::mesh::{FaceId, IdVec, corner, face_of};
use crate::solve::nearest::Nearest;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BinaryHeap;

/// The distance between every two corners of a region, in mesh units, along the centroids of faces: a little more than
/// the shortest path's, but found for any region.
pub fn corner_distances(cut: &CutMesh, corners: &[Terminal]) -> Vec<Vec<f64>> {
    let centroid = |f: FaceId| cut.conn.face(f).map(|v| cut.positions[v]).into_iter().sum::<DVec3>() / 3.0;
    let centroids: IdVec<FaceId, DVec3> = cut.conn.faces().map(centroid).collect();
    let ways_in = |t: &Terminal| -> Vec<(FaceId, f64)> {
        let faces = t.sector.iter().map(|&h| face_of(h));
        faces.map(|f| (f, centroids[f].distance(cut.positions[t.vertex]))).collect()
    };
    let ends: Vec<Vec<(FaceId, f64)>> = corners.iter().map(ways_in).collect();
    let from = |start: &Vec<(FaceId, f64)>| {
        let reached = spread(cut, &centroids, start);
        let arrival = |end: &Vec<(FaceId, f64)>| end.iter().map(|&(f, d)| reached[f] + d).fold(f64::INFINITY, f64::min);
        ends.iter().map(arrival).collect()
    };
    ends.par_iter().map(from).collect()
}

/// The distance of every face's centroid from a start, crossing no arc.
fn spread(cut: &CutMesh, centroids: &IdVec<FaceId, DVec3>, start: &[(FaceId, f64)]) -> IdVec<FaceId, f64> {
    let mut distance = IdVec::filled(f64::INFINITY, centroids.len());
    let mut queue: BinaryHeap<Nearest<FaceId>> = BinaryHeap::new();
    for &(f, d) in start {
        distance[f] = d;
        queue.push(Nearest(d, f));
    }
    while let Some(Nearest(d, f)) = queue.pop() {
        if d > distance[f] {
            continue;
        }
        for h in (0..3).map(|i| corner(f, i)).filter(|&h| cut.arc_at(h).is_none()) {
            let Some(g) = cut.conn.twin(h).map(face_of) else { continue };
            let length = d + centroids[f].distance(centroids[g]);
            if length < distance[g] {
                distance[g] = length;
                queue.push(Nearest(length, g));
            }
        }
    }
    distance
}
