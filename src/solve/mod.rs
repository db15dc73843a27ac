//! Solvers: sparse systems, colouring, matchings.

pub mod coloring;
pub mod matching;
