//! Discs in the plane: patches, convex embeddings, stretch, point location.

pub mod convex;
pub mod divide;
pub mod locate;
pub mod orientation;
pub mod patch_disc;
pub mod progressive;
pub mod stretch;
pub mod visible;
