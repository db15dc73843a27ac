//! The mesh check: every fault with its element, repairs that keep the order, and which pairs are refused.

use glam::DVec3;
use homeo::ErrorKind;
use homeo::mesh::check::{Fault, Report, Warning, check};
use homeo::mesh::io::{Landmarks, MeshFile, parse_mesh};
use homeo::mesh::{FaceId, VertexId};
use homeo::stage::check::check as check_pair;
use homeo::stage::load::Loaded;
use proptest::prelude::*;
use std::path::{Path, PathBuf};

type Mesh = (Vec<DVec3>, Vec<[VertexId; 3]>);

fn faces(list: &[[u32; 3]]) -> Vec<[VertexId; 3]> {
    list.iter().map(|f| f.map(VertexId)).collect()
}

/// Outward-facing tetrahedron with its corner at `at`.
fn tetrahedron(at: f64) -> Mesh {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p + DVec3::splat(at));
    (corners.to_vec(), faces(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))
}

/// Two meshes as one.
fn both(a: Mesh, b: Mesh) -> Mesh {
    let shift = a.0.len() as u32;
    let moved = b.1.into_iter().map(|f| f.map(|v| VertexId(v.0 + shift)));
    ([a.0, b.0].concat(), a.1.into_iter().chain(moved).collect())
}

/// A strip of `n` quads around a circle; a half twist makes it a Moebius band.
fn band(n: u32, twisted: bool) -> Mesh {
    let turn = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(n);
    let at = |i: u32, side: f64| {
        let half = if twisted { turn(i) / 2.0 } else { std::f64::consts::FRAC_PI_2 };
        let r = 2.0 + side * half.cos() * 0.5;
        DVec3::new(r * turn(i).cos(), r * turn(i).sin(), side * half.sin() * 0.5)
    };
    let corner = |i: u32, side: u32| 2 * (i % n) + if i == n && twisted { 1 - side } else { side };
    let quad = |i: u32| {
        let [p, q, r, s] = [corner(i, 0), corner(i + 1, 0), corner(i + 1, 1), corner(i, 1)];
        [[p, q, r], [p, r, s]]
    };
    ((0..n).flat_map(|i| [at(i, -1.0), at(i, 1.0)]).collect(), faces(&(0..n).flat_map(quad).collect::<Vec<_>>()))
}

/// A torus of `n` x `n` quads.
fn torus(n: u32) -> Mesh {
    let turn = |i: u32| f64::from(i) * std::f64::consts::TAU / f64::from(n);
    let at = |i: u32, j: u32| {
        let r = 2.0 + turn(j).cos();
        DVec3::new(r * turn(i).cos(), r * turn(i).sin(), turn(j).sin())
    };
    let corner = |i: u32, j: u32| (i % n) * n + j % n;
    let quad = |i: u32, j: u32| {
        let [p, q, r, s] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[p, q, r], [p, r, s]]
    };
    let all = || (0..n).flat_map(move |i| (0..n).map(move |j| (i, j)));
    (all().map(|(i, j)| at(i, j)).collect(), faces(&all().flat_map(|(i, j)| quad(i, j)).collect::<Vec<_>>()))
}

fn report((positions, triangles): &Mesh) -> Report {
    check(positions, triangles)
}

#[test]
fn a_sound_mesh_has_neither_faults_nor_warnings() {
    let mesh = tetrahedron(0.0);
    let mut report = report(&mesh);
    assert_eq!((report.faults.len(), report.warnings.len(), report.flipped.len()), (0, 0, 0));
    assert_eq!((report.genus, report.components.len(), report.is_closed()), (Some(0), 1, true));
    assert!((report.components[0].volume.expect("closed") - 1.0 / 6.0).abs() < 1e-15);
    assert_eq!(report.take_mesh().expect("sound").faces(), mesh.1);
}

#[test]
fn genus_and_boundary_of_known_surfaces() {
    let closed = report(&torus(6));
    assert_eq!((closed.genus, closed.boundary_loops.len()), (Some(1), 0));
    let mut open = torus(6);
    open.1.drain(0..2);
    let open = report(&open);
    assert_eq!((open.genus, open.boundary_loops.len(), open.boundary_loops[0].edges), (Some(1), 1, 4));
    let ring = report(&band(60, false));
    assert_eq!((ring.genus, ring.boundary_loops.len(), ring.is_closed()), (Some(0), 2, false));
    for one in &ring.boundary_loops {
        assert!((one.length - 60.0 * 4.0 * (std::f64::consts::PI / 60.0).sin()).abs() < 1e-12, "{}", one.length);
    }
    let pieces = report(&both(torus(5), both(tetrahedron(9.0), band(5, false))));
    let genera: Vec<_> = pieces.components.iter().map(|c| (c.genus, c.boundary_loops, c.faces)).collect();
    assert_eq!(genera, [(Some(1), 0, 50), (Some(0), 0, 4), (Some(0), 2, 10)]);
    assert_eq!(pieces.genus, Some(1));
}

#[test]
fn corners_out_of_range_and_repeated() {
    let mut mesh = tetrahedron(0.0);
    mesh.1.extend(faces(&[[0, 1, 4], [2, 3, 3], [9, 8, 0]]));
    let (v, f) = (VertexId, FaceId);
    assert_eq!(
        report(&mesh).faults,
        [
            Fault::OutOfRange { face: f(4), vertex: v(4), vertices: 4 },
            Fault::RepeatedVertex { face: f(5), vertex: v(3) },
            Fault::OutOfRange { face: f(6), vertex: v(9), vertices: 4 },
            Fault::OutOfRange { face: f(6), vertex: v(8), vertices: 4 },
        ]
    );
}

#[test]
fn coordinates_that_are_not_finite() {
    let mut mesh = tetrahedron(0.0);
    mesh.0[1].y = f64::NAN;
    mesh.0[3].x = f64::INFINITY;
    let mut report = report(&mesh);
    assert_eq!(report.faults, [1, 3].map(|v| Fault::NotFinite { vertex: VertexId(v) }));
    assert!(report.take_mesh().is_err());
}

#[test]
fn duplicate_faces_are_named_once_whatever_their_rotation() {
    let mut mesh = tetrahedron(0.0);
    mesh.1.extend(faces(&[[3, 0, 1], [1, 2, 0]]));
    let copy = |face, first| Fault::DuplicateFace { face: FaceId(face), first: FaceId(first) };
    assert_eq!(report(&mesh).faults, [copy(4, 1), copy(5, 0)]);
}

#[test]
fn three_faces_at_one_edge() {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Y];
    let mesh = (positions, faces(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]));
    let edge = Fault::NonManifoldEdge { vertices: [VertexId(0), VertexId(1)], faces: [0, 1, 2].map(FaceId).to_vec() };
    assert_eq!(report(&mesh).faults, [edge]);
}

#[test]
fn two_solids_joined_at_one_vertex() {
    let mut mesh = both(tetrahedron(0.0), tetrahedron(-3.0));
    mesh.1.iter_mut().flatten().filter(|v| v.0 == 4).for_each(|v| *v = VertexId(0));
    let report = report(&mesh);
    assert_eq!(report.faults, [Fault::NonManifoldVertex { vertex: VertexId(0), fans: 2 }]);
    assert_eq!(report.components.len(), 2);
    assert_eq!(report.warnings, [Warning::Unreferenced { vertices: vec![VertexId(4)] }]);
}

#[test]
fn a_moebius_band_is_one_sided_and_its_neighbour_still_oriented() {
    let mut second = tetrahedron(9.0);
    second.1[2].swap(1, 2);
    let report = report(&both(band(20, true), second));
    assert!(matches!(report.faults[..], [Fault::NotOrientable { .. }]), "{:?}", report.faults);
    assert_eq!(report.flipped, [FaceId(42)]);
}

#[test]
fn survivable_oddities_are_warnings() {
    let mut mesh = tetrahedron(0.0);
    mesh.0.extend([DVec3::splat(7.0), DVec3::new(0.5, 0.0, 0.0)]); // vertex 4 unused, vertex 5 on the edge 0-1
    mesh.1 = faces(&[[0, 2, 1], [0, 5, 3], [5, 1, 3], [1, 2, 3], [2, 0, 3], [0, 1, 5]]);
    let first = report(&mesh);
    let zero_area = Warning::ZeroArea { faces: vec![FaceId(5)] };
    let unused = Warning::Unreferenced { vertices: vec![VertexId(4)] };
    assert_eq!((first.faults.len(), &first.warnings), (0, &vec![zero_area, unused]));

    let (mut positions, mut triangles) = both(tetrahedron(0.0), tetrahedron(3.0));
    positions[5] = positions[2];
    triangles.iter_mut().for_each(|t| t.swap(1, 2));
    let second = report(&(positions, triangles));
    let doubled = Warning::DuplicatePositions { count: 1, first: [VertexId(2), VertexId(5)] };
    assert_eq!(second.warnings[0], doubled);
    assert!(matches!(second.warnings[1], Warning::InsideOut { component: 0, volume } if volume < 0.0));
    assert!(second.flipped.is_empty(), "an inside-out mesh agrees with itself");
}

#[test]
fn surfaces_without_a_size_are_faults() {
    let (positions, triangles) = tetrahedron(0.0);
    let shaped =
        |change: &dyn Fn(DVec3) -> DVec3| report(&(positions.iter().map(|&p| change(p)).collect(), triangles.clone()));
    let tip = DVec3::new(1.0, 2.0, 3.0);
    for change in [&(|_| tip) as &dyn Fn(DVec3) -> DVec3, &|p| tip * p.x, &|p| p * 1e80, &|p| p * 1e-80] {
        let found = shaped(change);
        assert!(
            matches!(found.faults[..], [Fault::NoArea { component: 0, face: FaceId(0), .. }]),
            "{:?}",
            found.faults
        );
        assert_eq!((found.genus, found.mesh().is_none()), (None, true));
    }
    for size in [1e-60, 1e-8, 1e8, 1e60] {
        assert_eq!(shaped(&|p| p * size).faults, []);
    }
}

#[test]
fn the_error_names_the_first_faults_and_counts_the_rest() {
    let mut mesh = tetrahedron(0.0);
    mesh.1.extend(faces(&[[0, 0, 1], [1, 1, 2], [2, 2, 3], [3, 3, 0], [0, 1, 70]]));
    let mut report = report(&mesh);
    let error = report.take_mesh().expect_err("five faults");
    assert_eq!(error.kind, ErrorKind::Input);
    assert!(error.what.contains("face 4 uses vertex 0 twice") && error.what.ends_with("and 2 more"), "{error}");
    let text = report.to_string();
    assert_eq!(text.lines().filter(|line| line.starts_with("fault: ")).count(), 5, "{text}");
    let json = serde_json::to_value(&report).expect("a report is data");
    assert_eq!(json["faults"][4]["kind"], "out_of_range");
    assert_eq!(json["faults"][4]["vertex"], 70);
}

#[test]
fn no_faces_at_all() {
    assert_eq!(report(&(vec![DVec3::ZERO], Vec::new())).faults, [Fault::NoFaces]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn turned_faces_are_turned_back(turned in prop::collection::btree_set(0usize..72, 0..36)) {
        let sound = torus(6);
        let mut mesh = sound.clone();
        turned.iter().for_each(|&f| mesh.1[f].swap(1, 2));
        let mut report = report(&mesh);
        prop_assert!(report.faults.is_empty());
        prop_assert_eq!(report.flipped.iter().map(|f| f.0 as usize).collect::<Vec<_>>(), turned.into_iter().collect::<Vec<_>>());
        let repaired = report.take_mesh().expect("repairable");
        prop_assert_eq!(repaired.faces(), sound.1);
        prop_assert_eq!(repaired.positions.raw, sound.0);
    }

    #[test]
    fn random_triangles_are_sound_or_explained(list in prop::collection::vec([0u32..7, 0u32..7, 0u32..7], 1..12)) {
        let positions: Vec<DVec3> = (0..6).map(|i| DVec3::new(f64::from(i), f64::from(i * i), f64::from(i % 2))).collect();
        let mut report = check(&positions, &faces(&list));
        let has_faults = !report.faults.is_empty();
        let error = report.take_mesh().err();
        prop_assert_eq!(error.map(|e| e.kind), has_faults.then_some(ErrorKind::Input));
    }
}

fn pair(source: &Mesh, target: &Mesh, landmarks: &[u32]) -> Loaded {
    let file = |name: &str, (positions, triangles): &Mesh| {
        let mut text: String = positions.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
        text.extend(triangles.iter().map(|f| format!("f {} {} {}\n", f[0].0 + 1, f[1].0 + 1, f[2].0 + 1)));
        let path = PathBuf::from(name);
        MeshFile { path, ..parse_mesh(Path::new(name), text.as_bytes()).expect("generated files are well formed") }
    };
    let vertices: Vec<VertexId> = landmarks.iter().map(|&v| VertexId(v)).collect();
    let names = landmarks.iter().map(|v| format!("mark{v}")).collect();
    let landmarks = Landmarks {
        path: PathBuf::from("landmarks.csv"),
        names,
        source: vertices.clone(),
        target: vertices,
        notes: Vec::new(),
    };
    let (source, target) = (file("source.obj", source), file("target.obj", target));
    Loaded { source, target, landmarks: Ok(landmarks), hint: Ok(None) }
}

#[test]
fn a_pair_of_spheres_passes_with_its_warnings() {
    let mut other = tetrahedron(0.0);
    other.1.iter_mut().for_each(|t| t.swap(1, 2));
    let checked = check_pair(pair(&tetrahedron(0.0), &other, &[0, 1, 2])).expect("a valid pair");
    assert_eq!(checked.source.mesh.faces(), checked.source.file.triangles());
    assert!(checked.warnings.iter().any(|w| w.starts_with("target.obj: component 0 is inside out")));
    assert_eq!(checked.target.mesh.faces(), tetrahedron(0.0).1, "faces that look inwards are turned over");
}

#[test]
fn pairs_without_a_map_are_refused_with_both_numbers() {
    let sphere = tetrahedron(0.0);
    let mut open = sphere.clone();
    open.1.pop();
    let two = both(sphere.clone(), tetrahedron(5.0));
    for (target, numbers) in [
        (&torus(5), "genus: 0 in the source, 1 in the target"),
        (&open, "boundary loops: 0 in the source, 1 in the target"),
        (&two, "components: 1 in the source, 2 in the target"),
    ] {
        let error = check_pair(pair(&sphere, target, &[0, 1, 2])).expect_err(numbers);
        assert_eq!(error.kind, ErrorKind::Unsolvable);
        assert!(error.what.contains(numbers) && !error.remedy.is_empty(), "{error}");
    }
    for (mesh, landmarks) in [(&two, 3), (&torus(5), 0), (&sphere, 0)] {
        let checked = check_pair(pair(mesh, mesh, &[0, 1, 2][..landmarks])).map(drop);
        let error = checked.expect_err("landmarks are missing");
        assert_eq!(error.kind, ErrorKind::Unsolvable, "{error}");
    }
}

#[test]
fn broken_meshes_and_floating_landmarks_are_refused_by_name() {
    let sphere = tetrahedron(0.0);
    let mut broken = sphere.clone();
    broken.1.push([0, 1, 1].map(VertexId));
    let error = check_pair(pair(&sphere, &broken, &[0, 1, 2])).expect_err("a repeated corner");
    assert_eq!((error.kind, error.file.as_str()), (ErrorKind::Input, "target.obj"));
    assert!(error.what.contains("face 4 uses vertex 1 twice"), "{error}");

    let mut floating = sphere.clone();
    floating.0.push(DVec3::splat(4.0));
    let error = check_pair(pair(&floating, &floating, &[0, 1, 4])).expect_err("vertex 4 is unused");
    assert_eq!((error.kind, error.file.as_str()), (ErrorKind::Input, "landmarks.csv"));
    assert!(error.what.contains("\"mark4\"") && error.what.contains("source vertex 4"), "{error}");
}
