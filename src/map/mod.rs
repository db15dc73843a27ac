//! The product: base complex, atlas, surface map, certificate, distortion.

pub mod atlas;
pub mod tile_table;

pub use crate::path::base_complex;
