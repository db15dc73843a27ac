//! The stages of the main job, a verb each: a value in, a new value out.

pub mod bake;
pub mod carry;
pub mod cluster;
pub mod embed;
pub mod exr;
pub mod layout;
pub mod order;
pub mod rebuild;
pub mod trace;
