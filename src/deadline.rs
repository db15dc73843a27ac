//! The deadline of the job at hand: long loops ask now and then whether there is time left.
//!
//! Threads cannot be stopped from outside, so a job that takes too long ends itself. The deadline belongs to the thread
//! that runs a stage. It is asked before every stage, and by the loops that take longest, those of the relaxation.

use crate::error::{Error, Result};
use std::cell::Cell;
use std::time::{Duration, Instant};

thread_local! {
    static AT_HAND: Cell<Option<Deadline>> = const { Cell::new(None) };
}

/// When a job must be done.
#[derive(Clone, Copy, Debug)]
pub struct Deadline {
    at: Option<Instant>,
    limit: Duration,
}

impl Deadline {
    /// For work that goes on at `start` after `spent` seconds, and may take `limit` in all; never, if that is beyond what
    /// the clock can tell.
    pub fn new(start: Instant, spent: f64, limit: Duration) -> Self {
        let spent = Duration::try_from_secs_f64(spent).unwrap_or_default();
        Deadline { at: start.checked_add(limit.saturating_sub(spent)), limit }
    }
}

/// Runs `work`, in which [`check`] fails after the deadline; none: never.
pub fn within<T>(deadline: Option<Deadline>, work: impl FnOnce() -> T) -> T {
    let before = AT_HAND.replace(deadline);
    let result = work();
    AT_HAND.set(before);
    result
}

/// Fails if this thread's job is over time.
pub fn check() -> Result<()> {
    match AT_HAND.get() {
        Some(Deadline { at: Some(at), limit }) if Instant::now() >= at => {
            let seconds = limit.as_secs_f64();
            Err(Error::late(format!("not done after {seconds} s")).remedy("give it more time with --timeout"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    #[test]
    fn only_work_within_a_deadline_can_be_late() {
        let second = Duration::from_secs(1);
        let past = Deadline::new(Instant::now(), 1.5, second);
        assert_eq!(check(), Ok(()));
        within(Some(past), || {
            assert_eq!(check().map_err(|e| e.kind), Err(ErrorKind::Late));
            within(Some(Deadline::new(Instant::now(), 0.0, Duration::MAX)), || assert_eq!(check(), Ok(())));
            assert!(check().is_err(), "the outer deadline holds again");
        });
        assert_eq!(check(), Ok(()));
    }
}
