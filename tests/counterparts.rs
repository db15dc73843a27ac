//! What two meshes must have in common: components and boundary loops that correspond through their landmarks.

use homeo::mesh::io::{Landmarks, MeshFile};
use homeo::mesh::{Id, TriMesh, VertexId};
use homeo::shape::fixture::{annulus, disc, plane, two_spheres};
use homeo::stage::check::{Checked, check};
use homeo::stage::load::Loaded;
use homeo::{Error, ErrorKind, Result};

/// Checks a pair whose landmarks are named a, b, c, ...
fn checked(source: &TriMesh, target: &TriMesh, landmarks: &[[usize; 2]]) -> Result<Checked> {
    let names = ('a'..).take(landmarks.len()).map(String::from).collect();
    let [on_source, on_target] = [0, 1].map(|k| landmarks.iter().map(|pair| VertexId::new(pair[k])).collect());
    check(Loaded {
        source: MeshFile::of(source),
        target: MeshFile::of(target),
        landmarks: Ok(Landmarks { names, source: on_source, target: on_target, ..Landmarks::default() }),
        hint: Ok(None),
    })
}

fn refusal(source: &TriMesh, target: &TriMesh, landmarks: &[[usize; 2]]) -> Error {
    let error = checked(source, target, landmarks).expect_err("no such map");
    assert_eq!(error.kind, ErrorKind::Unsolvable, "{error}");
    assert!(!error.remedy.is_empty(), "{error}");
    error
}

#[track_caller]
fn says(error: Error, what: &str) {
    assert!(error.what.contains(what), "{error}\nlacks: {what}");
}

/// The number of a vertex of `annulus(n, m)`: `i` around, `j` outwards, 0 the inner loop.
fn ring(m: usize, i: usize, j: usize) -> usize {
    i * (m + 1) + j
}

#[test]
fn a_component_without_landmarks_is_named() {
    let two = two_spheres(1);
    let error = refusal(&two, &two, &[[0, 0], [1, 1], [2, 2]]);
    assert!(error.element.contains("80 faces from face 80"), "{error}");
    says(error, "component 1 of the source has no landmark");
}

#[test]
fn landmarks_that_link_one_component_to_two_are_named() {
    let (two, n) = (two_spheres(1), two_spheres(1).positions.len() / 2);
    let error = refusal(&two, &two, &[[0, 0], [1, 1], [2, n + 2], [n, n]]);
    says(error, "landmarks \"a\" and \"c\" lie on one component of the source but on two of the target");
    let error = refusal(&two, &two, &[[0, 0], [n + 1, 1], [n, n]]);
    says(error, "landmarks \"b\" and \"c\" lie on one component of the source but on two of the target");
}

#[test]
fn components_may_stand_in_another_order() {
    let (two, n) = (two_spheres(1), two_spheres(1).positions.len() / 2);
    let crossed: Vec<[usize; 2]> = (0..6).map(|i| [i % 2 * n + i, (1 - i % 2) * n + i]).collect();
    assert!(checked(&two, &two, &crossed).is_ok());
}

#[test]
fn components_of_different_kind_are_refused() {
    let error = refusal(&disc(2), &annulus(6, 2), &[[0, ring(2, 0, 1)]]);
    says(error, "different numbers of boundary loops: 1 in the source, 2 in the target");
}

#[test]
fn a_landmark_on_one_boundary_and_deep_inside_the_other_mesh_is_named() {
    let (a, b) = (plane(8, 8), plane(8, 8));
    let error = refusal(&a, &b, &[[4, 40]]);
    assert!(error.element.contains("source vertex 4, target vertex 40"), "{error}");
    says(error, "landmark \"a\" lies on the boundary of the source but inside the target");
    says(refusal(&a, &b, &[[40, 4]]), "landmark \"a\" lies on the boundary of the target but inside the source");
}

///   0---1---2---        a face between vertex 10 and the boundary edge 1-0 (or 1-2) goes
///   | / | / |
///   9--10--11---
#[test]
fn a_landmark_just_inside_gets_the_boundary_by_leaving_faces_out() {
    let (a, b) = (plane(8, 8), plane(8, 8));
    let checked = checked(&a, &b, &[[4, 13], [40, 40]]).expect("one row inside");
    assert!(checked.source.omitted.is_empty());
    let omitted = &checked.target.omitted;
    assert!((1..=3).contains(&omitted.len()), "{omitted:?}");
    let mesh = &checked.target.mesh;
    assert_eq!(mesh.conn.face_count() + omitted.len(), b.conn.face_count());
    assert!(mesh.conn.is_on_boundary(VertexId(13)));
    assert_eq!((mesh.conn.boundary_loops().len(), mesh.conn.euler_characteristic()), (1, 1));
    assert!(mesh.conn.vertices().all(|v| mesh.conn.leaving(v).is_some()), "no vertex is lost");
    let told = checked.warnings.iter().any(|w| w.contains("landmark \"a\"") && w.contains("left out of the map"));
    assert!(told, "{:?}", checked.warnings);
}

#[test]
fn loops_must_carry_the_same_landmarks_in_the_same_order() {
    let ring_of = |i: usize, j: usize| ring(2, i, j);
    let a = annulus(9, 2);
    let both_outside = [[ring_of(0, 2), ring_of(0, 2)], [ring_of(3, 2), ring_of(3, 0)]];
    says(
        refusal(&a, &a, &both_outside),
        "\"a\" and \"b\" lie on one boundary loop of the source but on two of the target",
    );
    let d = disc(3);
    let rim = |k: usize| 19 + k;
    let order = [[rim(0), rim(0)], [rim(4), rim(8)], [rim(8), rim(4)], [rim(12), rim(12)]];
    says(
        refusal(&d, &d, &order),
        "the cyclic order of landmarks \"a\", \"b\", \"c\", \"d\" along their boundary loop is another",
    );
    let mirrored = [[rim(0), rim(0)], [rim(4), rim(14)], [rim(8), rim(10)], [rim(12), rim(6)]];
    let error = refusal(&d, &d, &mirrored);
    assert!(error.remedy.contains("swapped"), "{error}");
    says(error, "runs backwards on the target");
}

#[test]
fn open_pieces_need_one_landmark() {
    assert!(checked(&disc(2), &disc(3), &[[0, 0]]).is_ok());
    says(refusal(&disc(2), &disc(3), &[]), "there are no landmarks");
}
