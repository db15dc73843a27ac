//! Pictures: textures read from and written to image files, and sampled.

mod exr_file;
pub mod file;
pub mod pyramid;
mod srgb;

pub use file::{Depth, Picture, read_picture};
pub use pyramid::Pyramid;
