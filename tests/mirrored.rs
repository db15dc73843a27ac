//! Landmarks that ask for a mirrored map are refused; whatever may be meant is not.

use glam::DVec3;
use homeo::ErrorKind;
use homeo::mesh::io::Landmarks;
use homeo::mesh::{TriMesh, VertexId};
use homeo::path::handedness::{Handedness, Verdict};
use homeo::shape::fixture::{ellipsoid, icosphere};
use homeo::shape::{Quadruped, Shape, SplitMix, quadruped, random_landmarks};
use homeo::stage::check::check_landmarks;
use std::path::PathBuf;

fn vertices(shape: &Shape) -> Vec<VertexId> {
    shape.landmarks.iter().map(|&(_, v)| v).collect()
}

/// The vertex that the shape calls by the other side's name.
fn other_side(shape: &Shape, name: &str) -> VertexId {
    let swapped = match (name.contains("left"), name.contains("right")) {
        (true, false) => name.replace("left", "right"),
        (false, true) => name.replace("right", "left"),
        _ => name.to_owned(),
    };
    let found = shape.landmarks.iter().find(|(other, _)| *other == swapped);
    found.map(|&(_, v)| v).expect("sides come in pairs")
}

/// The same shape in a mirror, its faces still counter-clockwise from outside.
fn reflected(mesh: &TriMesh) -> TriMesh {
    let positions = mesh.positions.iter().map(|p| DVec3::new(p.x, -p.y, p.z)).collect();
    let faces: Vec<_> = mesh.faces().into_iter().map(|[a, b, c]| [a, c, b]).collect();
    TriMesh::new(positions, &faces).expect("the mirror image of a manifold")
}

#[test]
fn swapped_sides_are_refused_with_a_hint() {
    let (bull, mule) = (quadruped(Quadruped::Bull, 2000), quadruped(Quadruped::Mule, 1500));
    let names: Vec<String> = bull.landmarks.iter().map(|(name, _)| name.clone()).collect();
    let swapped = names.iter().map(|name| other_side(&mule, name)).collect();
    let landmarks = |target| Landmarks {
        path: PathBuf::from("pairs.csv"),
        names: names.clone(),
        source: vertices(&bull),
        target,
        notes: Vec::new(),
    };
    let meshes = [&bull.mesh, &mule.mesh];
    assert_eq!(check_landmarks(meshes, &landmarks(vertices(&mule))), Ok(None));
    let error = check_landmarks(meshes, &landmarks(swapped)).expect_err("left and right are swapped");
    assert_eq!((error.kind, error.file.as_str()), (ErrorKind::Unsolvable, "pairs.csv"));
    assert!(error.remedy.contains("left and right seem swapped"), "{error}");
}

#[test]
fn a_mesh_in_a_mirror_turns_the_verdict() {
    let (bull, mule) = (quadruped(Quadruped::Bull, 2000), quadruped(Quadruped::Mule, 1500));
    let (from, to) = (vertices(&bull), vertices(&mule));
    let compare = |a: &TriMesh, b: &TriMesh| Handedness::compare([a, b], [&from, &to]);
    let (source, target) = (reflected(&bull.mesh), reflected(&mule.mesh));
    for (a, b, verdict) in [
        (&bull.mesh, &mule.mesh, Verdict::Alike),
        (&source, &target, Verdict::Alike),
        (&source, &mule.mesh, Verdict::Mirrored),
        (&bull.mesh, &target, Verdict::Mirrored),
    ] {
        let seen = compare(a, b);
        assert_eq!(seen.verdict(), verdict, "{seen:?}");
    }
}

#[test]
fn few_landmarks_may_lie_any_way() {
    let sphere = icosphere(2);
    let mirror = reflected(&sphere);
    for count in 1..8 {
        let chosen = random_landmarks(&sphere, count, count as u64);
        let seen = Handedness::compare([&sphere, &mirror], [&chosen, &chosen]);
        assert_ne!(seen.verdict(), Verdict::Mirrored, "{count} landmarks, {seen:?}");
    }
}

#[test]
fn random_landmarks_are_not_refused() {
    let meshes = [icosphere(3), ellipsoid(DVec3::new(3.0, 1.0, 0.7), 3)];
    let mut random = SplitMix::new(7);
    for count in [4, 6, 8, 10, 12, 16, 24, 40] {
        for _ in 0..20 {
            let seed = random.next_bits();
            let [a, b] = [0, 1].map(|k| random_landmarks(&meshes[k], count, seed.rotate_left(13 * k as u32)));
            let seen = Handedness::compare([&meshes[0], &meshes[1]], [&a, &b]);
            assert_ne!(seen.verdict(), Verdict::Mirrored, "{count} landmarks, seed {seed}, {seen:?}");
        }
    }
}
