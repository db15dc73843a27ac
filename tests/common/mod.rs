//! What the tests of paths, layouts and embeddings share: small meshes, whole runs, and checkers of invariants.
#![allow(dead_code)] // every test crate takes only what it needs

pub mod ball;
pub mod check;
pub mod islands;
pub mod job;
pub mod mesh;
pub mod run;
