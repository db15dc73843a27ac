//! Solvers: colouring, matchings.

pub mod coloring;
pub mod matching;
