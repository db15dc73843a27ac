//! Writes a finished map: meshes, image points, layout, report, into a folder that appears complete or not at all.

pub mod folder;
pub mod points_csv;

pub use folder::{OutputFolder, check_place};
