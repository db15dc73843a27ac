//! Whatever the pair: a certified map, Euler's counts, and the same outcome in whatever order the input comes.

mod common;

use common::job::{assert_sound, map};
use homeo::mesh::{Id, SurfacePoint, TriMesh, VertexId, corner};
use homeo::pipeline::Mapped;
use homeo::shape::{PairOptions, RandomPair, SplitMix, random_pair};
use proptest::prelude::*;
use std::ops::RangeInclusive;

/// Genus of the pairs.
const GENUS: RangeInclusive<usize> = 0..=3;
/// Boundary loops of the pairs.
const LOOPS: RangeInclusive<usize> = 0..=3;

prop_compose! {
    fn any_pair()(
        genus in GENUS, loops in LOOPS, landmarks in 3usize..16, vertices in 600usize..900, related: bool, seed: u64,
    ) -> (PairOptions, RandomPair) {
        let options = PairOptions { genus, loops, landmarks, vertices: [vertices, 1400 - vertices], related };
        (options, random_pair(&options, seed))
    }
}

fn run(RandomPair { meshes: [a, b], landmarks: [on_a, on_b] }: &RandomPair) -> Mapped {
    map([a, b], [on_a, on_b]).unwrap_or_else(|e| panic!("{e}"))
}

/// A random order of the numbers below `n`.
fn shuffled(n: usize, random: &mut SplitMix) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    (1..n).rev().for_each(|i| order.swap(i, random.below(i + 1)));
    order
}

/// The same mesh with vertex `v` at number `to[v]`, faces in another order, their corners turned.
fn renumbered(mesh: &TriMesh, to: &[usize], random: &mut SplitMix) -> TriMesh {
    let mut positions = mesh.positions.raw.clone();
    (0..to.len()).for_each(|v| positions[to[v]] = mesh.positions.raw[v]);
    let faces = mesh.faces();
    let order = shuffled(faces.len(), random);
    let face = |f: usize| {
        let mut corners = faces[f].map(|v| VertexId::new(to[v.index()]));
        corners.rotate_left(random.below(3));
        corners
    };
    let faces: Vec<_> = order.into_iter().map(face).collect();
    TriMesh::new(positions, &faces).expect("the same manifold")
}

/// The vertices a point lies between and their weights, by the numbers `name` gives them.
fn named(point: SurfacePoint, mesh: &TriMesh, name: &dyn Fn(VertexId) -> usize) -> Vec<(usize, u64)> {
    let weights = match point {
        SurfacePoint::Vertex(v) => vec![(name(v), 1.0)],
        SurfacePoint::Edge(h, t) => vec![(name(mesh.conn.from(h)), 1.0 - t), (name(mesh.conn.to(h)), t)],
        SurfacePoint::Face(f, b) => (0..3).map(|i| (name(mesh.conn.from(corner(f, i))), b[i])).collect(),
    };
    let mut weights: Vec<_> = weights.into_iter().map(|(v, w): (usize, f64)| (v, (w * 1e9).round() as u64)).collect();
    weights.sort_unstable();
    weights
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, max_shrink_iters: 20, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_pair_gets_a_certified_map((options, pair) in any_pair()) {
        assert_sound(&run(&pair), &format!("{options:?}"));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2, max_shrink_iters: 5, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn order_of_vertices_faces_and_landmarks_does_not_matter((_, pair) in any_pair(), seed: u64) {
        let mut random = SplitMix::new(seed);
        let plain = run(&pair);
        let to = [0, 1].map(|k| shuffled(pair.meshes[k].positions.len(), &mut random));
        let meshes = [0, 1].map(|k| renumbered(&pair.meshes[k], &to[k], &mut random));
        let order = shuffled(pair.landmarks[0].len(), &mut random);
        let landmarks = [0, 1].map(|k| {
            order.iter().map(|&l| VertexId::new(to[k][pair.landmarks[k][l].index()])).collect::<Vec<_>>()
        });
        let other = run(&RandomPair { meshes, landmarks });
        prop_assert_eq!(&plain.relaxation.energies, &other.relaxation.energies);
        for k in 0..2 {
            let onto = [&plain, &other].map(|m| if k == 0 { &m.checked.target.mesh } else { &m.checked.source.mesh });
            for (v, image) in plain.map.maps[k].images.iter_ids() {
                let there = other.map.maps[k].images[VertexId::new(to[k][v.index()])];
                let a = image.map(|p| named(p, onto[0], &|v| to[1 - k][v.index()]));
                let b = there.map(|p| named(p, onto[1], &|v| v.index()));
                prop_assert_eq!(a, b);
            }
        }
    }
}
