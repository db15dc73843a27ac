//! Generated meshes: the demo's pairs with their landmarks, and fixtures chosen by property.
//!
//! Smooth solids are written as signed fields ([`field`]), polygonised ([`march`]) and remeshed to any
//! resolution. Everything is computed from closed forms: equal arguments give equal bytes
//! on any number of threads.
//!
//! Animals look along +x, their left is +y, up is +z; faces wind counter-clockwise seen from outside.

mod draft;
pub mod field;
pub mod fixture;
pub mod march;
mod mug;
mod pair;
mod quadruped;
mod random;
mod remesh;
mod solid;

pub use mug::{doughnut, mug};
pub use pair::{PairOptions, RandomPair, random_pair};
pub use quadruped::{Quadruped, quadruped};
pub use random::{SplitMix, nudge_landmarks, random_landmarks};
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

/// A source and a target with the same landmark names in the same order.
pub struct DemoPair {
    /// A name fit for a folder.
    pub name: &'static str,
    /// Genus of both shapes.
    pub genus: i64,
    /// Makes the shapes with about so many vertices.
    pub generate: fn(usize) -> (Shape, Shape),
}

/// The demo's pairs; the target gets four fifths of the vertices.
pub const DEMO_PAIRS: [DemoPair; 2] = [
    DemoPair {
        name: "quadrupeds",
        genus: 0,
        generate: |n| rayon::join(|| quadruped(Quadruped::Bull, n), || quadruped(Quadruped::Mule, n * 4 / 5)),
    },
    DemoPair { name: "mug-doughnut", genus: 1, generate: |n| rayon::join(|| mug(n), || doughnut(n * 4 / 5)) },
];
