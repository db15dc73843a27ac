//! The memory that the jobs in flight may take: a job is let in when what it needs is free.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// So many bytes for all jobs together.
pub struct Budget {
    limit: u64,
    used: Mutex<u64>,
    freed: Condvar,
}

/// Bytes set aside for one job; dropped, they are free again.
pub struct Reservation<'a> {
    budget: &'a Budget,
    bytes: u64,
}

impl Budget {
    /// `limit` bytes.
    pub fn new(limit: u64) -> Self {
        Budget { limit, used: Mutex::new(0), freed: Condvar::new() }
    }

    /// Sets `bytes` aside, waiting until they are free. A job that needs more than there is waits until it is alone.
    pub fn reserve(&self, bytes: u64) -> Reservation<'_> {
        let mut used = self.lock();
        while *used > 0 && used.saturating_add(bytes) > self.limit {
            used = self.freed.wait(used).unwrap_or_else(PoisonError::into_inner);
        }
        *used = used.saturating_add(bytes);
        Reservation { budget: self, bytes }
    }

    fn lock(&self) -> MutexGuard<'_, u64> {
        self.used.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Reservation<'_> {
    fn drop(&mut self) {
        let mut used = self.budget.lock();
        *used = used.saturating_sub(self.bytes);
        self.budget.freed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::thread;

    #[test]
    fn jobs_in_flight_stay_within_the_limit_unless_one_alone_exceeds_it() {
        let budget = Budget::new(100);
        let in_flight = AtomicU64::new(0);
        thread::scope(|scope| {
            for bytes in [60, 50, 40, 250, 100, 1, 99, 30] {
                let (budget, in_flight) = (&budget, &in_flight);
                scope.spawn(move || {
                    let held = budget.reserve(bytes);
                    let now = in_flight.fetch_add(bytes, Ordering::SeqCst) + bytes;
                    assert!(now <= 100 || now == bytes, "{now} bytes with {bytes} just let in");
                    thread::yield_now();
                    in_flight.fetch_sub(bytes, Ordering::SeqCst);
                    drop(held);
                });
            }
        });
        assert_eq!(*budget.lock(), 0);
    }
}
