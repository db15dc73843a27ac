//! Solvers: sparse systems, colouring.

pub mod coloring;
