//! Lengths, areas, angles and singular values of triangles.

use glam::{DVec2, DVec3};

/// Area of a triangle in space.
pub fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() * 0.5
}

/// Signed area of a triangle in the plane, positive counter-clockwise.
pub fn signed_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a) * 0.5
}

/// Interior angles of a triangle in corner order, radians; zero-length sides give zero.
pub fn angles(t: [DVec3; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (u, w) = (t[(i + 1) % 3] - t[i], t[(i + 2) % 3] - t[i]);
        u.cross(w).length().atan2(u.dot(w))
    })
}

/// Lays a triangle into the plane: first corner at the origin, second on the positive x axis, third above it.
pub fn flatten([a, b, c]: [DVec3; 3]) -> [DVec2; 3] {
    let (u, w) = (b - a, c - a);
    let length = u.length();
    if length == 0.0 {
        return [DVec2::ZERO, DVec2::ZERO, DVec2::new(0.0, w.length())];
    }
    [DVec2::ZERO, DVec2::new(length, 0.0), DVec2::new(u.dot(w) / length, u.cross(w).length() / length)]
}

/// Largest and smallest singular value of the affine map that takes triangle `from` to triangle `to`.
///
/// A degenerate `from` gives infinities or NaN; callers leave such triangles out.
pub fn singular_values(from: [DVec3; 3], to: [DVec3; 3]) -> (f64, f64) {
    let [_, p, q] = flatten(from);
    let x = (to[1] - to[0]) / p.x;
    let y = (to[2] - to[0] - x * q.x) / q.y;
    let (a, b, c) = (x.dot(x), x.dot(y), y.dot(y));
    let large = ((a + c + ((a - c) * (a - c) + 4.0 * b * b).sqrt()) * 0.5).sqrt();
    (large, x.cross(y).length() / large.max(f64::MIN_POSITIVE))
}
