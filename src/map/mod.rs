//! The product: base complex, surface map, certificate, distortion.

pub mod base_complex;
