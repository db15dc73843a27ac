//! Discs in the plane: patches, convex embeddings, stretch, point location.

pub mod convex;
pub mod divide;
pub mod domain;
pub mod exact_sweep;
#[cfg(test)]
mod grid;
pub mod ground;
pub mod hierarchy;
pub mod locate;
pub mod mean_value;
pub mod newton;
pub mod orientation;
pub mod overlay;
pub mod patch_disc;
pub mod polish;
pub mod progressive;
mod rings;
pub mod samples;
pub mod scaffold;
pub mod smooth;
pub mod straighten;
pub mod stretch;
pub mod thin;
pub mod tiling;
pub mod visible;
pub mod walk;
pub mod warp;
