//! Fronts, clusters and the cuts between them.

mod common;

use common::mesh::{self, vertices};
use homeo::mesh::{FaceId, HalfedgeId, Id, LandmarkId, TriMesh, VertexId, corner, face_of};
use homeo::path::cluster::Clusters;
use homeo::path::front::front;
use homeo::shape::random_landmarks;

fn centroid(mesh: &TriMesh, f: FaceId) -> glam::DVec3 {
    mesh.triangle(f).iter().sum::<glam::DVec3>() / 3.0
}

#[test]
fn every_face_is_labelled_and_distances_grow_away_from_the_landmarks() {
    let mesh = mesh::sphere(11, 24);
    let clusters = Clusters::grow(&mesh, &random_landmarks(&mesh, 9, 1));
    for f in mesh.conn.faces() {
        assert!(clusters.of_face[f].is_some());
        let touches = mesh.face(f).iter().any(|&v| random_landmarks(&mesh, 9, 1).contains(&v));
        let nearer = (0..3)
            .filter_map(|i| mesh.conn.twin(corner(f, i)))
            .map(face_of)
            .any(|g| clusters.of_face[g] == clusters.of_face[f] && clusters.distance[g] < clusters.distance[f]);
        assert!(touches || nearer, "{f} was reached from nowhere");
    }
}

#[test]
fn distances_on_a_plane_lie_between_straight_and_a_little_more() {
    // The path through centroids zigzags; on this grid it is never longer than 1.3 straight lines plus one square.
    let mesh = mesh::grid(30, 30);
    let start = VertexId::new(15 * 31 + 15);
    let front = front(&mesh, &[start]);
    for f in mesh.conn.faces() {
        let straight = centroid(&mesh, f).distance(mesh.positions[start]);
        assert!(front.distance[f] >= straight - 1e-12, "{f} is nearer than a straight line");
        assert!(front.distance[f] <= 1.3 * straight + 1.0, "{f}: {} for {straight}", front.distance[f]);
    }
}

#[test]
fn two_landmarks_on_a_plane_halve_it() {
    //   a . . . . | . . . . b      the cut is one run from border to border
    let mesh = mesh::grid(20, 6);
    let clusters = Clusters::grow(&mesh, &vertices(&[3 * 21, 3 * 21 + 20]));
    for f in mesh.conn.faces() {
        let x = centroid(&mesh, f).x;
        let expected = if x < 9.0 {
            Some(0)
        } else if x > 11.0 {
            Some(1)
        } else {
            None
        };
        if let (Some(side), Some(l)) = (expected, clusters.of_face[f]) {
            assert_eq!(l, LandmarkId(side), "{f} at x = {x}");
        }
    }
    assert_eq!(clusters.cuts.len(), 1);
    assert!(!clusters.cuts[0].closed);
    cuts_are_complete(&mesh, &clusters);
}

#[test]
fn the_order_of_faces_does_not_matter_seed_2() {
    let mesh = mesh::jittered(&mesh::sphere(9, 14), 0.02, 2);
    let marks = random_landmarks(&mesh, 7, 2);
    let (shuffled, order) = mesh::permuted(&mesh, 2);
    let (one, other) = (Clusters::grow(&mesh, &marks), Clusters::grow(&shuffled, &marks));
    for (new, &old) in order.iter().enumerate() {
        assert_eq!(one.of_face[old], other.of_face[FaceId::new(new)]);
    }
    assert_eq!(one.cuts.len(), other.cuts.len());
}

/// Every edge between two clusters is in exactly one cut, from the lower cluster's side, and runs hang together.
fn cuts_are_complete(mesh: &TriMesh, clusters: &Clusters) {
    let mut times = vec![0; 3 * mesh.conn.face_count()];
    for cut in &clusters.cuts {
        assert!(cut.clusters[0] < cut.clusters[1]);
        for &h in &cut.halfedges {
            times[h.index()] += 1;
            let right = mesh.conn.twin(h).map(|t| clusters.of_face[face_of(t)]);
            assert_eq!(clusters.of_face[face_of(h)], Some(cut.clusters[0]));
            assert_eq!(right, Some(Some(cut.clusters[1])));
        }
        for pair in cut.halfedges.windows(2) {
            assert_eq!(mesh.conn.to(pair[0]), mesh.conn.from(pair[1]));
        }
        let ends = [cut.halfedges[0], cut.halfedges[cut.halfedges.len() - 1]];
        if cut.closed {
            assert_eq!(mesh.conn.to(ends[1]), mesh.conn.from(ends[0]));
        }
    }
    for h in mesh.conn.halfedges() {
        let sides = [Some(h), mesh.conn.twin(h)].map(|k| k.and_then(|k| clusters.of_face[face_of(k)]));
        let wanted = matches!(sides, [Some(a), Some(b)] if a < b);
        assert_eq!(times[h.index()], usize::from(wanted), "{h}");
    }
}

#[test]
fn cuts_cover_all_borders_once_seeds_3_to_12() {
    for seed in 3..=12 {
        let mesh = mesh::crumpled(200, seed);
        let clusters = Clusters::grow(&mesh, &mesh::any_vertices(&mesh, 3 + seed as usize, seed));
        cuts_are_complete(&mesh, &clusters);
    }
}

#[test]
fn opposite_landmarks_of_a_torus_share_two_closed_cuts() {
    let mesh = mesh::torus(24, 8);
    let clusters = Clusters::grow(&mesh, &vertices(&[0, 12 * 8]));
    assert_eq!(clusters.linkage(LandmarkId(0), LandmarkId(1)), 2);
    assert!(clusters.cuts.iter().all(|c| c.closed));
    cuts_are_complete(&mesh, &clusters);
}

#[test]
fn two_clusters_around_a_third_share_two_cuts() {
    // A flattened ball with landmarks at both poles and at the long ends of its equator: the poles' clusters meet at the
    // two short ends of the equator. Without one of the long ends they meet all around it.
    let mut mesh = mesh::sphere(13, 24);
    mesh.positions.raw.iter_mut().for_each(|p| *p *= glam::DVec3::new(1.5, 1.0, 0.6));
    let equator = |i: usize| 2 + 6 * 24 + i;
    let one = Clusters::grow(&mesh, &vertices(&[0, 1, equator(0)]));
    assert_eq!(one.linkage(LandmarkId(0), LandmarkId(1)), 1);
    let two = Clusters::grow(&mesh, &vertices(&[0, 1, equator(0), equator(12)]));
    assert_eq!(two.linkage(LandmarkId(1), LandmarkId(0)), 2);
    cuts_are_complete(&mesh, &two);
}

#[test]
fn a_landmark_at_the_tip_of_a_limb_has_one_closed_cut() {
    let mesh = mesh::limb(3.0, 12);
    let clusters = Clusters::grow(&mesh, &vertices(&[0, 1]));
    let [cut] = clusters.cuts.as_slice() else { panic!("{} cuts", clusters.cuts.len()) };
    assert!(cut.closed);
    cuts_are_complete(&mesh, &clusters);
}

#[test]
fn neighbouring_landmarks_each_keep_a_face() {
    // All vertices of an octahedron: every landmark has four faces around it and competes for each with two others.
    let mesh = mesh::octahedron();
    let clusters = Clusters::grow(&mesh, &vertices(&[0, 1, 2, 3, 4, 5]));
    cuts_are_complete(&mesh, &clusters);
    let border: Vec<HalfedgeId> = clusters.cuts.iter().flat_map(|c| c.halfedges.iter().copied()).collect();
    assert!(!border.is_empty());
}
