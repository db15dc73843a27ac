//! The stages of a job: one verb per file, a value in and a new value out.

pub mod check;
pub mod load;
