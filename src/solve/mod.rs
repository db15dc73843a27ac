//! Solvers: matchings, the energy of mapped triangles.

pub mod dirichlet;
pub mod matching;
