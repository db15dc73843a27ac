//! Work of many jobs in one dispatch.
//!
//! A device serves one caller at a time. Whoever finds it idle runs at once and never waits for company; what others
//! bring in meanwhile is run together by the next. Elements are independent, so company changes no bit of a result.

use crate::error::{Error, Result};
use std::collections::HashMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Where callers with work of one kind meet.
pub struct Gather<T> {
    state: Mutex<State<T>>,
    changed: Condvar,
}

struct State<T> {
    is_busy: bool,
    next: usize,
    waiting: Vec<(usize, T)>,
    done: HashMap<usize, Result<T>>,
}

impl<T> Default for Gather<T> {
    fn default() -> Self {
        let state = State { is_busy: false, next: 0, waiting: Vec::new(), done: HashMap::new() };
        Gather { state: Mutex::new(state), changed: Condvar::new() }
    }
}

impl<T> Gather<T> {
    /// Runs `work` on `item`, with or without items of other callers, and returns it as `work` left it.
    ///
    /// `joins` says whether an item may go with those before it; the first one always goes. If `work` fails on several
    /// items, which it may have changed by then, it is run again on each alone. Every caller must bring the same `work` and `joins`.
    pub fn run(
        &self,
        item: T,
        joins: impl Fn(&[(usize, T)], &T) -> bool,
        work: impl Fn(&mut [(usize, T)]) -> Result<()>,
    ) -> Result<T> {
        let mut state = self.lock();
        let ticket = state.next;
        state.next += 1;
        state.waiting.push((ticket, item));
        loop {
            if let Some(result) = state.done.remove(&ticket) {
                return result;
            }
            if state.is_busy {
                state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            }
            state.is_busy = true;
            let turn = Turn { gather: self, tickets: Vec::new() };
            let batch = take_batch(&mut state.waiting, &joins);
            drop(state);
            turn.serve(batch, &work);
            state = self.lock();
        }
    }

    /// No call below panics while it holds the lock.
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn take_batch<T>(waiting: &mut Vec<(usize, T)>, joins: &impl Fn(&[(usize, T)], &T) -> bool) -> Vec<(usize, T)> {
    let (mut batch, mut rest) = (Vec::new(), Vec::new());
    for (ticket, item) in waiting.drain(..) {
        if batch.is_empty() || joins(&batch, &item) {
            batch.push((ticket, item));
        } else {
            rest.push((ticket, item));
        }
    }
    *waiting = rest;
    batch
}

/// The device is this caller's; when dropped it is free, and callers whose work was lost to a panic are told so.
struct Turn<'a, T> {
    gather: &'a Gather<T>,
    tickets: Vec<usize>,
}

impl<T> Turn<'_, T> {
    fn serve(mut self, mut batch: Vec<(usize, T)>, work: &impl Fn(&mut [(usize, T)]) -> Result<()>) {
        self.tickets = batch.iter().map(|(ticket, _)| *ticket).collect();
        let outcome = work(&mut batch);
        // A failure may be another's: everybody gets their own.
        let is_shared = outcome.is_err() && batch.len() > 1;
        let one = |(ticket, item): (usize, T)| {
            let mut alone = [(ticket, item)];
            let outcome = if is_shared { work(&mut alone) } else { outcome.clone() };
            let [(_, item)] = alone;
            (ticket, outcome.map(|()| item))
        };
        let done: Vec<(usize, Result<T>)> = batch.into_iter().map(one).collect();
        self.tickets.clear();
        self.gather.lock().done.extend(done);
    }
}

impl<T> Drop for Turn<'_, T> {
    fn drop(&mut self) {
        let mut state = self.gather.lock();
        state.is_busy = false;
        let lost = || Err(Error::bug("kernels of several jobs ran together, and another job's panicked"));
        state.done.extend(self.tickets.drain(..).map(|ticket| (ticket, lost())));
        self.gather.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread;

    #[test]
    fn everybody_gets_their_own_back_and_those_who_wait_go_together() {
        let (gather, calls, first) = (Gather::default(), AtomicUsize::new(0), Barrier::new(2));
        let work = |batch: &mut [(usize, usize)]| {
            if calls.fetch_add(1, Ordering::SeqCst) == 0 {
                first.wait(); // holds the device until all others wait
                first.wait();
            }
            batch.iter_mut().for_each(|(_, x)| *x *= 10);
            Ok(())
        };
        let run = |i: usize| gather.run(i, |batch, _| batch.len() < 4, work);
        thread::scope(|scope| {
            let leader = scope.spawn(|| run(0));
            first.wait();
            let others: Vec<_> = (1..=8).map(|i| scope.spawn(move || (i, run(i)))).collect();
            while gather.lock().waiting.len() < 8 {
                thread::yield_now();
            }
            first.wait();
            assert_eq!(leader.join().expect("no panic"), Ok(0));
            for other in others {
                let (i, result) = other.join().expect("no panic");
                assert_eq!(result, Ok(10 * i));
            }
        });
        assert_eq!(calls.into_inner(), 3, "one alone, then twice four");
    }

    #[test]
    fn after_a_failure_or_a_panic_the_device_is_free_again() {
        let gather = Gather::default();
        let all = |_: &[(usize, i32)], _: &i32| true;
        let fails = |_: &mut [(usize, i32)]| Err(Error::device("lost"));
        assert!(gather.run(1, all, fails).is_err());
        let panics = |_: &mut [(usize, i32)]| -> Result<()> { panic!("oh") };
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| gather.run(1, all, panics))).is_err());
        assert_eq!(gather.run(7, all, |_| Ok(())), Ok(7));
    }
}
