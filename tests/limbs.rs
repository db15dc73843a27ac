//! Limbs without a landmark: their tips are found on both meshes and matched.

mod common;

use common::mesh;
use homeo::mesh::{TriMesh, VertexId};
use homeo::path::extremity::matching_tips;
use homeo::shape::{Quadruped, Shape, SplitMix, nudge_landmarks, quadruped, random_landmarks};

/// A tip lies so near to the landmark at the end of its limb, in units of the root of the area; the ears' reach 0.2
/// from every other landmark.
const NEAR: f64 = 0.06;

/// Builds that differ in the length of everything.
fn quadrupeds() -> [Shape; 2] {
    [quadruped(Quadruped::Bull, 5000), quadruped(Quadruped::Mule, 4000)]
}

/// The landmarks but for some.
fn without(shape: &Shape, names: &[&str]) -> Vec<VertexId> {
    shape.landmarks.iter().filter(|(name, _)| !names.contains(&name.as_str())).map(|&(_, v)| v).collect()
}

/// The landmark near which a vertex lies.
fn limb(shape: &Shape, v: VertexId) -> &str {
    let at = |v: VertexId| shape.mesh.positions[v];
    let near = |&&(_, l): &&(String, VertexId)| at(l).distance(at(v)) < NEAR * shape.mesh.area().sqrt();
    shape.landmarks.iter().find(near).map_or("nowhere", |(name, _)| name)
}

/// Where the matching tips lie, sorted by name; both of a pair must lie at the same landmark.
fn matched<'a>(shapes: &'a [Shape; 2], landmarks: &[Vec<VertexId>; 2]) -> Vec<&'a str> {
    let meshes: [&TriMesh; 2] = [&shapes[0].mesh, &shapes[1].mesh];
    let pairs = matching_tips(meshes, landmarks.each_ref().map(Vec::as_slice));
    let mut limbs: Vec<&str> = pairs
        .iter()
        .map(|&[a, b]| {
            let ends = [limb(&shapes[0], a), limb(&shapes[1], b)];
            assert_eq!(ends[0], ends[1], "{a} was matched with {b}");
            ends[0]
        })
        .collect();
    limbs.sort_unstable();
    limbs
}

const UNMARKED: [&str; 3] = ["left_ear_tip", "right_ear_tip", "tail_tip"];

#[test]
fn left_and_right_ears_and_the_tail_are_told_apart() {
    let shapes = quadrupeds();
    let landmarks = shapes.each_ref().map(|shape| without(shape, &UNMARKED));
    assert_eq!(matched(&shapes, &landmarks), UNMARKED);
}

#[test]
fn what_is_found_does_not_hang_on_where_exactly_landmarks_lie() {
    let shapes = quadrupeds();
    let landmarks = shapes.each_ref().map(|shape| without(shape, &UNMARKED));
    for seed in 0..8 {
        let mut random = SplitMix::new(seed);
        let mut moved = landmarks.clone();
        for (shape, landmarks) in shapes.iter().zip(&mut moved) {
            nudge_landmarks(&shape.mesh, landmarks, &mut random);
        }
        assert_eq!(matched(&shapes, &moved), UNMARKED, "seed {seed}");
    }
}

/// The far side of a sphere is far from all landmarks on the near one, and found again at once on the same sphere, but no
/// place there is better than the next.
#[test]
fn a_wide_empty_place_is_no_limb() {
    let sphere = mesh::sphere(24, 48);
    let all = random_landmarks(&sphere, 40, 1);
    let near: Vec<VertexId> = all.into_iter().filter(|&v| sphere.positions[v].z > 0.0).collect();
    assert!(near.len() >= 8, "fewer are not looked at");
    assert!(matching_tips([&sphere, &sphere], [&near, &near]).is_empty());
}
