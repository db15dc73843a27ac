//! A parametrized region.

use super::disc::Disc;
use super::square::Side;
use crate::mesh::TriMesh;
use glam::DVec2;

/// A region with coordinates.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The region's name.
    pub name: String,
    /// The region.
    pub disc: Disc,
    /// Its sides, counter-clockwise.
    pub sides: [Side; 4],
    /// Coordinates of the disc's vertices, right-handed.
    pub st: Vec<DVec2>,
    /// True if u is 1 - s, so that (u, v) are left-handed.
    pub mirrored: bool,
    /// True if the coordinates come from a convex embedding and not from fronts.
    pub repaired: bool,
}

impl Piece {
    /// (u, v) of a vertex of the disc.
    pub fn uv(&self, v: usize) -> DVec2 {
        self.turn(self.st[v])
    }

    /// (u, v) of a point of the square, and the other way round.
    pub fn turn(&self, p: DVec2) -> DVec2 {
        if self.mirrored { DVec2::new(1.0 - p.x, p.y) } else { p }
    }

    /// Mean length of the sides along s and along t, in mesh units.
    pub fn size(&self, mesh: &TriMesh) -> DVec2 {
        let length = |k: usize| {
            let point = |v: u32| mesh.positions[self.disc.vertices[v as usize]];
            let steps = self.sides[k].vertices.windows(2);
            steps.map(|w| point(w[0]).distance(point(w[1]))).sum::<f64>()
        };
        DVec2::new(0.5 * (length(0) + length(2)), 0.5 * (length(1) + length(3))).max(DVec2::splat(f64::MIN_POSITIVE))
    }

    /// The names of the sides that a vertex of the disc lies on, in the order of the sides around the square.
    pub fn sides_at(&self, v: u32) -> impl Iterator<Item = &'static str> {
        let names = if self.mirrored { ["v0", "u0", "v1", "u1"] } else { ["v0", "u1", "v1", "u0"] };
        (0..4).filter(move |&k| self.sides[k].vertices.contains(&v)).map(move |k| names[k])
    }
}
