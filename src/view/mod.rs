//! What people look at: pages that open from disk, offline, in any browser.
//!
//! ```text
//! rows of a batch --- batch ---> batch.html
//!                       |
//!                     html: escaping, data for scripts; web/: styles and scripts, embedded
//! ```
//!
//! Every page is one self-contained file. Text from outside is escaped wherever it goes; no page names an address.

pub mod batch;
mod html;

pub use batch::{BatchRow, BatchStatus, batch_page};
