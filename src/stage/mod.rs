//! The stages of the main job, a verb each: a value in, a new value out.

pub mod carry;
pub mod cluster;
pub mod layout;
pub mod order;
pub mod trace;
