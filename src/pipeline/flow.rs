//! What all jobs of a line share: cores, memory, the time each may take, and who watches.

pub mod budget;
pub mod cores;

use super::observer::Observer;
use budget::Budget;
use cores::Cores;
use std::time::Duration;

/// What the process needs without jobs: the program, its threads, what allocators keep.
const OWN_BYTES: u64 = 48 << 20;

/// How jobs flow through a line of stages.
pub struct Flow<'a> {
    pub(super) observer: &'a dyn Observer,
    pub(super) cores: Cores,
    pub(super) budget: Budget,
    pub(super) timeout: Option<Duration>,
}

impl<'a> Flow<'a> {
    /// A flow that uses all threads of rayon's pool, any memory and any time.
    pub fn watched(observer: &'a dyn Observer) -> Self {
        let cores = Cores::new(rayon::current_num_threads());
        Flow { observer, cores, budget: Budget::new(u64::MAX), timeout: None }
    }

    /// The same within so much time for each job, and so many bytes for the whole process.
    pub fn bounded(self, timeout: Option<Duration>, memory: u64) -> Self {
        Flow { budget: Budget::new(memory.saturating_sub(OWN_BYTES)), timeout, ..self }
    }
}
