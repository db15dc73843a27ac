//! The product: base complex, atlas, surface map, certificate, distortion.

pub mod atlas;
pub mod distortion;
pub mod flips;
pub mod layout_file;
pub mod product;
pub mod report;
pub mod tile_table;

pub use crate::path::base_complex;
