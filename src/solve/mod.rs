//! Solvers: systems of blocks, colouring, the energy of mapped triangles, least-squares meshes, matchings, queues, warps.

pub mod blocks;
pub mod coloring;
pub mod dirichlet;
pub mod least_squares_mesh;
pub mod matching;
pub mod nearest;
pub mod springs;
pub mod warp;
