//! The product: base complex, surface map, certificate, distortion.

pub use crate::path::base_complex;
