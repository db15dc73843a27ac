//! The classical pair of genus 1: a mug and a doughnut.
//!
//! Both stand with the hole's axis along y: the mug's handle, and the doughnut's matching part, point to +x; the mug
//! opens upwards (+z).

use super::Shape;
use super::field::{Sample, cylinder, torus};
use super::solid::{Ray, Solid};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, PI};

/// Outer radius of the mug's wall.
const WALL: f64 = 0.5;
/// Radius of the cavity.
const CAVITY: f64 = 0.39;
/// Half the mug's height.
const HALF_HEIGHT: f64 = 0.6;
/// Height of the cavity's floor.
const FLOOR: f64 = -0.46;
/// The handle's ring: distance of its centre from the mug's axis, major and minor radius. The half of it that lies in
/// the cavity goes away with the cavity.
const HANDLE: (f64, f64, f64) = (0.52, 0.36, 0.085);
/// Fillets where the handle meets the wall, and at the lip.
const FILLETS: [f64; 2] = [0.12, 0.06];
/// Major and minor radius of the doughnut.
const DOUGHNUT: (f64, f64) = (0.62, 0.27);
/// Where around the doughnut's ring, counted from +x upwards, the mug's mouth is, in radians; its base is opposite.
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
    let handle = upright_torus(p - DVec3::X * HANDLE.0, HANDLE.1, HANDLE.2);
    let body = cylinder(p, WALL, (-HALF_HEIGHT, HALF_HEIGHT), 0.05);
    let cavity = cylinder(p, CAVITY, (FLOOR, 2.0 * HALF_HEIGHT), 0.08);
    body.union(handle, FILLETS[0]).minus(cavity, FILLETS[1])
}

/// A torus around the y axis.
fn upright_torus(p: DVec3, major: f64, minor: f64) -> Sample {
    let s = torus(DVec3::new(p.z, p.x, p.y), major, minor);
    Sample { distance: s.distance, gradient: DVec3::new(s.gradient.y, s.gradient.z, s.gradient.x) }
}

fn mug_rays() -> Vec<Ray> {
    let rim = (WALL + CAVITY) * 0.5;
    let bottom = DVec3::new(0.0, 0.0, (FLOOR - HALF_HEIGHT) * 0.5);
    let handle = |x: f64, z: f64| DVec3::new(HANDLE.0 + HANDLE.1 * x, 0.0, HANDLE.1 * z);
    [
        ("handle_outer", handle(1.0, 0.0), DVec3::X),
        ("handle_inner", handle(1.0, 0.0), DVec3::NEG_X),
        ("handle_left", handle(1.0, 0.0), DVec3::Y),
        ("handle_right", handle(1.0, 0.0), DVec3::NEG_Y),
        ("handle_top", handle(0.6, 0.8), DVec3::Z),
        ("handle_bottom", handle(0.6, -0.8), DVec3::NEG_Z),
        ("hole_wall", DVec3::X * rim, DVec3::X),
        ("back", DVec3::NEG_X * rim, DVec3::NEG_X),
        ("base", bottom, DVec3::NEG_Z),
        ("cavity_floor", bottom, DVec3::Z),
        ("lip_handle", DVec3::X * rim, DVec3::Z),
        ("lip_back", DVec3::NEG_X * rim, DVec3::Z),
        ("lip_left", DVec3::Y * rim, DVec3::Z),
        ("lip_right", DVec3::NEG_Y * rim, DVec3::Z),
    ]
    .map(|(name, start, way)| (name.to_string(), start, way))
    .to_vec()
}

/// A doughnut with about `resolution` vertices: closed, genus 1, with the mug's landmarks where a mug that is melted
/// into a ring has them.
pub fn doughnut(resolution: usize) -> Shape {
    let field = |p: DVec3| upright_torus(p, DOUGHNUT.0, DOUGHNUT.1);
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
    // The ray that leaves the ring's core at `turn` from +x upwards, leaning by `lean` from outwards to the left.
    let ray = |turn: f64, lean: f64| {
        let out = DVec3::new(turn.cos(), 0.0, turn.sin());
        (out * DOUGHNUT.0, out * lean.cos() + DVec3::Y * lean.sin())
    };
    [
        ("handle_outer", 0.0, 0.0),
        ("handle_inner", 0.0, PI),
        ("handle_left", 0.0, FRAC_PI_2),
        ("handle_right", 0.0, -FRAC_PI_2),
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
