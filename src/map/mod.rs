//! The product: base complex, surface map, certificate, distortion.

pub mod base_complex;
pub mod distortion;
pub mod flips;
pub mod layout_file;
pub mod product;
pub mod report;
