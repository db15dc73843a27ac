//! Limbs without a landmark: their tips are found on both meshes and matched.

use homeo::mesh::{TriMesh, VertexId};
use homeo::path::extremity::matching_tips;
use homeo::shape::{Quadruped, Shape, SplitMix, quadruped};

/// A tip lies so near to the landmark at the end of its limb, in units of the root of the area; ears are 0.3 long.
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
        for (k, shape) in shapes.iter().enumerate() {
            for i in 0..moved[k].len() {
                let around: Vec<VertexId> =
                    shape.mesh.conn.outgoing(moved[k][i]).map(|h| shape.mesh.conn.to(h)).collect();
                let to = around[random.below(around.len())];
                if !moved[k].contains(&to) {
                    moved[k][i] = to;
                }
            }
        }
        assert_eq!(matched(&shapes, &moved), UNMARKED, "seed {seed}");
    }
}

#[test]
fn flanks_and_backs_are_no_limbs() {
    let shapes = quadrupeds();
    let trunk = ["withers", "back", "croup", "chest", "belly", "nape", "throat"];
    let landmarks = shapes.each_ref().map(|shape| without(shape, &trunk));
    assert!(matched(&shapes, &landmarks).is_empty(), "nothing but limbs' ends is so far from everything");
}

#[test]
fn limbs_with_a_landmark_get_no_other() {
    let shapes = quadrupeds();
    let landmarks = shapes.each_ref().map(|shape| without(shape, &[]));
    assert!(matched(&shapes, &landmarks).is_empty());
}
