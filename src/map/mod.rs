//! The product: base complex, atlas, surface map, certificate, distortion.

pub mod atlas;
pub mod certificate;
pub mod charts;
pub mod distortion;
pub mod divided;
pub mod embedding;
pub mod file_order;
pub mod flips;
pub mod layout_file;
pub mod lift;
pub mod product;
pub mod recut;
pub mod refined;
pub mod report;
pub mod surface_map;
pub mod tile_table;
pub mod transport;

pub use crate::path::base_complex;
