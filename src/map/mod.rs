//! The product: base complex, atlas, surface map, certificate, distortion.

pub mod atlas;
pub mod certificate;
pub mod embedding;
pub mod surface_map;
pub mod tile_table;

pub use crate::path::base_complex;
