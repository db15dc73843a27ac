//! Lengths, areas, angles and singular values of triangles.

use glam::{DVec2, DVec3};

/// Area of a triangle in space.
pub fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() * 0.5
}

/// Weights of a triangle's corners at a point of the plane; they sum to one, and are not finite without area.
pub fn barycentric([a, b, c]: [DVec2; 3], p: DVec2) -> [f64; 3] {
    let areas = [(b - p).perp_dot(c - p), (c - p).perp_dot(a - p), (a - p).perp_dot(b - p)];
    let sum: f64 = areas.iter().sum();
    areas.map(|x| x / sum)
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

/// Squared distance of a point from a triangle, which may be degenerate.
pub fn distance_sq(p: DVec3, triangle: [DVec3; 3]) -> f64 {
    p.distance_squared(closest_point(p, triangle))
}

/// The point of a triangle, which may be degenerate, nearest to a point.
pub fn closest_point(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let edges = [(a, b), (b, c), (c, a)];
    let faces_inside = edges.iter().all(|&(q, r)| normal.cross(r - q).dot(p - q) >= 0.0);
    if faces_inside && normal != DVec3::ZERO {
        return p - normal * ((p - a).dot(normal) / normal.length_squared());
    }
    let on_edge = |(q, r): (DVec3, DVec3)| {
        let way = r - q;
        let length_sq = way.length_squared();
        let t = if length_sq > 0.0 { ((p - q).dot(way) / length_sq).clamp(0.0, 1.0) } else { 0.0 };
        q + way * t
    };
    let [first, second, third] = edges.map(on_edge);
    let nearer = |x: DVec3, y: DVec3| if p.distance_squared(y) < p.distance_squared(x) { y } else { x };
    nearer(nearer(first, second), third)
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
