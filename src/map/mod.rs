//! The product: base complex, surface map, certificate, distortion.

pub mod distortion;
pub mod flips;
pub mod layout_file;
pub mod product;
pub mod report;

pub use crate::path::base_complex;
