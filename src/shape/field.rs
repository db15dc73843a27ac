//! Smooth solids as signed fields: negative inside, positive outside, never steeper than one.
//!
//! Because no field here is steeper than one, a ball whose centre value exceeds its radius misses the surface; the
//! polygoniser skips space by that rule. The round cone is the envelope of spheres whose centres run along a segment
//! while their radii change linearly. The blend is the quadratic smooth minimum: it equals the minimum where the two
//! values differ by more than `blend`, and its gradient is the same mixture of gradients as its value is of values.

use glam::{DMat3, DVec2, DVec3};

/// Newton steps of [`project`]; the fields are nearly distances, so each step gains several digits.
const PROJECTION_STEPS: usize = 4;
/// A projected point may be this far off the surface; Newton's last step is taken from here and squares it.
const ON_SURFACE: f64 = 1e-6;
/// Half the baseline of the finite differences in [`curvature`]; below it rounding shows, above it rims are missed.
const CURVATURE_STEP: f64 = 1e-4;
/// Steps of [`cast`]; sphere tracing from inside stops long before on every solid of this crate.
const CAST_STEPS: usize = 256;
/// [`cast`] has arrived when the field is this close to zero.
const ARRIVED: f64 = 1e-9;

/// A field's value and gradient at a point.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Signed distance or a lower bound of its magnitude.
    pub distance: f64,
    /// Gradient of `distance`; its length is at most one.
    pub gradient: DVec3,
}

/// A solid: the points where the field is negative.
pub type Field<'a> = dyn Fn(DVec3) -> Sample + Sync + 'a;

impl Sample {
    fn complement(self) -> Self {
        Sample { distance: -self.distance, gradient: -self.gradient }
    }

    /// The union with `other`; the seam is filleted over about the length `blend` > 0.
    pub fn union(self, other: Sample, blend: f64) -> Self {
        if other.distance >= self.distance + blend {
            return self;
        }
        let share = (0.5 + 0.5 * (other.distance - self.distance) / blend).clamp(0.0, 1.0);
        Sample {
            distance: other.distance + (self.distance - other.distance) * share - blend * share * (1.0 - share),
            gradient: other.gradient.lerp(self.gradient, share),
        }
    }

    /// What `other` leaves of this solid; the new edge is rounded over about the length `blend` > 0.
    pub fn minus(self, other: Sample, blend: f64) -> Self {
        self.complement().union(other, blend).complement()
    }
}

/// A ball that rolls from `a` to `b` while its radius changes from `ra` to `rb`; `|rb - ra|` is less than `|b - a|`.
pub fn round_cone(p: DVec3, (a, ra): (DVec3, f64), (b, rb): (DVec3, f64)) -> Sample {
    let length = a.distance(b);
    let axis = (b - a) / length;
    let slope = (rb - ra) / length;
    let along = (p - a).dot(axis);
    let across = (p - a - axis * along).length();
    let nearest = (along + slope * across / (1.0 - slope * slope).sqrt()).clamp(0.0, length);
    ball(p, a + axis * nearest, ra + slope * nearest)
}

/// A ball.
pub fn ball(p: DVec3, centre: DVec3, radius: f64) -> Sample {
    let from = p - centre;
    Sample { distance: from.length() - radius, gradient: from.normalize_or(DVec3::Z) }
}

/// A torus around the z axis.
pub fn torus(p: DVec3, major: f64, minor: f64) -> Sample {
    let ring = DVec3::new(p.x, p.y, 0.0).normalize_or(DVec3::X) * major;
    ball(p, ring, minor)
}

/// A cylinder around the z axis between the heights `low` and `high`, with edges rounded to the radius `edge`.
pub fn cylinder(p: DVec3, radius: f64, (low, high): (f64, f64), edge: f64) -> Sample {
    let outward = DVec3::new(p.x, p.y, 0.0).normalize_or(DVec3::X);
    let middle = (low + high) * 0.5;
    let upward = DVec3::Z * (p.z - middle).signum();
    let beyond =
        DVec2::new(DVec2::new(p.x, p.y).length() - radius + edge, (p.z - middle).abs() - (high - low) * 0.5 + edge);
    if beyond.min_element() > 0.0 {
        let way = beyond.normalize();
        return Sample { distance: beyond.length() - edge, gradient: outward * way.x + upward * way.y };
    }
    let gradient = if beyond.x > beyond.y { outward } else { upward };
    Sample { distance: beyond.max_element() - edge, gradient }
}

/// The surface point near `p`, found along the gradient, and the unit normal there.
pub fn project(field: &Field, mut p: DVec3) -> (DVec3, DVec3) {
    let mut normal = DVec3::Z;
    for _ in 0..PROJECTION_STEPS {
        let s = field(p);
        let slope = s.gradient.length();
        if slope > 0.0 {
            normal = s.gradient / slope;
            p -= normal * (s.distance / slope);
        }
        if s.distance.abs() < ON_SURFACE {
            break;
        }
    }
    (p, normal)
}

/// The first surface point of the ray that starts at `p` inside the solid and runs along the unit vector `way`.
pub fn cast(field: &Field, mut p: DVec3, way: DVec3) -> DVec3 {
    for _ in 0..CAST_STEPS {
        let distance = field(p).distance;
        if distance > -ARRIVED {
            break;
        }
        p -= way * distance;
    }
    p
}

/// Root of the summed squared principal curvatures of the level set through `p`.
pub fn curvature(field: &Field, p: DVec3) -> f64 {
    let step = |axis: DVec3| {
        let (ahead, behind) = (field(p + axis * CURVATURE_STEP), field(p - axis * CURVATURE_STEP));
        (ahead.gradient - behind.gradient) / (2.0 * CURVATURE_STEP)
    };
    let hessian = DMat3::from_cols(step(DVec3::X), step(DVec3::Y), step(DVec3::Z));
    [hessian.x_axis, hessian.y_axis, hessian.z_axis].iter().map(|c| c.length_squared()).sum::<f64>().sqrt()
}
