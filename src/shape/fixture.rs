//! Small meshes chosen by property, for tests and benches.
//!
//! | property | fixtures |
//! | --- | --- |
//! | closed, genus 0 | [`tetrahedron`], [`octahedron`], [`cube`], [`icosphere`], [`ellipsoid`], [`limb`] |
//! | closed, genus g | [`torus`] (structured), [`genus`] (remeshed, any g) |
//! | one boundary loop | [`plane`], [`disc`] |
//! | several boundary loops | [`annulus`], [`sphere_with_holes`] |
//! | hard triangles | [`slivers`] (tiny angles), [`uneven`] (tiny edges), [`needles`] (tiny or no area) |
//! | few neighbours | [`studded`] (vertices of valence three) |
//! | to be refused | [`moebius`] (one-sided), [`two_spheres`] (two components) |

mod closed;
mod hard;
mod open;

pub use closed::{cube, ellipsoid, genus, icosphere, limb, octahedron, tetrahedron, torus};
pub use hard::{Soup, moebius, needles, slivers, studded, two_spheres, uneven};
pub use open::{annulus, disc, plane, sphere_with_holes};

use crate::mesh::{TriMesh, VertexId};
use glam::DVec3;

/// Joins a fixture whose construction makes it a manifold.
fn manifold(positions: Vec<DVec3>, faces: &[[u32; 3]]) -> TriMesh {
    let faces: Vec<_> = faces.iter().map(|face| face.map(VertexId)).collect();
    // Every caller lists each edge once per direction; a test builds all fixtures.
    TriMesh::new(positions, &faces).expect("fixtures are manifolds")
}

/// The two triangles of a quad whose corners are given counter-clockwise.
fn quad([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// A point on the unit circle in the xy plane, after the share `turns` of a full turn.
fn on_circle(turns: f64) -> DVec3 {
    let angle = std::f64::consts::TAU * turns;
    DVec3::new(angle.cos(), angle.sin(), 0.0)
}
