//! Pictures: textures read from and written to image files, and sampled; previews of meshes.

mod exr_file;
pub mod file;
pub mod pyramid;
pub mod render;
mod srgb;

pub use file::{Depth, Picture, read_picture};
pub use pyramid::Pyramid;
