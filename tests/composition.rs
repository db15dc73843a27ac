//! The map composed through the base complex.

mod common;

use common::check;
use common::mesh;
use common::run::Pair;
use glam::DVec3;
use homeo::map::surface_map::{Chart, SurfaceMap};
use homeo::mesh::{Id, SurfacePoint, TriMesh, VertexId};
use homeo::shape::random_landmarks;

fn positions(map: &SurfaceMap, onto: &TriMesh) -> Vec<DVec3> {
    map.images.iter().map(|p| p.expect("every vertex has an image").position(onto)).collect()
}

fn spheres(seed: u64) -> Pair {
    let a = mesh::sphere(13, 24);
    let b = mesh::jittered(&mesh::sphere(11, 20), 0.02, seed);
    let [la, lb] = [random_landmarks(&a, 8, seed), random_landmarks(&b, 8, seed)];
    Pair::new((a, la), (b, lb))
}

/// Where paths compete for room the copy's arcs may run a little beside the original's, as with seed 3.
#[test]
fn a_mesh_onto_itself_is_the_identity_seeds_1_to_4() {
    for seed in 1..=4 {
        let mesh = if seed % 2 == 0 { mesh::sphere(11, 20) } else { mesh::crumpled(150, seed) };
        let landmarks = random_landmarks(&mesh, 5 + seed as usize, seed);
        let pair = Pair::new((mesh.clone(), landmarks.clone()), (mesh, landmarks));
        let embedding = pair.embed().expect("an embedding");
        let within = if seed == 3 { 0.01 * pair.meshes[0].diagonal() } else { 1e-9 };
        for from in 0..2 {
            let map = pair.map(&embedding, from).expect("a map");
            for (v, image) in positions(&map, &pair.meshes[0]).into_iter().enumerate() {
                let away = image.distance(pair.meshes[0].positions[VertexId::new(v)]);
                assert!(away < within, "seed {seed}: vertex {v} moved by {away:e}");
            }
        }
    }
}

#[test]
fn images_lie_in_faces_and_landmarks_exactly_on_landmarks() {
    let pair = spheres(5);
    let embedding = pair.embed().expect("an embedding");
    for from in 0..2 {
        let map = pair.map(&embedding, from).expect("a map");
        check::images(&map, &pair.meshes[1 - from]);
        for (&a, &b) in pair.landmarks[from].iter().zip(&pair.landmarks[1 - from]) {
            assert_eq!(map.images[a], Some(SurfacePoint::Vertex(b)));
        }
    }
}

/// Forward by the map, backward by locating the image in the other mesh's embedding: the inverse of the map is the map
/// of the inverse, so the way there and back ends where it began.
#[test]
fn there_and_back_ends_at_the_start_seeds_6_to_8() {
    for seed in 6..=8 {
        let pair = spheres(seed);
        let embedding = pair.embed().expect("an embedding");
        for from in 0..2 {
            let back = Chart::new(&pair.meshes[from], &embedding.meshes[from], &embedding.base);
            let map = pair.map(&embedding, from).expect("a map");
            let places = common::run::places_of_images(&pair, &embedding, 1 - from, &map);
            for (v, place) in places.into_iter().enumerate() {
                let end = back.point(place).expect("an image").position(&pair.meshes[from]);
                let away = end.distance(pair.meshes[from].positions[VertexId::new(v)]);
                assert!(away < 1e-7, "seed {seed}: vertex {v} came back {away:e} away");
            }
        }
    }
}

#[test]
fn one_thread_and_two_give_the_same_map() {
    let pair = spheres(9);
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a small pool");
        pool.install(|| {
            let embedding = pair.embed().expect("an embedding");
            [0, 1].map(|from| pair.map(&embedding, from).expect("a map"))
        })
    });
    assert_eq!(one, two);
}

#[test]
fn unreferenced_vertices_have_no_image() {
    let mut mesh = mesh::sphere(5, 8);
    let n = mesh.positions.len();
    let mut positions = mesh.positions.raw.clone();
    positions.push(DVec3::splat(9.0));
    mesh = TriMesh::new(positions, &mesh.faces()).expect("the same manifold");
    let landmarks = random_landmarks(&mesh, 4, 10);
    let pair = Pair::new((mesh.clone(), landmarks.clone()), (mesh, landmarks));
    let embedding = pair.embed().expect("an embedding");
    let map = pair.map(&embedding, 0).expect("a map");
    assert_eq!(map.images[VertexId::new(n)], None);
    assert!(map.images.raw[..n].iter().all(Option::is_some));
}
