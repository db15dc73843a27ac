//! The cores that the stages of a line share.
//!
//! A stage takes a core before it works on a job. Where several wait, the latest stage goes first: jobs that are nearly
//! done are finished, and their memory is free, before others are begun.

use crate::pipeline::stages::Stage;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// So many stages may work at a time.
pub struct Cores {
    count: usize,
    state: Mutex<State>,
    changed: Condvar,
}

struct State {
    free: usize,
    /// Threads that wait, by the number of their stage.
    waiting: [usize; Stage::ALL.len()],
}

/// A core that is in use; dropped, it is free again.
pub struct Core<'a>(&'a Cores);

impl Cores {
    /// `count` cores, at least one.
    pub fn new(count: usize) -> Self {
        let count = count.max(1);
        Cores { count, state: Mutex::new(State { free: count, waiting: [0; _] }), changed: Condvar::new() }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Waits for a core.
    pub fn take(&self, stage: Stage) -> Core<'_> {
        let place = stage as usize;
        let mut state = self.lock();
        state.waiting[place] += 1;
        while state.free == 0 || state.waiting[place + 1..].iter().any(|&n| n > 0) {
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.waiting[place] -= 1;
        state.free -= 1;
        if state.free > 0 {
            self.changed.notify_all(); // those who waited for this thread to go first
        }
        Core(self)
    }

    /// The state holds no invariant that a panic could break: numbers change one at a time.
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Core<'_> {
    fn drop(&mut self) {
        self.0.lock().free += 1;
        self.0.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    use std::thread;

    #[test]
    fn the_latest_stage_goes_first() {
        let cores = Cores::new(1);
        let (sender, order) = channel();
        thread::scope(|scope| {
            let busy = cores.take(Stage::Load);
            for stage in [Stage::Load, Stage::Write, Stage::Relax] {
                let (cores, sender) = (&cores, sender.clone());
                scope.spawn(move || {
                    let _core = cores.take(stage);
                    sender.send(stage).expect("the test listens");
                });
            }
            while cores.lock().waiting.iter().sum::<usize>() < 3 {
                thread::yield_now();
            }
            drop(busy);
        });
        assert_eq!(order.try_iter().collect::<Vec<_>>(), [Stage::Write, Stage::Relax, Stage::Load]);
    }
}
