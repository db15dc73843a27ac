//! The same base complex on both meshes, whatever the meshes and wherever the landmarks.

mod common;

use common::check;
use common::mesh::{self, any_vertices, crowd, vertices};
use common::run::Pair;
use homeo::mesh::{Id, LandmarkId, TriMesh, VertexId};
use homeo::path::cluster::Clusters;
use homeo::shape::{Quadruped, SplitMix, fixture, quadruped, random_landmarks};
use homeo::stage::trace::trace;

/// Lays out and checks every invariant.
fn lay_out(source: (TriMesh, Vec<VertexId>), target: (TriMesh, Vec<VertexId>)) {
    let pair = Pair::new(source, target);
    let layout = pair.layout().unwrap_or_else(|e| panic!("{e}"));
    check::layout(&layout, &pair.meshes);
}

fn spread(mesh: TriMesh, n: usize, seed: u64) -> (TriMesh, Vec<VertexId>) {
    let landmarks = random_landmarks(&mesh, n, seed);
    (mesh, landmarks)
}

fn anywhere(mesh: TriMesh, n: usize, seed: u64) -> (TriMesh, Vec<VertexId>) {
    let landmarks = any_vertices(&mesh, n, seed);
    (mesh, landmarks)
}

fn crowded(mesh: TriMesh, at: usize, n: usize) -> (TriMesh, Vec<VertexId>) {
    let landmarks = crowd(&mesh, VertexId::new(at), n);
    (mesh, landmarks)
}

#[test]
fn spread_landmarks_n_3_to_10_seeds_1_to_8() {
    for seed in 1..=8 {
        let n = 2 + seed as usize;
        lay_out(spread(mesh::sphere(9, 16), n, seed), spread(mesh::crumpled(120, seed), n, seed + 100));
    }
}

#[test]
fn landmarks_anywhere_n_4_to_12_seeds_11_to_19() {
    for seed in 11..=19 {
        let n = seed as usize - 7;
        lay_out(anywhere(mesh::crumpled(60, seed), n, seed), anywhere(mesh::sphere(6, 11), n, seed + 100));
    }
}

#[test]
fn forty_landmarks_seed_21() {
    let mesh = mesh::sphere(15, 24);
    lay_out(spread(mesh.clone(), 40, 21), spread(mesh::jittered(&mesh, 0.03, 21), 40, 21));
}

#[test]
fn quadrupeds_of_different_build() {
    let [a, b] = [Quadruped::Bull, Quadruped::Mule].map(|kind| quadruped(kind, 1500));
    let marks = |s: &homeo::shape::Shape| s.landmarks.iter().map(|l| l.1).collect();
    let (la, lb) = (marks(&a), marks(&b));
    lay_out((a.mesh, la), (b.mesh, lb));
}

#[test]
fn every_vertex_of_an_octahedron() {
    let octahedron = mesh::octahedron();
    lay_out((octahedron.clone(), vertices(&[0, 1, 2, 3, 4, 5])), (octahedron.clone(), vertices(&[0, 1, 2, 3, 4, 5])));
    lay_out((octahedron.clone(), vertices(&[0, 1, 2, 3, 4, 5])), (octahedron.clone(), vertices(&[2, 0, 5, 3, 1, 4])));
    lay_out((octahedron, vertices(&[3, 0, 4, 1, 5, 2])), spread(mesh::sphere(9, 16), 6, 1));
}

#[test]
fn three_and_four_landmarks_on_a_tetrahedron() {
    let all = [[0, 1, 2, 3], [1, 0, 2, 3]];
    for marks in all {
        for n in [3, 4] {
            let (a, b) = (fixture::tetrahedron(), fixture::tetrahedron());
            lay_out((a, vertices(&all[0][..n])), (b, vertices(&marks[..n])));
            lay_out((fixture::tetrahedron(), vertices(&marks[..n])), spread(mesh::crumpled(90, 3), n, 3));
        }
    }
}

#[test]
fn cubes_with_three_to_eight_landmarks_in_any_order_seeds_31_to_36() {
    for seed in 31..=36 {
        let n = seed as usize - 28;
        lay_out(anywhere(fixture::cube(), n, seed), anywhere(fixture::cube(), n, seed + 100));
    }
}

#[test]
fn adjacent_vertices_a_face_and_a_whole_ring() {
    let fine = || mesh::sphere(11, 20);
    for n in [3, 7, 12] {
        lay_out(crowded(fine(), 90, n), crowded(mesh::jittered(&fine(), 0.02, 5), 60, n));
        lay_out(crowded(fine(), 90, n), spread(fine(), n, 41));
    }
    let face = [90, 91, 110];
    lay_out((fine(), vertices(&face)), spread(mesh::crumpled(100, 8), 3, 8));
}

#[test]
fn all_landmarks_on_one_limb() {
    let limb = mesh::limb(2.0, 9);
    let tip = crowd(&limb, VertexId::new(1), 8);
    lay_out((limb.clone(), tip.clone()), spread(mesh::sphere(9, 16), 8, 51));
    lay_out(spread(mesh::sphere(9, 16), 8, 52), (limb, tip));
}

#[test]
fn slivers_and_extremely_uneven_meshes() {
    lay_out(spread(mesh::sphere(2, 60), 9, 61), spread(mesh::sphere(40, 4), 9, 62));
    lay_out(spread(fixture::slivers(3), 7, 63), spread(fixture::uneven(1e4, 24), 7, 64));
}

#[test]
fn relabelled_landmarks_that_force_arcs_to_wind_seeds_71_to_74() {
    for seed in 71..=74 {
        let mesh = mesh::sphere(7, 12);
        let (mesh, landmarks) = spread(mesh, 9, seed);
        let mut shuffled = landmarks.clone();
        let mut random = SplitMix::new(seed);
        for i in (1..shuffled.len()).rev() {
            shuffled.swap(i, random.below(i + 1));
        }
        lay_out((mesh.clone(), landmarks), (mesh, shuffled));
    }
}

#[test]
fn one_thread_and_two_give_the_same_layout() {
    let pair = Pair::new(spread(mesh::sphere(9, 16), 12, 81), spread(mesh::crumpled(200, 81), 12, 82));
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a small pool");
        pool.install(|| pair.layout()).expect("a layout")
    });
    assert_eq!(one.base, two.base);
    assert_eq!(one.way, two.way);
    for (a, b) in one.cuts.iter().zip(&two.cuts) {
        assert_eq!(a.positions, b.positions);
        assert_eq!(
            a.conn.faces().map(|f| a.conn.face(f)).collect::<Vec<_>>(),
            b.conn.faces().map(|f| b.conn.face(f)).collect::<Vec<_>>()
        );
    }
}

#[test]
fn arcs_through_several_cuts_enclose_something_on_either_side() {
    // A flattened ball: the poles' clusters meet twice between two landmarks on the equator, so two arcs join the poles.
    let mut mesh = mesh::sphere(13, 24);
    mesh.positions.raw.iter_mut().for_each(|p| *p *= glam::DVec3::new(1.5, 1.0, 0.6));
    let equator = |i: usize| 2 + 6 * 24 + i;
    let landmarks = vertices(&[0, 1, equator(0), equator(12)]);
    let clusters = Clusters::grow(&mesh, &landmarks);
    let traced = trace(&mesh, &landmarks, &[], &clusters, 3).expect("a layout");
    let poles = [LandmarkId(0), LandmarkId(1)];
    assert_eq!(traced.base.arcs.iter().filter(|ends| **ends == poles).count(), 2);
    assert_eq!(traced.base.patches.len(), 4);
}

#[test]
fn two_landmarks_are_refused_with_a_remedy() {
    let mesh = mesh::sphere(5, 8);
    let pair = Pair::new((mesh.clone(), vertices(&[0, 1])), (mesh, vertices(&[0, 1])));
    let error = pair.layout().expect_err("two landmarks span no triangle");
    assert_eq!(error.kind, homeo::ErrorKind::Unsolvable);
    assert!(error.remedy.contains("three"), "{error}");
}
