//! Kernels: one file each, with the CPU reference (the sweep's is [`sweep_lanes`]) and the launch of `kernels/NAME.wgsl`,
//! same inputs, same outputs.
//!
//! The reference of a kernel is the specification: plain arithmetic in f32, one element at a time, in the order the
//! WGSL text has. Elements are independent, so rayon spreads them over threads, and registers hold several of them,
//! without changing a bit. Products are written out and nothing is fused, so that llvmpipe gives the same bits, square
//! roots and divisions included (the tests demand it). Real GPUs fuse multiplications with additions and round divisions
//! more loosely: 1e-5 relative.
//!
//! Points are four lanes of f32 here (`x, y, z` and one unused), in the plane with `z = 0`: one format for all kernels,
//! and the one that storage buffers align without holes. [`relax_session`] joins three kernels into the relaxation of
//! many patches at once; [`sweep_batch`] runs the relaxation of the composed map over many domains at once.

mod normalise;
pub mod relax;
pub mod relax_session;
pub mod resample;
pub mod rings;
pub mod stretch;
pub mod sweep;
pub mod sweep_batch;
pub mod sweep_lanes;
mod texel_rows;
pub mod texels;
pub mod vertex_stretch;

use crate::error::{Error, Result};
use crate::gpu::Kernel;

pub use relax_session::{RelaxInput, RelaxOptions, RelaxResult, RelaxSession};
pub use resample::{Query, resample};
pub use rings::{Lists, Rings};
pub use stretch::{Stretch, energy, stretch, stretch_into};
pub use sweep::Sight;
pub use sweep_batch::{Piece, sweep_all};
pub use texels::{FlatTriangle, NO_TRIANGLE, Texel, texel_values, texels};

/// A point in four lanes: `x, y, z` and one unused; in the plane `z = 0`.
pub type Lanes = [f32; 4];

/// All kernels, for tests that hold for each of them.
pub const ALL: &[&Kernel] =
    &[&stretch::KERNEL, &vertex_stretch::KERNEL, &relax::KERNEL, &resample::KERNEL, &sweep::KERNEL, &texels::KERNEL];

/// Elements a thread takes at least; smaller pieces cost more to hand out than to compute.
const GRAIN: usize = 1024;

/// Refuses indices that are not below `len`, naming the first; devices would read anything there.
fn check_indices<'a>(what: &str, indices: impl IntoIterator<Item = &'a u32>, len: usize) -> Result<()> {
    match indices.into_iter().find(|&&i| i as usize >= len) {
        None => Ok(()),
        Some(i) => Err(Error::bug(format!("{what} {i} is out of range, there are {len} elements"))),
    }
}

/// Refuses arrays that should run in parallel and do not.
fn check_len(what: &str, len: usize, expected: usize) -> Result<()> {
    if len == expected {
        return Ok(());
    }
    Err(Error::bug(format!("{what}: {len} elements where {expected} are expected")))
}
