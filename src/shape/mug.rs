//! The classical pair of genus 1: a mug and a doughnut.
//!
//! Both stand with the hole's axis along y: the mug's handle, and the doughnut's matching part, point to +x; the mug
//! opens upwards (+z).

use super::Shape;
use super::field::{Sample, cylinder, round_cone, torus};
use super::solid::{Ray, Solid};
use glam::{DQuat, DVec3};

/// Outer radius of the mug's wall.
const WALL: f64 = 0.5;
/// Radius of the cavity.
const CAVITY: f64 = 0.39;
/// Half the mug's height.
const HALF_HEIGHT: f64 = 0.6;
/// Height of the cavity's floor.
const FLOOR: f64 = -0.46;
/// Radius of the handle.
const HANDLE: f64 = 0.085;
/// Half of the handle's arch: x, z, from the middle upwards; the last joint lies inside the wall.
const ARCH: [[f64; 2]; 6] = [[0.90, 0.0], [0.89, 0.12], [0.84, 0.23], [0.75, 0.31], [0.63, 0.35], [0.47, 0.36]];
/// Fillets: along the arch, where the handle meets the wall, and at the mug's lip.
const FILLETS: [f64; 3] = [0.12, 0.12, 0.06];
/// Major and minor radius of the doughnut.
const DOUGHNUT: (f64, f64) = (0.62, 0.27);
/// Where around the doughnut's ring, counted from +x upwards, the mug's mouth and its base are, in radians.
const MOUTH_TURN: f64 = 2.2;

/// A mug with about `resolution` vertices: closed, genus 1, with 14 landmarks.
pub fn mug(resolution: usize) -> Shape {
    let solid = Solid {
        name: "mug",
        field: &mug_field,
        bounds: (DVec3::new(0.25, 0.0, 0.0), 1.05),
        thinnest: 0.05,
        flat: 0.3,
        turn: DQuat::from_scaled_axis(DVec3::new(0.2, 0.4, 0.1)),
    };
    solid.shape(resolution, &mug_rays())
}

fn mug_field(p: DVec3) -> Sample {
    let mirrored = DVec3::new(p.x, p.y, p.z.abs());
    let joint = |k: usize| (DVec3::new(ARCH[k][0], 0.0, ARCH[k][1]), HANDLE);
    let mut handle = round_cone(mirrored, joint(0), joint(1));
    for k in 2..ARCH.len() {
        handle = handle.union(round_cone(mirrored, joint(k - 1), joint(k)), FILLETS[0]);
    }
    if p.z < 0.0 {
        handle.gradient.z = -handle.gradient.z;
    }
    let body = cylinder(p, WALL, (-HALF_HEIGHT, HALF_HEIGHT), 0.05);
    let cavity = cylinder(p, CAVITY, (FLOOR, 2.0 * HALF_HEIGHT), 0.08);
    body.union(handle, FILLETS[1]).minus(cavity, FILLETS[2])
}

fn mug_rays() -> Vec<Ray> {
    let rim = (WALL + CAVITY) * 0.5;
    let handle = DVec3::new(ARCH[0][0], 0.0, 0.0);
    let wall = DVec3::new(rim, 0.0, 0.0);
    let shoulder = DVec3::new(ARCH[3][0], 0.0, ARCH[3][1]);
    let lip = |way: DVec3| way * rim;
    [
        ("handle_outer", handle, DVec3::X),
        ("handle_inner", handle, DVec3::NEG_X),
        ("handle_left", handle, DVec3::Y),
        ("handle_right", handle, DVec3::NEG_Y),
        ("handle_top", shoulder, DVec3::Z),
        ("handle_bottom", shoulder * DVec3::new(1.0, 1.0, -1.0), DVec3::NEG_Z),
        ("hole_wall", wall, DVec3::X),
        ("back", -wall, DVec3::NEG_X),
        ("base", DVec3::new(0.0, 0.0, 0.5 * (FLOOR - HALF_HEIGHT)), DVec3::NEG_Z),
        ("cavity_floor", DVec3::new(0.0, 0.0, 0.5 * (FLOOR - HALF_HEIGHT)), DVec3::Z),
        ("lip_handle", lip(DVec3::X), DVec3::Z),
        ("lip_back", lip(DVec3::NEG_X), DVec3::Z),
        ("lip_left", lip(DVec3::Y), DVec3::Z),
        ("lip_right", lip(DVec3::NEG_Y), DVec3::Z),
    ]
    .map(|(name, start, way)| (name.to_string(), start, way))
    .to_vec()
}

/// A doughnut with about `resolution` vertices: closed, genus 1, with the mug's landmarks where a mug that is melted
/// into a ring has them.
pub fn doughnut(resolution: usize) -> Shape {
    let field = |p: DVec3| {
        let s = torus(DVec3::new(p.z, p.x, p.y), DOUGHNUT.0, DOUGHNUT.1);
        Sample { distance: s.distance, gradient: DVec3::new(s.gradient.y, s.gradient.z, s.gradient.x) }
    };
    let solid = Solid {
        name: "doughnut",
        field: &field,
        bounds: (DVec3::ZERO, DOUGHNUT.0 + DOUGHNUT.1),
        thinnest: 0.1,
        flat: DOUGHNUT.1,
        turn: DQuat::from_scaled_axis(DVec3::new(-0.6, 0.1, 0.3)),
    };
    solid.shape(resolution, &doughnut_rays())
}

fn doughnut_rays() -> Vec<Ray> {
    use std::f64::consts::{FRAC_PI_3, PI};
    // The ray that leaves the ring's core at `turn` from +x upwards, leaning by `lean` from outwards to the left.
    let ray = |turn: f64, lean: f64| {
        let out = DVec3::new(turn.cos(), 0.0, turn.sin());
        (out * DOUGHNUT.0, out * lean.cos() + DVec3::Y * lean.sin())
    };
    [
        ("handle_outer", 0.0, 0.0),
        ("handle_inner", 0.0, PI),
        ("handle_left", 0.0, PI / 2.0),
        ("handle_right", 0.0, -PI / 2.0),
        ("handle_top", FRAC_PI_3, 0.0),
        ("handle_bottom", -FRAC_PI_3, 0.0),
        ("hole_wall", PI, PI),
        ("back", PI, 0.0),
        ("base", -MOUTH_TURN, 0.0),
        ("cavity_floor", MOUTH_TURN, 0.0),
        ("lip_handle", MOUTH_TURN - 0.4, 0.0),
        ("lip_back", MOUTH_TURN + 0.4, 0.0),
        ("lip_left", MOUTH_TURN, 0.9),
        ("lip_right", MOUTH_TURN, -0.9),
    ]
    .map(|(name, turn, lean)| {
        let (start, way) = ray(turn, lean);
        (name.to_string(), start, way)
    })
    .to_vec()
}
