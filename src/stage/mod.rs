//! The stages: each takes a value and returns a new one.

pub mod bake;
pub mod exr;
pub mod write;
