//! The stages of the main job, a verb each: a value in, a new value out.

pub mod bake;
pub mod carry;
pub mod check;
pub mod cluster;
pub mod compose;
pub mod embed;
pub mod exr;
pub mod layout;
pub mod load;
pub mod order;
pub mod rebuild;
pub mod relax;
pub mod stretch;
pub mod trace;
pub mod untangle;
pub mod write;
