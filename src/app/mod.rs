//! Jobs beside the main one that reuse the rooms below: baking maps into a mesh's own texture coordinates, carrying images
//! through a finished map.

pub mod atlas_mesh;
pub mod attributes;
pub mod bake;
pub mod canvas;
pub mod destination;
pub mod finished_map;
mod frames;
pub mod texture;
pub mod transfer;
pub mod udim;
pub mod uv;
