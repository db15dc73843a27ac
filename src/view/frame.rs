//! How a mesh is held up to the viewer: upright, facing the front, as large as the others.
//!
//! Source of the alignment: B. K. P. Horn, "Closed-form solution of absolute orientation using unit quaternions" (1987).

use glam::{DMat3, DMat4, DQuat, DVec3, DVec4};

/// Height of the slab at an object's foot, as a share of its height: less misses uneven feet, more takes bellies for them.
const FOOT: f64 = 0.05;
/// Files mostly have y up. It is z if the footprint along it, as a share of the ground plan, is so large and so many times that
/// along y; less lets animals whose length is along z stand on their tails.
const STABLE: f64 = 0.25;
const CLEARLY: f64 = 2.0;
/// Or if the mesh reaches so many times as far along z, and would not stand along y.
const TALL: f64 = 2.5;
/// Below this angle, in radians, meshes stand alike as they are; above it the second one is turned to face like the first.
const ALIKE: f64 = 0.45;
/// Sweeps of Jacobi's method; four-by-four matrices are diagonal to rounding after far fewer.
const SWEEPS: usize = 16;

/// A similarity from a mesh's space to the viewer's: x to the right, y up, z towards the viewer, all within the unit ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewFrame {
    turn: DMat3,
    centre: DVec3,
    scale: f64,
}

impl ViewFrame {
    /// A frame for a mesh that stands on its feet, as far as they can be told.
    pub fn upright(points: &[DVec3]) -> Self {
        let turn = match up_of(points) {
            Up::Y => DMat3::IDENTITY,
            Up::Z => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        };
        ViewFrame::turned(turn, points)
    }

    /// A frame for a second mesh, so that points of it face like the corresponding points of the first one.
    ///
    /// Meshes that face alike within some degrees as they stand are left so.
    pub fn alike(points: &[DVec3], first: &ViewFrame, pairs: &[[DVec3; 2]]) -> Self {
        let own = ViewFrame::upright(points);
        let in_view: Vec<[DVec3; 2]> = pairs.iter().map(|&[p, q]| [own.place(q), first.place(p)]).collect();
        let turn = rotation(&in_view);
        if turn.w.abs().min(1.0).acos() * 2.0 < ALIKE {
            return own;
        }
        ViewFrame::turned(DMat3::from_quat(turn) * own.turn, points)
    }

    /// A frame in which a direction leads to the viewer, and another one upwards as far as it can.
    pub fn towards(front: DVec3, up: DVec3, points: &[DVec3]) -> Self {
        let z = front.normalize_or(DVec3::Z);
        let x = up.cross(z).normalize_or(z.any_orthonormal_vector());
        ViewFrame::turned(DMat3::from_cols(x, z.cross(x), z).transpose(), points)
    }

    fn turned(turn: DMat3, points: &[DVec3]) -> Self {
        let finite = || points.iter().filter(|p| p.is_finite()).map(|&p| turn * p);
        let (low, high) = finite().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        let middle = if low.x <= high.x { (low + high) * 0.5 } else { DVec3::ZERO };
        let radius = finite().map(|p| p.distance(middle)).fold(0.0, f64::max);
        let scale = if radius > 0.0 { radius.recip() } else { 1.0 };
        ViewFrame { turn, centre: turn.transpose() * middle, scale }
    }

    /// A point of the mesh's space in the viewer's.
    pub fn place(&self, p: DVec3) -> DVec3 {
        self.turn * (p - self.centre) * self.scale
    }
}

enum Up {
    Y,
    Z,
}

/// The direction that a mesh stands up in: y, unless it stands far better along z.
fn up_of(points: &[DVec3]) -> Up {
    let finite = || points.iter().filter(|p| p.is_finite());
    let (low, high) = finite().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let extent = high - low;
    let footprint = |axis: usize| {
        let feet = finite().filter(|p| p[axis] <= low[axis] + FOOT * extent[axis]);
        let (l, h) = feet.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
        (0..3).filter(|&k| k != axis).map(|k| (h[k] - l[k]) / extent[k].max(f64::MIN_POSITIVE)).product::<f64>()
    };
    let (on_y, on_z) = (footprint(1), footprint(2));
    let stands_on_z = on_z > STABLE && on_z > CLEARLY * on_y;
    let is_pole = extent.z > TALL * extent.y && on_y < STABLE;
    if stands_on_z || is_pole { Up::Z } else { Up::Y }
}

/// The rotation that takes the first points of the pairs nearest to the second ones, in the sense of least squares.
fn rotation(pairs: &[[DVec3; 2]]) -> DQuat {
    let count = pairs.len().max(1) as f64;
    let mean = |k: usize| pairs.iter().map(|p| p[k]).sum::<DVec3>() / count;
    let means = [mean(0), mean(1)];
    let mut s = [[0.0; 3]; 3];
    for pair in pairs {
        let [p, q] = [pair[0] - means[0], pair[1] - means[1]];
        (0..9).for_each(|k| s[k / 3][k % 3] += p[k / 3] * q[k % 3]);
    }
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = s;
    let rows = [
        DVec4::new(xx + yy + zz, yz - zy, zx - xz, xy - yx),
        DVec4::new(yz - zy, xx - yy - zz, xy + yx, zx + xz),
        DVec4::new(zx - xz, xy + yx, yy - xx - zz, yz + zy),
        DVec4::new(xy - yx, zx + xz, yz + zy, zz - xx - yy),
    ];
    let [w, x, y, z] = largest_eigenvector(DMat4::from_cols(rows[0], rows[1], rows[2], rows[3])).to_array();
    DQuat::from_xyzw(x, y, z, w).normalize()
}

/// Of a symmetric matrix, by Jacobi's rotations.
fn largest_eigenvector(mut m: DMat4) -> DVec4 {
    let mut vectors = DMat4::IDENTITY;
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let off = m.col(p)[q];
            if off == 0.0 {
                continue;
            }
            let angle = 0.5 * (2.0 * off).atan2(m.col(q)[q] - m.col(p)[p]);
            let (sin, cos) = angle.sin_cos();
            let mut turn = DMat4::IDENTITY;
            turn.col_mut(p)[p] = cos;
            turn.col_mut(q)[q] = cos;
            turn.col_mut(q)[p] = sin;
            turn.col_mut(p)[q] = -sin;
            m = turn.transpose() * m * turn;
            vectors *= turn;
        }
    }
    let best = (0..4).max_by(|&i, &j| m.col(i)[i].total_cmp(&m.col(j)[j])).unwrap_or(0);
    vectors.col(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table on four legs, `up` its direction: plates and feet as points.
    fn table(up: impl Fn(DVec3) -> DVec3) -> Vec<DVec3> {
        let grid = |n: i32| (-n..=n).flat_map(move |i| (-n..=n).map(move |j| (f64::from(i), f64::from(j))));
        let plate = grid(4).map(|(x, z)| DVec3::new(x, 5.0, z * 1.6));
        let legs = (0..=20).flat_map(|k| {
            [(-3.5, -6.0), (3.5, -6.0), (-3.5, 6.0), (3.5, 6.0)].map(|(x, z)| DVec3::new(x, f64::from(k) * 0.25, z))
        });
        let head = (0..6).map(|k| DVec3::new(0.0, 5.5, 7.0 + f64::from(k) * 0.3));
        plate.chain(legs).chain(head).map(up).collect()
    }

    #[test]
    fn things_stand_on_their_feet() {
        let y_up = table(|p| p);
        let z_up = table(|p| DVec3::new(p.x, -p.z, p.y));
        let heights = |points: &[DVec3]| {
            let frame = ViewFrame::upright(points);
            points.iter().map(|&p| frame.place(p).y).collect::<Vec<_>>()
        };
        let (a, b) = (heights(&y_up), heights(&z_up));
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(y_up.iter().all(|&p| ViewFrame::upright(&y_up).place(p).length() < 1.0 + 1e-12));
    }

    #[test]
    fn a_turned_copy_is_turned_back() {
        let points = table(|p| p);
        let turn = DQuat::from_axis_angle(DVec3::Y, 2.0);
        let turned: Vec<DVec3> = points.iter().map(|&p| turn * p * 3.0 + DVec3::splat(7.0)).collect();
        let pairs: Vec<[DVec3; 2]> = points.iter().zip(&turned).map(|(&p, &q)| [p, q]).collect();
        let first = ViewFrame::upright(&points);
        let second = ViewFrame::alike(&turned, &first, &pairs);
        for (&p, &q) in points.iter().zip(&turned) {
            assert!(first.place(p).distance(second.place(q)) < 1e-9);
        }
    }

    #[test]
    fn meshes_that_face_alike_are_left_as_they_are() {
        let points = table(|p| p);
        let turn = DQuat::from_axis_angle(DVec3::Y, 0.2);
        let turned: Vec<DVec3> = points.iter().map(|&p| turn * p).collect();
        let pairs: Vec<[DVec3; 2]> = points.iter().zip(&turned).map(|(&p, &q)| [p, q]).collect();
        let first = ViewFrame::upright(&points);
        assert_eq!(ViewFrame::alike(&turned, &first, &pairs), ViewFrame::upright(&turned));
        ViewFrame::alike(&[], &ViewFrame::upright(&[]), &[]);
    }
}
