//! Meshes and landmarks that break careless programs: every one is mapped, with its certificate.

mod common;

use common::job::{assert_sound, map, map_loaded};
use common::mesh::crowd;
use glam::DVec3;
use homeo::ErrorKind;
use homeo::mesh::{FaceId, Id, TriMesh, VertexId};
use homeo::shape::fixture::{ellipsoid, icosphere, needles, octahedron, slivers, studded, tetrahedron, uneven};
use homeo::shape::random_landmarks;
use homeo::stage::load::Loaded;

/// Maps and checks; returns the energy at the end.
fn energy(name: &str, meshes: [&TriMesh; 2], landmarks: [&[VertexId]; 2]) -> f64 {
    let mapped = map(meshes, landmarks).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_sound(&mapped, name);
    *mapped.relaxation.energies.last().expect("the start is measured")
}

fn egg() -> TriMesh {
    ellipsoid(DVec3::new(2.0, 1.0, 0.7), 2)
}

fn placed(mesh: &TriMesh, scale: f64, offset: f64) -> TriMesh {
    let mut mesh = mesh.clone();
    mesh.positions.raw.iter_mut().for_each(|p| *p = *p * scale + DVec3::splat(offset));
    mesh
}

/// The vertex nearest to a point.
fn nearest(mesh: &TriMesh, p: DVec3) -> VertexId {
    let distance = |&v: &VertexId| mesh.positions[v].distance_squared(p);
    mesh.conn.vertices().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("there are vertices")
}

#[test]
fn slivers_of_a_hundredth_of_a_degree() {
    let (hard, soft) = (slivers(2), icosphere(2)); // the first vertices of both are the same
    let shared = random_landmarks(&soft, 10, 1);
    assert!(energy("slivers to sphere", [&hard, &soft], [&shared, &shared]) < 1.2);
    let any = random_landmarks(&hard, 12, 2);
    assert!(energy("slivers to slivers", [&hard, &hard], [&any, &any]) < 1.01);
}

#[test]
fn edges_a_million_times_longer_than_others() {
    let (hard, soft) = (uneven(1e6, 8), icosphere(2));
    let poles = [0, hard.positions.len() - 1, 1, 4].map(VertexId::new);
    let images = poles.map(|v| nearest(&soft, hard.positions[v]));
    assert!(energy("uneven to sphere", [&hard, &soft], [&poles, &images]) < 1.2);
    let any = random_landmarks(&hard, 8, 3);
    assert!(energy("uneven to uneven", [&hard, &hard], [&any, &any]) < 1.01);
}

#[test]
fn edges_without_length_and_vertices_at_one_position() {
    let (round, long) = (icosphere(2), egg());
    let shared = random_landmarks(&round, 10, 4);
    for t in [0.0, 1e-12, 1e-6] {
        energy(&format!("needles {t}"), [&needles(&round, 40, t), &needles(&long, 60, t)], [&shared, &shared]);
    }
    let hard = needles(&round, 40, 0.0);
    let last = hard.positions.len() - 1;
    let doubled = [last, last - 2, last - 4].map(VertexId::new);
    let twins = doubled.map(|v| nearest(&round, hard.positions[v]));
    let both = [doubled, twins].concat();
    energy("landmarks at one position", [&hard, &hard], [&both, &both]);
}

/// The relaxation stops when a round lowers the energy, less that of an isometry, by less than a fifth; rounding decides
/// how much less, so that energies of one pair at different scales agree to a small part of that only.
const STOPPED: f64 = 0.01;

#[test]
fn any_scale_and_place() {
    let (round, long) = (icosphere(2), egg());
    let landmarks = random_landmarks(&round, 8, 5);
    let plain = energy("plain", [&round, &long], [&landmarks, &landmarks]);
    for (scale, offset, tolerance) in [(1e8, 0.0, STOPPED), (1e-8, 0.0, STOPPED), (1.0, 1e8, 0.02), (1e-8, 1.0, 0.02)] {
        let moved = [&placed(&round, scale, offset), &placed(&long, scale, offset)];
        let there = energy(&format!("scale {scale}, offset {offset}"), moved, [&landmarks, &landmarks]);
        assert!((there / plain - 1.0).abs() < tolerance, "scale {scale}, offset {offset}: {there} instead of {plain}");
    }
    let mixed = [&placed(&round, 1e8, 1e8), &placed(&long, 1e-8, 0.0)];
    let there = energy("large to small", mixed, [&landmarks, &landmarks]);
    assert!((there / plain - 1.0).abs() < STOPPED, "{there} instead of {plain}");
}

#[test]
fn landmarks_side_by_side() {
    let (round, long) = (icosphere(2), egg());
    for n in [3, 4, 5, 7, 20] {
        let close = crowd(&round, VertexId(40), n);
        energy(&format!("{n} in a crowd to a crowd"), [&round, &long], [&close, &crowd(&long, VertexId(0), n)]);
        energy(&format!("{n} in a crowd, apart"), [&round, &long], [&close, &random_landmarks(&long, n, 6)]);
    }
    let (on_source, on_target) = (round.face(FaceId(17)), long.face(FaceId(3)));
    energy("the corners of a triangle", [&round, &long], [&on_source, &on_target]);
    let [a, b, c] = on_target;
    energy("the corners the other way round", [&round, &long], [&on_source, &[a, c, b]]);
    energy(
        "both ends of an edge",
        [&round, &long],
        [&[on_source[0], on_source[1], VertexId(99)], &[a, b, VertexId(7)]],
    );
}

#[test]
fn many_landmarks_and_nothing_but_landmarks() {
    let (round, long) = (icosphere(2), egg());
    for n in [100, round.positions.len()] {
        let landmarks = random_landmarks(&round, n, 7);
        energy(&format!("{n} landmarks"), [&round, &long], [&landmarks, &landmarks]);
    }
    let scattered = [random_landmarks(&round, 20, 8), random_landmarks(&long, 20, 9)];
    energy("20 unrelated landmarks", [&round, &long], [&scattered[0], &scattered[1]]);
    for mesh in [tetrahedron(), octahedron()] {
        let all: Vec<_> = mesh.conn.vertices().collect();
        assert!(energy("every vertex", [&mesh, &mesh], [&all, &all]) < 1.0 + 1e-9);
        energy("a coarse mesh to a fine one", [&mesh, &round], [&all, &random_landmarks(&round, all.len(), 1)]);
        let turned = [&all[1..], &all[..1]].concat();
        energy("every vertex to the next", [&mesh, &mesh], [&all, &turned]);
    }
}

#[test]
fn landmarks_of_valence_three() {
    let (round, long) = (studded(&icosphere(2), 15), studded(&egg(), 15));
    let studs: Vec<_> = round.conn.vertices().rev().take(15).collect();
    energy("stud to stud", [&round, &long], [&studs, &studs]);
    energy("stud to anywhere", [&round, &long], [&studs, &random_landmarks(&long, 15, 2)]);
}

#[test]
fn vertices_that_no_face_uses_keep_their_place() {
    let round = icosphere(2);
    let loose = DVec3::splat(1e9);
    let positions = [&[loose, -loose], round.positions.raw.as_slice(), &[loose]].concat();
    let faces: Vec<_> = round.faces().into_iter().map(|f| f.map(|v| VertexId(v.0 + 2))).collect();
    let padded = TriMesh::new(positions, &faces).expect("the same manifold");
    let landmarks = random_landmarks(&round, 6, 3);
    let moved: Vec<_> = landmarks.iter().map(|v| VertexId(v.0 + 2)).collect();
    let mapped = map([&padded, &egg()], [&moved, &landmarks]).expect("loose vertices do not matter");
    assert_sound(&mapped, "padded");
    let lost = mapped.map.maps[0].images.iter_ids().filter(|(_, image)| image.is_none()).map(|(v, _)| v.index());
    assert_eq!(lost.collect::<Vec<_>>(), [0, 1, padded.positions.len() - 1]);
}

#[test]
fn an_inside_out_mesh_is_mapped_as_if_it_were_not() {
    let (round, long) = (icosphere(2), egg());
    let landmarks = random_landmarks(&round, 9, 4);
    let mut inverted = Loaded::of([&round, &long], [&landmarks, &landmarks]);
    inverted.target.corners.chunks_mut(3).for_each(|face| face.swap(1, 2));
    let mapped = map_loaded(inverted).expect("turned over");
    assert_sound(&mapped, "inside out");
    let plain = energy("plain", [&round, &long], [&landmarks, &landmarks]);
    assert_eq!(mapped.relaxation.energies.last(), Some(&plain));
}

#[test]
fn a_surface_without_area_is_refused() {
    let (round, point) = (icosphere(2), placed(&icosphere(2), 0.0, 1.0));
    let landmarks = random_landmarks(&round, 5, 5);
    let error = map([&round, &point], [&landmarks, &landmarks]).expect_err("a mesh at one point");
    assert_eq!(error.kind, ErrorKind::Input, "{error}");
    assert!(error.what.contains("component 0, from face 0 on, has the area 0"), "{error}");
}
