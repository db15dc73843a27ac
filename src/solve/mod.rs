//! Solvers: matchings.

pub mod matching;
