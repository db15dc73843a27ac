//! `homeo`: certified bijective, low-distortion maps between triangle meshes.

pub mod cli;
pub mod error;
pub mod gpu;
pub mod kernel;
pub mod map;
pub mod mesh;
pub mod path;
pub mod pipeline;
pub mod plane;
pub mod shape;
pub mod solve;
pub mod stage;

pub use error::{Error, ErrorKind, Result};
