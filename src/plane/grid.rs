//! Flat domains for the tests of this room.

use super::domain::Domain;
use crate::mesh::{FaceId, VertexId};
use glam::DVec2;

/// The unit square as a grid of `n` by `n` cells, flat in space; its inner vertices are moved in the plane.
pub(super) fn grid(n: u32, moved: impl Fn(DVec2) -> DVec2) -> Domain {
    let mut domain = Domain::default();
    for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
        let p = DVec2::new(f64::from(i), f64::from(j)) / f64::from(n);
        let inner = i % n != 0 && j % n != 0;
        domain.vertices.push(VertexId(domain.vertices.len() as u32));
        domain.positions.push(if inner { moved(p) } else { p });
        domain.points.push(p.extend(0.0));
        domain.free.push(inner);
    }
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let a = j * (n + 1) + i;
        domain.faces.extend([0, 1].map(|k| FaceId(domain.triangles.len() as u32 + k)));
        domain.triangles.extend([[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]);
    }
    domain.connect();
    domain
}

/// Turns the inside of the unit square a little.
pub(super) fn swirl(p: DVec2) -> DVec2 {
    let bump = (p * (DVec2::ONE - p)).element_product();
    p + DVec2::new(0.9 * bump, -0.6 * bump * p.x)
}
