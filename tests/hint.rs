//! Hints: closed curves that must correspond decide which of the infinitely many classes of maps is made.

mod common;

use common::job::{assert_sound, map_loaded};
use common::mesh::{sphere, vertices};
use homeo::mesh::io::{Hint, HintLoop, Landmarks, MeshFile, parse_hint};
use homeo::mesh::{Id, SurfacePoint, TriMesh, VertexId};
use homeo::pipeline::Mapped;
use homeo::shape::{fixture, random_landmarks};
use homeo::stage::check::{Checked, check};
use homeo::stage::load::Loaded;
use homeo::{Error, ErrorKind, Result};
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// Vertices of the torus around its hole and around its tube.
const N: usize = 40;
const M: usize = 16;

/// The vertex at `i` of [`N`] around the hole and `j` of [`M`] around the tube.
fn at(i: usize, j: usize) -> usize {
    i % N * M + j % M
}

/// Around the tube, at `i` around the hole.
fn meridian(i: usize) -> Vec<usize> {
    (0..M).map(|j| at(i, j)).collect()
}

/// Around the hole and `twist` times around the tube, from (0, `j`) on.
fn longitude(j: usize, twist: usize) -> Vec<usize> {
    (0..N).step_by(2).map(|i| at(i, j + twist * i * M / N)).collect()
}

/// A pair with landmarks a, b, c, ... and loops named by the list.
fn pair(meshes: [&TriMesh; 2], landmarks: &[[usize; 2]], loops: &[(&str, [Vec<usize>; 2])]) -> Loaded {
    let [source, target] = meshes.map(MeshFile::of);
    let [on_source, on_target] = [0, 1].map(|k| landmarks.iter().map(|pair| VertexId::new(pair[k])).collect());
    let names = ('a'..).take(landmarks.len()).map(String::from).collect();
    let one = |(name, lists): &(&str, [Vec<usize>; 2])| HintLoop {
        name: (*name).to_owned(),
        vertices: lists.each_ref().map(|list| vertices(list)),
    };
    let hint = Hint { path: "hint.json".into(), loops: loops.iter().map(one).collect() };
    Loaded {
        source,
        target,
        landmarks: Ok(Landmarks { names, source: on_source, target: on_target, ..Landmarks::default() }),
        hint: Ok((!loops.is_empty()).then_some(hint)),
    }
}

/// How often the image of a closed curve of the source winds around the hole and around the tube of the target.
fn windings(mapped: &Mapped, curve: &[usize]) -> [i64; 2] {
    let target = &mapped.checked.target.mesh;
    let angles = |&v: &usize| {
        let image: SurfacePoint = mapped.map.maps[0].images[VertexId::new(v)].expect("every vertex has an image");
        let p = image.position(target);
        [p.y.atan2(p.x), p.z.atan2(p.x.hypot(p.y) - 1.0)]
    };
    let places: Vec<[f64; 2]> = curve.iter().map(angles).collect();
    [0, 1].map(|k| {
        let step = |i: usize| {
            let turn = places[(i + 1) % places.len()][k] - places[i][k];
            turn - TAU * ((turn + PI) / TAU).floor()
        };
        ((0..places.len()).map(step).sum::<f64>() / TAU).round() as i64
    })
}

/// ```text
///    ______        ______
///   |   |  |      |  /|  |     a torus cut open: the source's longitude is to go to a curve
///   |---+--|  ->  | / | /|     that winds around the tube on its way around the hole
///   |___|__|      |/__|/_|
/// ```
#[test]
fn a_hint_decides_how_often_the_map_twists() {
    let torus = fixture::torus(N as u32, M as u32);
    for twist in [0, 1, 2] {
        let landmarks: Vec<[usize; 2]> = [[5, 3], [15, 9], [25, 2], [33, 12]]
            .iter()
            .map(|&[i, j]| [at(i, j), at(i, j + twist * i * M / N)])
            .collect();
        let loops = [("meridian", [meridian(0), meridian(0)]), ("longitude", [longitude(0, 0), longitude(0, twist)])];
        let mapped = map_loaded(pair([&torus, &torus], &landmarks, &loops)).unwrap_or_else(|e| panic!("{e}"));
        assert_sound(&mapped, &format!("twisted {twist} times"));
        let around_hole: Vec<usize> = (0..N).map(|i| at(i, 4)).collect();
        assert_eq!(windings(&mapped, &around_hole), [1, twist as i64]);
        assert_eq!(windings(&mapped, &meridian(7)), [0, 1]);
        assert!(!mapped.checked.warnings.iter().any(|w| w.contains("winds around")), "{:?}", mapped.checked.warnings);
        assert_eq!(mapped.map.base.landmarks, landmarks.len(), "base vertices on guides are taken out again");
    }
}

/// The torus turned over about a horizontal axis takes both curves to their reverses.
#[test]
fn a_meridian_listed_backwards_turns_the_map_around() {
    let torus = fixture::torus(N as u32, M as u32);
    let landmarks = [[at(4, 3), at(36, 13)], [at(17, 9), at(23, 7)], [at(29, 2), at(11, 14)]];
    let backwards: Vec<usize> = meridian(0).into_iter().rev().collect();
    let loops = [("meridian", [meridian(0), backwards])];
    let mapped = map_loaded(pair([&torus, &torus], &landmarks, &loops)).unwrap_or_else(|e| panic!("{e}"));
    assert_sound(&mapped, "turned around");
    assert_eq!(windings(&mapped, &meridian(7)), [0, -1]);
    let around_hole: Vec<usize> = (0..N).map(|i| at(i, 4)).collect();
    assert_eq!(windings(&mapped, &around_hole)[0], -1);
    let left_open = mapped.checked.warnings.iter().any(|w| w.contains("landmarks and hint leave open"));
    assert!(left_open, "a single loop leaves twists along itself open: {:?}", mapped.checked.warnings);
}

/// On genus 2 a loop between the handles leaves two tori with a hole each.
#[test]
fn a_hint_may_separate() {
    let surface = fixture::genus(2, 900);
    let middle = loop_near(&surface, |p| p.x);
    let landmarks: Vec<[usize; 2]> = random_landmarks(&surface, 6, 3)
        .into_iter()
        .filter(|v| !middle.contains(&v.index()))
        .map(|v| [v.index(); 2])
        .collect();
    let loops = [("waist", [middle.clone(), middle.clone()])];
    let mapped = map_loaded(pair([&surface, &surface], &landmarks, &loops)).unwrap_or_else(|e| panic!("{e}"));
    assert_sound(&mapped, "two halves");
    let side = |p: glam::DVec3| p.x.signum();
    for (v, image) in mapped.map.maps[0].images.iter_ids() {
        let (from, to) = (surface.positions[v], image.expect("all are mapped").position(&surface));
        assert!(side(from) == side(to) || from.x.abs() < 0.2, "{from} goes to {to}");
    }
}

/// Whatever loops there are, the identity follows them, and it is found.
#[test]
fn random_loops_of_a_surface_onto_itself_seeds_1_to_16() {
    let mut laid = 0;
    for seed in 1..=16 {
        let genus = 1 + seed as usize % 2;
        let surface = fixture::genus(genus, 600);
        let landmarks: Vec<[usize; 2]> = random_landmarks(&surface, 4, seed).iter().map(|v| [v.index(); 2]).collect();
        let through = |i: u64| random_landmarks(&surface, 4, 1000 * seed + i).iter().map(|v| v.index()).collect();
        let lists: Vec<Vec<usize>> = (0..2 * genus as u64).map(through).collect();
        let names = ["p", "q", "r", "s"];
        let mut loops: Vec<(&str, [Vec<usize>; 2])> = Vec::new();
        for (name, list) in names.into_iter().zip(lists) {
            // Loops through one vertex, so that some meet; those that cannot be laid beside the others are left out.
            let list: Vec<usize> = std::iter::once(17).chain(list).collect();
            loops.push((name, [list.clone(), list]));
            if check(pair([&surface, &surface], &landmarks, &loops)).is_err() {
                loops.pop();
            }
        }
        let name = format!("seed {seed} with {} loops", loops.len());
        let mapped =
            map_loaded(pair([&surface, &surface], &landmarks, &loops)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_sound(&mapped, &name);
        let energy = mapped.relaxation.energies.last().copied().unwrap_or(f64::INFINITY);
        assert!(energy < 1.1, "{name}: {energy}");
        laid += loops.len();
    }
    assert!(laid >= 16, "only {laid} loops were laid");
}

/// The vertices of `mesh` nearest to the plane where `height` is zero, in order of their angle in that plane (y, z).
fn loop_near(mesh: &TriMesh, height: impl Fn(glam::DVec3) -> f64) -> Vec<usize> {
    let angle = |v: usize| {
        let p = mesh.positions[VertexId::new(v)];
        p.z.atan2(p.y)
    };
    (0..8)
        .filter_map(|k| {
            let wanted = -PI + TAU * (f64::from(k) + 0.5) / 8.0;
            let off = |v: &usize| height(mesh.positions[VertexId::new(*v)]).abs() + 0.2 * (angle(*v) - wanted).abs();
            (0..mesh.positions.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
        })
        .collect()
}

/// Checks a pair of tori.
fn checked(landmarks: &[[usize; 2]], loops: &[(&str, [Vec<usize>; 2])]) -> Result<Checked> {
    let torus = fixture::torus(N as u32, M as u32);
    check(pair([&torus, &torus], landmarks, loops))
}

#[track_caller]
fn refused(result: Result<Checked>, kind: ErrorKind, what: &str) -> Error {
    let error = result.expect_err(what);
    assert_eq!(error.kind, kind, "{error}");
    assert!(error.what.contains(what), "{error}\nlacks: {what}");
    assert!(!error.remedy.is_empty() && error.file == "hint.json", "{error}");
    error
}

const THREE: [[usize; 2]; 3] = [[3 * M + 3; 2], [13 * M + 9; 2], [27 * M + 5; 2]];

#[test]
fn loops_that_do_not_correspond_are_refused_by_name() {
    let around = [meridian(0), meridian(0)];
    let backwards: Vec<usize> = longitude(0, 0).into_iter().rev().collect();
    let crossed = [("m", around.clone()), ("l", [longitude(0, 0), backwards])];
    refused(checked(&THREE, &crossed), ErrorKind::Unsolvable, "loop \"m\" and loop \"l\" meet another way round");

    let apart = [("m", around.clone()), ("n", [meridian(10), vec![at(9, 9), at(11, 9), at(10, 10)]])];
    let error = refused(checked(&THREE, &apart), ErrorKind::Unsolvable, "the source has genus 0");
    assert!(error.what.contains("loop \"n\"") || error.what.contains("loop \"m\""), "{error}");

    let beyond = [("m", around.clone()), ("n", [meridian(10), meridian(20)])];
    refused(checked(&THREE, &beyond), ErrorKind::Unsolvable, "landmarks");

    let on_one = [("m", [meridian(3), meridian(4)])];
    let error = refused(checked(&THREE, &on_one), ErrorKind::Unsolvable, "landmark \"a\" lies on loop \"m\"");
    assert!(error.what.contains("on the source but beside it on the target"), "{error}");

    let once = [("m", around), ("l", [longitude(0, 0), vec![at(5, 5), at(7, 5), at(6, 7)]])];
    refused(checked(&THREE, &once), ErrorKind::Unsolvable, "meet at 1 vertices of the source but at 0 of the target");
}

#[test]
fn landmarks_on_a_loop_must_come_in_one_order() {
    let on = [[at(0, 1); 2], [at(0, 6); 2], [at(0, 11); 2], [at(20, 3); 2]];
    let same = [("m", [meridian(0), meridian(0)])];
    assert!(checked(&on, &same).is_ok());
    let backwards = [("m", [meridian(0), meridian(0).into_iter().rev().collect()])];
    refused(checked(&on, &backwards), ErrorKind::Unsolvable, "in the opposite order");
    let mut four = on;
    four[3] = [at(0, 13), at(0, 8)];
    refused(checked(&four, &same), ErrorKind::Unsolvable, "in another order");
}

#[test]
fn loops_that_cannot_be_laid_are_refused_by_name() {
    let both = |list: Vec<usize>| [list.clone(), list];
    let along = [("m", both(meridian(0))), ("n", both(vec![at(0, 3), at(0, 4), at(1, 4)]))];
    let error = refused(checked(&THREE, &along), ErrorKind::Input, "loop \"m\" and loop \"n\" run along one edge");
    assert_eq!(error.element, "from vertex 3 to vertex 4");

    // Between two meridians there is no way from one side to the other.
    let walled =
        [("m", both(meridian(0))), ("n", both(meridian(10))), ("p", both(vec![at(5, 0), at(15, 0), at(25, 0)]))];
    let error = refused(checked(&THREE, &walled), ErrorKind::Input, "loop \"p\" finds no way on the source");
    assert_eq!(error.element, format!("from vertex {} to vertex {}", at(5, 0), at(15, 0)));

    let twice = [
        ("m", both(vec![at(0, 0), at(4, 4), at(8, 0), at(4, 12)])),
        ("n", both(vec![at(4, 4), at(9, 8), at(4, 12), at(16, 8)])),
    ];
    refused(checked(&THREE, &twice), ErrorKind::Input, "meet at 2 vertices that are no landmarks");

    let disc = fixture::disc(5);
    let rim = disc.conn.from(disc.conn.boundary_loops()[0][0]).index();
    let landmarks = [[0; 2], [1; 2], [2; 2]];
    let touching = pair([&disc, &disc], &landmarks, &[("m", both(vec![7, 12, rim]))]);
    refused(check(touching), ErrorKind::Input, "which lies on the boundary");
}

/// A loop around the north pole on the source and around the south pole on the target, but a landmark at either.
#[test]
fn a_loop_around_another_landmark_is_refused() {
    let ball = sphere(9, 12);
    let circle = |k: usize| (0..12).map(|i| 2 + 12 * k + i).collect::<Vec<usize>>();
    let landmarks = [[0, 0], [1, 1], [2 + 12 * 4; 2]];
    let around = pair([&ball, &ball], &landmarks, &[("circle", [circle(1), circle(7)])]);
    let error = refused(check(around), ErrorKind::Unsolvable, "of loop \"circle\" the source has genus 0");
    assert!(error.what.contains("landmarks \"a\"") || error.what.contains("landmarks \"b\""), "{error}");
    let alike = pair([&ball, &ball], &landmarks, &[("circle", [circle(1), circle(2)])]);
    assert_sound(&map_loaded(alike).unwrap_or_else(|e| panic!("{e}")), "a circle of latitude");
}

/// Loops may meet more than once where landmarks tell which meeting is which.
///
/// ```text
///     __x__
///    /  |  \__     a circle with a landmark at its right, inside a loop that cuts across the circle
///   |   |  x  |
///    \__x__/--
/// ```
#[test]
fn loops_on_an_open_surface_with_two_meetings() {
    let disc = fixture::disc(8);
    let near = |radius: f64, turns: f64| {
        let p = glam::DVec3::new(radius * (TAU * turns).cos(), radius * (TAU * turns).sin(), 0.0);
        let off = |v: &VertexId| (disc.positions[*v] - p).truncate().length();
        disc.conn.vertices().min_by(|a, b| off(a).total_cmp(&off(b))).expect("a disc has vertices").index()
    };
    let circle: Vec<usize> = (0..6).map(|k| near(0.6, f64::from(k) / 6.0)).collect();
    let across = vec![circle[1], circle[5], near(0.85, 0.0)];
    let loops = [("circle", [circle.clone(), circle.clone()]), ("across", [across.clone(), across])];
    let landmarks = [near(0.0, 0.0), circle[0], circle[1], circle[5]].map(|v| [v; 2]);
    let mapped = map_loaded(pair([&disc, &disc], &landmarks, &loops)).unwrap_or_else(|e| panic!("{e}"));
    assert_sound(&mapped, "two loops on a disc");
    let energy = mapped.relaxation.energies.last().copied();
    assert!(energy.is_some_and(|e| e < 1.1), "the identity follows them: {energy:?}");
}

#[test]
fn files_are_read_strictly() {
    let torus = MeshFile::of(&fixture::torus(4, 3));
    let parse = |text: &str| parse_hint(Path::new("hint.json"), text.as_bytes(), [&torus, &torus]);
    let hint = parse(
        r#"{"loops": [{"source": [0, 1, 2], "target": [3, 4, 5]}, {"name": "x", "source": [0, 3, 6], "target": [0, 3, 9]}]}"#,
    );
    let hint = hint.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(hint.loops.iter().map(|l| l.name.as_str()).collect::<Vec<_>>(), ["1", "x"]);
    assert_eq!(hint.loops[1].vertices, [vertices(&[0, 3, 6]), vertices(&[0, 3, 9])]);
    for (text, what, element) in [
        ("", "not valid JSON", "line 1, column 0"),
        ("[]", "no list of loops", ""),
        (r#"{"loops": []}"#, "no list of loops", ""),
        (
            r#"{"loops": [{"name": "h", "source": [0, 1, 2]}]}"#,
            "a loop without a list of vertices",
            "loop \"h\", target",
        ),
        (r#"{"loops": [{"source": [0, 1], "target": [0, 1, 2]}]}"#, "a loop of 2 vertices", "loop \"1\", source"),
        (r#"{"loops": [{"source": [0, 1, 0], "target": [0, 1, 2]}]}"#, "vertex 0 stands twice", "loop \"1\", source"),
        (
            r#"{"loops": [{"source": [0, 1, 12], "target": [0, 1, 2]}]}"#,
            "12 is no vertex of the source",
            "loop \"1\", source",
        ),
        (r#"{"loops": [{"source": [0, 1, -1], "target": [0, 1, 2]}]}"#, "-1 is no vertex", "loop \"1\", source"),
        (
            r#"{"loops": [{"name": "h", "source": [0, 1, 2], "target": [0, 1, 2]}, {"name": "h", "source": [0, 1, 2]}]}"#,
            "two loops are called \"h\"",
            "",
        ),
    ] {
        let error = parse(text).expect_err(text);
        assert_eq!((error.kind, error.file.as_str()), (ErrorKind::Input, "hint.json"), "{error}");
        assert!(error.what.contains(what) && error.element == element && !error.remedy.is_empty(), "{text}: {error}");
    }
}
