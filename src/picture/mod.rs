//! Pictures: textures read from and written to image files, and sampled; previews of meshes; moving pictures.

mod exr_file;
pub mod file;
pub mod moving;
pub mod pyramid;
pub mod render;
mod srgb;

pub use file::{Depth, Picture, read_picture};
pub use pyramid::Pyramid;
