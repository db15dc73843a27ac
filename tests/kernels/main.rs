//! The compute kernels: valid, right, and the same on the CPU and on an adapter.

mod device;
mod elementwise;
mod relax;
mod support;
mod sweep;
mod texels;
mod validity;
