//! Panics are defects; they end the job and are reported as such, in one line.

use std::any::Any;
use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};

thread_local! {
    static LAST_PLACE: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Lets panics be silent and remembers where they happened; with `RUST_BACKTRACE` set they stay loud as well.
pub fn install_panic_hook() {
    let loud = panic::take_hook();
    let is_loud = std::env::var_os("RUST_BACKTRACE").is_some_and(|v| v != "0");
    panic::set_hook(Box::new(move |info| {
        let place = info.location().map(|l| format!(" at {}:{}", l.file(), l.line())).unwrap_or_default();
        LAST_PLACE.with_borrow_mut(|last| *last = place);
        if is_loud {
            loud(info);
        }
    }));
}

/// What a caught panic says, and where it happened if the hook is installed and it happened on this thread.
pub fn message_of(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
    let place = LAST_PLACE.with_borrow_mut(std::mem::take);
    format!("{}{place}", text.lines().next().unwrap_or_default())
}

/// Runs `work`; a panic becomes its message.
pub(super) fn catch<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    // Whatever `work` has borrowed mutably is not used again after a panic: the job ends with it. A stage's own state
    // (the device) holds no invariant that spans calls.
    panic::catch_unwind(AssertUnwindSafe(work)).map_err(|payload| message_of(payload.as_ref()))
}
