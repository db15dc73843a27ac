//! Typed stages joined by bounded channels, with jobs flowing through them.
//!
//! ```text
//!   jobs -> [load] -> [check] -> [cluster] -> ... -> [relax] -> ... -> [write] -> outcomes
//!             |          |                             |
//!             one thread each, a bounded channel between neighbours; the device belongs to one stage's thread;
//!             inside a stage the loops run on rayon's threads
//! ```
//!
//! A job that fails keeps travelling as its error, so the outcomes come in the order of the jobs. A panic in a stage is
//! caught and becomes an error of that job alone.

mod images;
mod job;
mod lay_out;
mod line;
mod observer;
mod pair;
mod panics;
pub mod stages;
mod steps;
mod textures;
mod thumbnails;

pub use job::{LayoutMethod, MapJob, MapOptions, PageOptions, Relaxation};
pub use line::{JobId, Line, Outcome, Step};
pub use observer::{Observer, Silent};
pub use panics::{install_panic_hook, message_of};
pub use stages::{Stage, map_pairs, run_maps};
pub use steps::Mapped;
