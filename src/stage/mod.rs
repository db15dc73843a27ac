//! The stages of the main job, a verb each: a value in, a new value out.

pub mod bake;
pub mod candidate;
pub mod carry;
pub mod check;
pub mod cluster;
pub mod compose;
pub mod embed;
pub mod exr;
pub mod flip;
pub mod greedy;
mod growth;
pub mod guided;
pub mod hypothesis;
pub mod joint;
pub mod layout;
mod levels;
pub mod load;
pub mod order;
pub mod polish;
pub mod polygon;
pub mod rebuild;
pub mod relax;
pub mod stretch;
pub mod take_out;
pub mod trace;
mod visits;
pub mod write;
