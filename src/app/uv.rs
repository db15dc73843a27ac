//! The texture coordinates of a mesh's triangles, and what is odd about them.

use crate::mesh::io::MeshFile;
use glam::DVec2;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// A tile of texture space: the unit square at these whole coordinates. Tile (u, v) has the UDIM number
/// 1001 + u + 10 v.
pub type Tile = [i32; 2];

/// The largest `u` of a UDIM tile.
const LAST_COLUMN: i32 = 9;
/// The largest UDIM number.
const LAST_NUMBER: i32 = 9999;
/// A triangle that reaches this little beyond a tile's border still lies in it: coordinates are rounded in files.
const ON_BORDER: f64 = 1e-6;

/// Texture coordinates by triangle.
#[derive(Clone, Debug)]
pub struct UvTriangles {
    /// Corners, v up; not finite where the mesh has none.
    pub corners: Vec<[DVec2; 3]>,
    /// Triangles without texture coordinates.
    pub missing: Vec<u32>,
    /// Triangles that are turned over in texture space.
    pub flipped: Vec<u32>,
}

impl UvTriangles {
    /// The texture coordinates of a mesh as it was read.
    pub fn of(mesh: &MeshFile) -> UvTriangles {
        let corner = |c: usize| mesh.uv.at(c).filter(|uv| uv.is_finite()).unwrap_or(DVec2::NAN);
        let corners: Vec<[DVec2; 3]> = mesh.triangle_corners().map(|t| t.map(corner)).collect();
        let number = |keep: fn(&[DVec2; 3]) -> bool| -> Vec<u32> {
            (0u32..).zip(&corners).filter(|(_, t)| keep(t)).map(|(i, _)| i).collect()
        };
        let missing = number(|t| !t.iter().all(|p| p.is_finite()));
        let flipped = number(|[a, b, c]| (*b - *a).perp_dot(*c - *a) < 0.0);
        UvTriangles { corners, missing, flipped }
    }

    /// The tiles that triangles lie in, in order.
    pub fn tiles(&self) -> Vec<Tile> {
        let tile = |t: &[DVec2; 3]| tile_of(t);
        self.corners.iter().filter_map(tile).collect::<BTreeSet<Tile>>().into_iter().collect()
    }

    /// The corners as seen from a tile, so that it is the unit square.
    pub fn seen_from(&self, [u, v]: Tile) -> Vec<[DVec2; 3]> {
        let origin = DVec2::new(f64::from(u), f64::from(v));
        self.corners.par_iter().map(|t| t.map(|p| p - origin)).collect()
    }

    /// Triangles that reach beyond the unit square.
    pub fn outside(&self) -> Vec<u32> {
        let is_outside = |t: &[DVec2; 3]| {
            let beyond = |x: f64| !(-ON_BORDER..=1.0 + ON_BORDER).contains(&x);
            t.iter().all(|p| p.is_finite()) && t.iter().any(|p| beyond(p.x) || beyond(p.y))
        };
        (0u32..).zip(&self.corners).filter(|(_, t)| is_outside(t)).map(|(i, _)| i).collect()
    }
}

/// The tile that holds a triangle's centre.
fn tile_of(corners: &[DVec2; 3]) -> Option<Tile> {
    let centre = corners.iter().sum::<DVec2>() / 3.0;
    centre.is_finite().then(|| [centre.x.floor() as i32, centre.y.floor() as i32])
}

/// The UDIM number of a tile, if it has one.
pub fn udim_number([u, v]: Tile) -> Option<i32> {
    let number = 1001i32.checked_add(u)?.checked_add(v.checked_mul(10)?)?;
    ((0..=LAST_COLUMN).contains(&u) && v >= 0 && number <= LAST_NUMBER).then_some(number)
}
