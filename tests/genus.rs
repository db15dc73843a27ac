//! Closed surfaces with handles, and few landmarks: always a layout, always a certified map.

mod common;

use common::run::Pair;
use common::{check, mesh};
use homeo::gpu::Compute;
use homeo::mesh::{ArcId, FaceId, Id, IdVec, LandmarkId};
use homeo::mesh::{TriMesh, VertexId};
use homeo::path::base_complex::DirectedArc;
use homeo::path::cluster::Clusters;
use homeo::path::curve::closed_curves;
use homeo::path::cut_mesh::CutMesh;
use homeo::path::handle::lay_across_handle;
use homeo::path::network::Corner;
use homeo::path::region::Regions;
use homeo::path::search::Searcher;
use homeo::path::side::Explorer;
use homeo::path::subcomplex::{Role, Subcomplex};
use homeo::shape::{SplitMix, fixture, random_landmarks};
use homeo::stage::check::Guides;
use homeo::stage::cluster::cluster;
use homeo::stage::embed::embed;
use homeo::stage::joint::grow;
use homeo::stage::layout::layouts;
use homeo::stage::relax::{RelaxOptions, energy, relax_arcs};
use homeo::stage::trace::trace;

fn spread(mesh: TriMesh, n: usize, seed: u64) -> (TriMesh, Vec<VertexId>) {
    let landmarks = random_landmarks(&mesh, n, seed);
    (mesh, landmarks)
}

/// Lays out, embeds and checks every invariant.
fn map(source: (TriMesh, Vec<VertexId>), target: (TriMesh, Vec<VertexId>)) {
    let pair = Pair::new(source, target);
    let layout = pair.layout().unwrap_or_else(|e| panic!("{e}"));
    check::layout(&layout, &pair.meshes);
    let embedded = pair.embed().unwrap_or_else(|e| panic!("{e}"));
    check::embedding(&embedded, &pair.meshes);
}

#[test]
fn genus_1_with_1_to_9_landmarks_seeds_1_to_6() {
    for (seed, n) in (1..=6).zip([1, 2, 3, 4, 6, 9]) {
        map(spread(fixture::torus(20, 10), n, seed), spread(fixture::genus(1, 300), n, seed + 100));
    }
}

#[test]
fn genus_2_with_1_to_8_landmarks_seeds_11_to_14() {
    for (seed, n) in (11..=14).zip([1, 2, 5, 8]) {
        map(spread(fixture::genus(2, 500), n, seed), spread(fixture::genus(2, 400), n, seed + 100));
    }
}

#[test]
fn genus_3_with_1_to_10_landmarks_seeds_21_to_23() {
    for (seed, n) in (21..=23).zip([1, 4, 10]) {
        map(spread(fixture::genus(3, 700), n, seed), spread(fixture::genus(3, 600), n, seed + 100));
    }
}

/// A torus of 3 by 3 quads: every vertex a landmark, no edge free of them.
#[test]
fn all_vertices_of_the_smallest_torus_in_any_order_seeds_31_to_34() {
    for seed in 31..=34 {
        let mut random = SplitMix::new(seed);
        let mut shuffled: Vec<VertexId> = (0..9).map(VertexId::new).collect();
        let all = shuffled.clone();
        for i in (1..9).rev() {
            shuffled.swap(i, random.below(i + 1));
        }
        map((fixture::torus(3, 3), all), (fixture::torus(3, 3), shuffled));
    }
}

#[test]
fn a_torus_onto_itself_is_the_identity() {
    for n in [1, 2, 5] {
        let pair = Pair::new(spread(fixture::torus(24, 12), n, 5), spread(fixture::torus(24, 12), n, 5));
        let embedded = pair.embed().expect("an embedding");
        let meshes = [&pair.meshes[0], &pair.meshes[1]];
        assert!(energy(meshes, &embedded) < 1.05, "{n} landmarks: {}", energy(meshes, &embedded));
    }
}

/// ```text
///      ___________
///     /   _____   \        one landmark, far from the hole: the arc goes there and back
///  x-----(_____)   |
///     \___________/
/// ```
#[test]
fn an_arc_to_a_far_handle_and_back_meets_itself_nowhere() {
    let mesh = fixture::genus(1, 600);
    for start in [0, 100, 200, 300] {
        let mut cut = CutMesh::new(&mesh, &[VertexId::new(start)], 1);
        let corner = [Corner { landmark: LandmarkId(0), after: None }];
        let mut searcher = Searcher::default();
        let laid = lay_across_handle(&mut cut, &mesh, &mut searcher, [&corner, &corner], ArcId(0)).expect("a handle");
        check::cut_mesh(&cut, &mesh);
        let length: f64 = cut.arc_lengths(&IdVec::from_raw(vec![laid.ends]))[ArcId(0)];
        assert!((length - laid.length).abs() < 1e-9 * length, "{length} for {}", laid.length);
        let regions = Regions::find(&cut);
        assert_eq!((regions.genus.as_slice(), regions.walks[0].len()), ([0].as_slice(), 2));
        assert_eq!(Explorer::default().smaller_side(&cut, ArcId(0), LandmarkId(0)), None);
    }
}

#[test]
fn there_are_twice_as_many_closed_curves_as_handles() {
    for (mesh, genus) in [(mesh::sphere(5, 8), 0), (fixture::torus(8, 5), 1), (fixture::genus(3, 500), 3)] {
        let cut = CutMesh::new(&mesh, &[VertexId(0)], 1);
        assert_eq!(closed_curves(&cut, FaceId(0)).len(), 2 * genus);
    }
}

#[test]
fn roles_told_from_the_complex_are_those_on_the_mesh_seeds_41_to_44() {
    for seed in 41..=44 {
        let (mesh, landmarks) = spread(fixture::genus(2, 400), 4, seed);
        let clusters = Clusters::grow(&mesh, &landmarks);
        let traced = trace(&mesh, &landmarks, &[], &clusters, 1).expect("a layout");
        let base = &traced.base;
        assert_eq!((base.arcs.len(), base.patches.len()), (18, 12));
        // Taken off in reverse, every arc has the role that it would have if it were put back.
        let mut cut = traced.cut.clone();
        for last in base.arcs.ids().rev() {
            let mut present = Subcomplex::bare(base);
            base.arcs.ids().filter(|&a| a < last).for_each(|a| present.add(a));
            let separates = Explorer::default().smaller_side(&cut, last, base.arcs[last][0]);
            match present.role(last) {
                Role::Separates => {
                    let (hand, side) = separates.unwrap_or_else(|| panic!("{last} separates"));
                    assert_eq!(present.side(last, hand), side, "{last}");
                }
                Role::OpensHandle | Role::Joins => assert_eq!(separates, None, "{last}"),
            }
            let walks = |cut: &CutMesh| Regions::find(cut).walks.concat().len() as i64;
            let isolated = |cut: &CutMesh| Regions::find(cut).isolated.concat().len() as i64;
            let before = walks(&cut) + isolated(&cut);
            cut.unmark(last, base.arcs[last][0]);
            let change = walks(&cut) + isolated(&cut) - before;
            assert_eq!(change, if present.role(last) == Role::Joins { 1 } else { -1 }, "{last}");
        }
    }
}

#[test]
fn a_layout_grown_on_both_meshes_is_one_complex_seeds_51_to_54() {
    for seed in 51..=54 {
        let n = seed as usize - 46;
        for (source, target) in [
            (mesh::sphere(9, 16), mesh::crumpled(120, seed)),
            (fixture::torus(18, 9), fixture::genus(1, 300)),
            (fixture::genus(2, 400), fixture::genus(2, 500)),
        ] {
            let landmarks = [random_landmarks(&source, n, seed), random_landmarks(&target, n, seed + 1)];
            let clusters = [Clusters::grow(&source, &landmarks[0]), Clusters::grow(&target, &landmarks[1])];
            for lead in 0..2 {
                let slices = [landmarks[0].as_slice(), &landmarks[1]];
                let grown = grow([&source, &target], slices, &clusters, 1, lead).expect("a layout");
                for (cut, mesh) in grown.cuts.iter().zip([&source, &target]) {
                    check::cut_mesh(cut, mesh);
                    check::arcs(cut, &grown.base);
                    let read = homeo::path::region::base_complex(cut, &grown.base.arcs).expect("triangles");
                    assert_eq!(read, grown.base);
                }
            }
        }
    }
}

/// What the main job does with few landmarks: auxiliary vertices lead the arcs, and stay only where they must.
#[test]
fn one_or_two_landmarks_are_enough_for_shapes_in_like_poses() {
    let half_axes = glam::DVec3::new(1.5, 1.0, 0.7);
    let ball = || fixture::ellipsoid(half_axes, 3);
    let bent = || mesh::jittered(&ball(), 0.01, 3);
    for (source, target, n, fewest) in [
        (ball(), bent(), 1, 3),
        (ball(), bent(), 2, 3),
        (fixture::torus(24, 12), fixture::torus(30, 14), 1, 1),
        (fixture::genus(2, 500), fixture::genus(2, 700), 1, 1),
    ] {
        let landmarks = random_landmarks(&source, n, 7);
        let nearest = |&v: &VertexId| {
            let apart = |w: &VertexId| target.positions[*w].distance(source.positions[v]);
            target.conn.vertices().min_by(|a, b| apart(a).total_cmp(&apart(b))).expect("a mesh has vertices")
        };
        let partners: Vec<VertexId> = landmarks.iter().map(nearest).collect();
        let meshes = [&source, &target];
        let sets = cluster(meshes, [&landmarks, &partners], &Guides::default());
        let layout = layouts(meshes, &sets, 3, 1).expect("a layout").swap_remove(0);
        assert_eq!(layout.base.landmarks, fewest, "base vertices");
        let (mut embedded, _) = embed(meshes, layout).expect("an embedding");
        relax_arcs(&Compute::Cpu, meshes, &mut embedded, &RelaxOptions::default()).expect("a relaxed map");
        assert!(energy(meshes, &embedded) < 1.3, "{n} landmarks: energy {}", energy(meshes, &embedded));
        check::embedding(&embedded, &[source, target]);
    }
}

#[test]
fn renamed_landmarks_and_renumbered_vertices_are_mapped_as_well_seeds_61_to_63() {
    for seed in 61..=63 {
        let (mesh, landmarks) = spread(fixture::genus(1, 300), 5, seed);
        let mut random = SplitMix::new(seed);
        let mut order: Vec<usize> = (0..mesh.positions.len()).collect();
        for i in (1..order.len()).rev() {
            order.swap(i, random.below(i + 1));
        }
        let number: Vec<VertexId> = {
            let mut number = vec![VertexId(0); order.len()];
            order.iter().enumerate().for_each(|(new, &old)| number[old] = VertexId::new(new));
            number
        };
        let positions = order.iter().map(|&old| mesh.positions[VertexId::new(old)]).collect();
        let faces: Vec<[VertexId; 3]> = mesh.faces().into_iter().map(|f| f.map(|v| number[v.index()])).collect();
        let renumbered = TriMesh::new(positions, &faces).expect("the same manifold");
        let mut marks: Vec<VertexId> = landmarks.iter().map(|v| number[v.index()]).collect();
        map((mesh.clone(), landmarks.clone()), (renumbered.clone(), marks.clone()));
        marks.rotate_left(2);
        map((mesh, landmarks), (renumbered, marks));
    }
}

#[test]
fn corners_of_a_complete_complex_are_those_on_the_mesh_seed_71() {
    let (mesh, landmarks) = spread(fixture::genus(1, 300), 3, 71);
    let clusters = Clusters::grow(&mesh, &landmarks);
    let traced = trace(&mesh, &landmarks, &[], &clusters, 1).expect("a layout");
    let complete = Subcomplex::complete(&traced.base);
    for l in traced.cut.landmarks.ids() {
        let around = homeo::path::network::rotation(&traced.cut, l, &|_| true);
        for (i, &end) in around.iter().enumerate() {
            let before: DirectedArc = around[(i + around.len() - 1) % around.len()];
            assert_eq!(complete.neighbour(end), before);
        }
    }
}
