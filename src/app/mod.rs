//! Jobs beside the main one that reuse the rooms below: baking maps into a mesh's own texture coordinates.

pub mod attributes;
pub mod bake;
pub mod canvas;
pub mod udim;
pub mod uv;
