//! Jobs beside the main one that reuse the rooms below: baking maps into a mesh's own texture coordinates, carrying images
//! through a finished map, reading geometry images back as meshes, morphs, diffusion parametrization.

pub mod atlas_mesh;
pub mod attributes;
pub mod bake;
pub mod canvas;
pub mod carry_values;
pub mod constrained;
pub mod destination;
pub mod diffusion;
pub mod finished_map;
mod frames;
mod gutter;
mod map_folder;
pub mod morph;
pub mod rebuild;
pub mod texture;
pub mod transfer;
pub mod udim;
pub mod uv;

pub use map_folder::MapFolder;
