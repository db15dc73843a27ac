//! Jobs that reuse the rooms below on finished maps: morphs.

mod map_folder;
pub mod morph;

pub use map_folder::MapFolder;
