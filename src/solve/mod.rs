//! Solvers: colouring, the energy of mapped triangles, matchings.

pub mod coloring;
pub mod dirichlet;
pub mod matching;
pub mod warp;
