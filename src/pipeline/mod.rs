//! Typed stages joined by bounded channels, with jobs flowing through them.
//!
//! ```text
//!   jobs -> [load] -> [check] -> [cluster] -> ... -> [relax] -> ... -> [write] -> outcomes
//!             |          |                             |
//!             threads of its own for each, a bounded channel between neighbours; a stage takes one of the cores before
//!             it works on a job, the latest stage first; inside a stage the loops run on rayon's threads
//! ```
//!
//! A job is let in when the memory it will need is free, and comes out as soon as it is done. One that fails keeps
//! travelling as its error. A panic in a stage is caught and becomes an error of that job alone.

pub mod batch;
mod flow;
mod footprint;
mod images;
mod inputs;
mod job;
mod lay_out;
mod line;
mod observer;
mod pair;
mod panics;
mod spawn;
pub mod stages;
mod steps;
mod templates;
mod textures;
mod thumbnails;

pub use flow::Flow;
pub use job::{LayoutMethod, MapJob, MapOptions, PageOptions, Relaxation};
pub use line::{JobId, Line, Outcome, Step};
pub use observer::{Observer, Silent};
pub use panics::{install_panic_hook, message_of};
pub use spawn::{Limits, spawn_maps};
pub use stages::{Stage, map_pairs, run_maps, stream_maps};
pub use steps::Mapped;
pub use templates::Templates;
