//! Curves on surfaces: fronts, clusters, shortest paths over edge nodes, the cut mesh, regions between arcs.

pub mod base_complex;
pub mod bucket;
pub mod closing;
pub mod cluster;
pub mod corner_distance;
pub mod curve;
pub mod cut_mesh;
pub mod edge_loop;
pub mod edge_tree;
pub mod extremity;
pub mod face_cells;
pub mod front;
pub mod handedness;
pub mod handle;
pub mod loop_anchor;
pub mod loop_pairs;
pub mod network;
pub mod partner;
pub mod punishment;
pub mod rebuild;
pub mod region;
pub mod rim;
pub mod search;
pub mod side;
pub mod side_front;
pub mod subcomplex;
