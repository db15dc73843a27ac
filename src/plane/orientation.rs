//! The exact orientation predicate (Shewchuk's adaptive arithmetic, by the `robust` crate).

use glam::DVec2;
use robust::{Coord, orient2d};

/// Positive if `a`, `b`, `c` turn counter-clockwise, negative if clockwise, zero exactly if they are collinear.
///
/// The sign is exact for the stored coordinates; the size approximates twice the signed area.
pub fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}
