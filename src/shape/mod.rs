//! Generated meshes: the demo's pairs with their landmarks, and fixtures chosen by property.
//!
//! Smooth solids are written as signed fields ([`field`]), polygonised ([`march`]) and remeshed to any
//! resolution. Everything is computed from closed forms, sequentially: equal arguments give equal bytes.
//!
//! Animals look along +x, their left is +y, up is +z; faces wind counter-clockwise seen from outside.

mod draft;
pub mod field;
pub mod fixture;
pub mod march;
mod mug;
mod quadruped;
mod random;
mod remesh;
mod solid;

pub use mug::{doughnut, mug};
pub use quadruped::{Quadruped, quadruped};
pub use random::{SplitMix, random_landmarks};
pub use solid::FEWEST_VERTICES;

use crate::mesh::{TriMesh, VertexId};

/// A mesh with named landmarks.
#[derive(Clone, Debug)]
pub struct Shape {
    /// A name fit for a file.
    pub name: String,
    /// The mesh.
    pub mesh: TriMesh,
    /// Landmarks: a name and a vertex each, no vertex twice.
    pub landmarks: Vec<(String, VertexId)>,
}

/// The demo's pairs as (name, source, target), with about `resolution` vertices a mesh.
///
/// The two shapes of a pair have the same landmark names in the same order.
pub fn demo_pairs(resolution: usize) -> Vec<(String, Shape, Shape)> {
    vec![
        (
            "quadrupeds".to_string(),
            quadruped(Quadruped::Bull, resolution),
            quadruped(Quadruped::Mule, resolution * 4 / 5),
        ),
        ("mug-doughnut".to_string(), mug(resolution), doughnut(resolution * 4 / 5)),
    ]
}
