//! The generated meshes are what they claim to be: manifold, of the right topology, well shaped, reproducible, and
//! with their landmarks at the right places.

use glam::DVec3;
use homeo::mesh::{TriMesh, VertexId, metric};
use homeo::shape::{
    DEMO_PAIRS, DemoPair, Quadruped, Shape, SplitMix, doughnut, fixture, mug, quadruped, random_landmarks,
};
use std::collections::BTreeSet;

fn components(mesh: &TriMesh) -> usize {
    mesh.conn.components().iter().collect::<BTreeSet<_>>().len()
}

/// Components, genus (of a connected mesh), boundary loops.
fn topology(mesh: &TriMesh) -> (usize, i64, usize) {
    (components(mesh), mesh.genus(), mesh.conn.boundary_loops().len())
}

/// The smallest angle of every face, ascending, in degrees.
fn smallest_angles(mesh: &TriMesh) -> Vec<f64> {
    let smallest = |f| metric::angles(mesh.triangle(f)).into_iter().fold(f64::INFINITY, f64::min).to_degrees();
    let mut all: Vec<f64> = mesh.conn.faces().map(smallest).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Shortest and longest edge.
fn edge_range(mesh: &TriMesh) -> (f64, f64) {
    let length = |h| mesh.positions[mesh.conn.from(h)].distance(mesh.positions[mesh.conn.to(h)]);
    mesh.conn.halfedges().map(length).fold((f64::INFINITY, 0.0), |(low, high), l| (low.min(l), high.max(l)))
}

fn place(shape: &Shape, name: &str) -> DVec3 {
    let (_, v) = shape.landmarks.iter().find(|(n, _)| n == name).unwrap_or_else(|| panic!("no landmark {name}"));
    shape.mesh.positions[*v]
}

fn bytes(shape: &Shape) -> Vec<u64> {
    let positions = shape.mesh.positions.iter().flat_map(|p| p.to_array().map(f64::to_bits));
    let faces = shape.mesh.faces().into_iter().flatten().map(|v| u64::from(v.0));
    positions.chain(faces).chain(shape.landmarks.iter().map(|(_, v)| u64::from(v.0))).collect()
}

/// A shape's own promises: closed, connected, right side out, about the wished size, few thin triangles.
fn check_shape(shape: &Shape, genus: i64, wished: usize) {
    let (name, mesh) = (&shape.name, &shape.mesh);
    assert_eq!(topology(mesh), (1, genus, 0), "{name} with {wished} vertices");
    assert!(mesh.volume() > 0.0, "{name} is inside out");
    let count = mesh.positions.len() as f64 / wished as f64;
    assert!((0.85..1.15).contains(&count), "{name}: {} vertices instead of {wished}", mesh.positions.len());
    let angles = smallest_angles(mesh);
    let thin = angles.iter().take_while(|&&a| a < 5.0).count();
    assert!(thin * 200 <= angles.len(), "{name}: {thin} of {} faces are slivers", angles.len());
    assert!(angles[0] > 0.5, "{name}: smallest angle {}", angles[0]);
    let distinct: BTreeSet<_> = shape.landmarks.iter().map(|(_, v)| *v).collect();
    assert_eq!(distinct.len(), shape.landmarks.len(), "{name}: two landmarks share a vertex");
}

#[test]
fn quadrupeds_are_closed_and_of_genus_zero_at_every_resolution() {
    for wished in [1_000, 2_500, 9_000] {
        check_shape(&quadruped(Quadruped::Bull, wished), 0, wished);
        check_shape(&quadruped(Quadruped::Mule, wished), 0, wished);
    }
}

#[test]
fn mug_and_doughnut_are_closed_and_of_genus_one_at_every_resolution() {
    for wished in [1_000, 2_500, 9_000] {
        check_shape(&mug(wished), 1, wished);
        check_shape(&doughnut(wished), 1, wished);
    }
}

#[test]
fn a_resolution_too_low_for_the_thin_parts_is_raised() {
    for shape in [quadruped(Quadruped::Bull, 3), mug(0)] {
        assert!(shape.mesh.positions.len() > homeo::shape::FEWEST_VERTICES / 2, "{}", shape.name);
        assert_eq!(components(&shape.mesh), 1);
    }
}

#[test]
fn the_shapes_of_a_pair_share_landmark_names_but_not_triangles() {
    for DemoPair { name: pair, genus, generate } in DEMO_PAIRS {
        let (source, target) = generate(1_500);
        let names = |s: &Shape| s.landmarks.iter().map(|(n, _)| n.clone()).collect::<Vec<_>>();
        assert_eq!(names(&source), names(&target), "{pair}");
        assert_eq!((source.mesh.genus(), target.mesh.genus()), (genus, genus), "{pair}");
        assert_ne!(source.mesh.faces(), target.mesh.faces(), "{pair}");
    }
}

#[test]
fn shapes_are_reproducible() {
    let pairs = || DEMO_PAIRS.iter().map(|pair| (pair.generate)(1_000));
    let build = || pairs().flat_map(|(a, b)| [bytes(&a), bytes(&b)]).collect::<Vec<_>>();
    let on = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
    assert!(on(1).install(build) == on(3).install(build));
}

#[test]
fn left_and_right_landmarks_lie_on_their_sides() {
    for kind in [Quadruped::Bull, Quadruped::Mule] {
        let animal = quadruped(kind, 2_500);
        assert_eq!(animal.landmarks.len(), 22);
        for (name, v) in &animal.landmarks {
            let y = animal.mesh.positions[*v].y;
            let right_side = match (name.contains("left"), name.contains("right")) {
                (true, _) => y > 0.05,
                (_, true) => y < -0.05,
                _ => y.abs() < 0.08,
            };
            assert!(right_side, "{name} of {kind:?} at y = {y}");
        }
    }
}

#[test]
fn quadruped_landmarks_are_anatomically_right() {
    for kind in [Quadruped::Bull, Quadruped::Mule] {
        let animal = quadruped(kind, 2_500);
        let x = |name: &str| place(&animal, name).x;
        let z = |name: &str| place(&animal, name).z;
        assert!(animal.mesh.positions.iter().all(|p| p.x <= x("nose") + 0.05), "the nose is foremost");
        assert!(animal.mesh.positions.iter().all(|p| p.x >= x("tail_tip") - 0.15), "the tail is hindmost");
        assert!(animal.mesh.positions.iter().all(|p| p.z > -1e-6), "the soles are lowest");
        for hoof in ["front_left_hoof", "front_right_hoof", "hind_left_hoof", "hind_right_hoof"] {
            assert!(z(hoof).abs() < 0.02, "{hoof} of {kind:?} at z = {}", z(hoof));
        }
        let forwards = ["tail_tip", "croup", "back", "withers", "crown", "nose"].map(x);
        assert!(forwards.windows(2).all(|w| w[0] < w[1]), "{kind:?}: {forwards:?}");
        assert!(x("front_left_hoof") > x("hind_left_hoof") + 0.5 && x("front_right_hoof") > x("hind_right_hoof") + 0.5);
        let across_neck = place(&animal, "nape") - place(&animal, "throat");
        assert!(across_neck.z - across_neck.x > 0.2, "the nape of {kind:?} is above or behind the throat");
        for [high, low] in [["back", "belly"], ["front_left_knee", "front_left_hoof"]] {
            assert!(z(high) > z(low) + 0.1, "{high} of {kind:?} is above {low}");
        }
    }
}

#[test]
fn the_builds_differ_clearly() {
    let (bull, mule) = (quadruped(Quadruped::Bull, 1_500), quadruped(Quadruped::Mule, 1_500));
    let leg = |s: &Shape| place(s, "belly").z / (place(s, "withers").z - place(s, "belly").z);
    let neck = |s: &Shape| (place(s, "crown").z - place(s, "withers").z) / place(s, "withers").z;
    assert!(leg(&mule) > 2.0 * leg(&bull));
    assert!(neck(&mule) > neck(&bull) + 0.3);
    let bulk = |s: &Shape| s.mesh.volume() / s.mesh.area().powf(1.5);
    assert!(bulk(&bull) > 1.3 * bulk(&mule));
}

/// Counted from +x upwards, the landmarks around both shapes' hole come in one cyclic order.
#[test]
fn mug_and_doughnut_landmarks_correspond() {
    for shape in [mug(3_000), doughnut(3_000)] {
        let at = |name: &str| place(&shape, name);
        let centre = (at("handle_inner") + at("hole_wall")) * 0.5;
        let turn = |name: &str| (at(name) - centre).z.atan2((at(name) - centre).x).rem_euclid(std::f64::consts::TAU);
        let around = ["handle_top", "lip_handle", "lip_back", "back", "base", "handle_bottom"].map(turn);
        assert!(around.windows(2).all(|w| w[0] < w[1]), "{}: {around:?}", shape.name);
        let backwards = ["handle_outer", "handle_inner", "hole_wall", "back"].map(|name| at(name).x);
        assert!(backwards.windows(2).all(|w| w[0] > w[1]), "{}: {backwards:?}", shape.name);
        assert!(at("handle_left").y > 0.0 && at("handle_right").y < 0.0);
        assert!(at("lip_left").y > 0.0 && at("lip_right").y < 0.0);
    }
}

#[test]
fn the_mug_is_hollow() {
    let mug = mug(3_000);
    assert!(place(&mug, "cavity_floor").z > place(&mug, "base").z + 0.05);
    assert!(place(&mug, "cavity_floor").z < place(&mug, "lip_left").z - 0.5);
}

#[test]
fn platonic_fixtures_and_spheres_have_genus_zero() {
    for (mesh, vertices) in [(fixture::tetrahedron(), 4), (fixture::octahedron(), 6), (fixture::cube(), 8)] {
        assert_eq!((topology(&mesh), mesh.positions.len()), ((1, 0, 0), vertices));
        assert!(mesh.volume() > 0.0);
    }
    for n in 0..4 {
        let sphere = fixture::icosphere(n);
        assert_eq!((topology(&sphere), sphere.conn.face_count()), ((1, 0, 0), 20 * 4usize.pow(n)));
        assert!(sphere.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-12));
        assert!(sphere.volume() > 0.0);
    }
    let volume = fixture::ellipsoid(DVec3::new(1.0, 2.0, 3.0), 4).volume();
    assert!((volume / (8.0 * std::f64::consts::PI) - 1.0).abs() < 0.01);
}

#[test]
fn fixtures_of_genus_g_have_it() {
    for (n, m) in [(3, 3), (5, 4), (40, 17)] {
        let torus = fixture::torus(n, m);
        assert_eq!((topology(&torus), torus.positions.len()), ((1, 1, 0), (n * m) as usize));
        assert!(torus.volume() > 0.0);
    }
    for g in 0..=3 {
        for vertices in [800, 3_000] {
            let mesh = fixture::genus(g, vertices);
            assert_eq!(topology(&mesh), (1, g as i64, 0), "genus {g} with {vertices} vertices");
            assert!(mesh.volume() > 0.0);
        }
    }
}

#[test]
fn open_fixtures_have_their_boundary_loops() {
    assert_eq!(topology(&fixture::plane(3, 5)), (1, 0, 1));
    assert!((fixture::plane(3, 5).area() - 15.0).abs() < 1e-12);
    for rings in 1..6 {
        let disc = fixture::disc(rings);
        assert_eq!((topology(&disc), disc.conn.face_count()), ((1, 0, 1), 6 * (rings * rings) as usize));
        assert_eq!(disc.conn.boundary_loops()[0].len(), 6 * rings as usize);
    }
    assert!((fixture::disc(40).area() - std::f64::consts::PI).abs() < 0.01);
    assert_eq!(topology(&fixture::annulus(12, 3)), (1, 0, 2));
    for flat in [fixture::plane(2, 2), fixture::disc(5), fixture::annulus(9, 2)] {
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        assert!(flat.conn.faces().all(|f| normal(flat.triangle(f)).z > 0.0), "faces of plane fixtures look up");
    }
    for holes in 0..=12 {
        assert_eq!(topology(&fixture::sphere_with_holes(holes, 2)), (1, 0, holes as usize));
    }
}

#[test]
fn slivers_are_thin_and_leave_the_surface_alone() {
    let slivers = fixture::slivers(3);
    assert_eq!(topology(&slivers), (1, 0, 0));
    let smallest = smallest_angles(&slivers)[0];
    assert!((0.003..0.02).contains(&smallest), "smallest angle {smallest} degrees");
    assert!((slivers.volume() - fixture::icosphere(3).volume()).abs() < 1e-12);
}

#[test]
fn uneven_meshes_have_the_edge_ratio_but_good_angles() {
    for ratio in [1e4, 1e6] {
        let uneven = fixture::uneven(ratio, 12);
        assert_eq!(topology(&uneven), (1, 0, 0));
        assert!(uneven.volume() > 0.0);
        let (shortest, longest) = edge_range(&uneven);
        assert!((0.3..3.0).contains(&(longest / shortest / ratio)), "ratio {}", longest / shortest);
        assert!(smallest_angles(&uneven)[0] > 15.0, "smallest angle {}", smallest_angles(&uneven)[0]);
    }
}

#[test]
fn fixtures_to_be_refused_break_what_they_should() {
    assert_eq!(components(&fixture::two_spheres(1)), 2);
    let (positions, faces) = fixture::moebius(9);
    assert!(TriMesh::new(positions.clone(), &faces).is_err(), "a one-sided band is no oriented manifold");
    assert!(TriMesh::new(positions, &faces[..faces.len() - 2]).is_ok(), "cut open, it is a strip");
}

#[test]
fn a_limb_reaches_as_far_as_asked() {
    for length in [1.0, 4.0] {
        let mesh = fixture::limb(length, 2_000);
        assert_eq!(topology(&mesh), (1, 0, 0));
        let tip = mesh.positions.iter().map(|p| p.x).fold(0.0, f64::max);
        assert!((tip - 1.0 - length).abs() < 0.02, "limb of {length} ends at {tip}");
    }
}

#[test]
fn random_landmarks_are_distinct_spread_and_reproducible() {
    let sphere = fixture::icosphere(4);
    let chosen = random_landmarks(&sphere, 20, 7);
    assert_eq!(chosen, random_landmarks(&sphere, 20, 7));
    assert_ne!(chosen, random_landmarks(&sphere, 20, 8));
    let at = |v: VertexId| sphere.positions[v];
    let gaps = chosen.iter().enumerate().flat_map(|(i, &v)| chosen[..i].iter().map(move |&w| at(v).distance(at(w))));
    assert!(gaps.fold(f64::INFINITY, f64::min) > 0.3, "20 of the sphere's points are spread out");
    let all: BTreeSet<_> = random_landmarks(&fixture::cube(), 100, 1).into_iter().collect();
    assert_eq!(all.len(), 8, "never more landmarks than vertices");
}

#[test]
fn split_mix_matches_its_reference_sequence_for_seed_1234567() {
    let mut random = SplitMix::new(1_234_567);
    let published = [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423];
    assert_eq!(published.map(|_| random.next_bits()), published);
    assert!((0..1_000).all(|_| (0.0..1.0).contains(&random.unit()) && random.below(3) < 3));
}
