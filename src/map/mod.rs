//! The product: base complex, atlas, surface map, certificate, distortion.

pub mod atlas;
pub mod base_complex;
pub mod tile_table;
