//! The stages of the main job, a verb each: a value in, a new value out.

pub mod bake;
pub mod exr;
pub mod rebuild;
pub mod write;
