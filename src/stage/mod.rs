//! The stages: a verb each, a value in and a new one out.

pub mod write;
