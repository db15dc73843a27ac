//! Discs in the plane: patches, convex embeddings, stretch, point location.

pub mod convex;
pub mod diagonal;
pub mod divide;
pub mod domain;
pub mod locate;
pub mod newton;
pub mod orientation;
pub mod patch_disc;
pub mod progressive;
pub mod smooth;
pub mod stretch;
pub mod visible;
pub mod walk;
