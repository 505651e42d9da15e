//! Conversion of panics into errors, for the decoders of Parquet and Arrow, which panic over damaged files.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::sync::Once;

/// Message for a file whose contents are inconsistent.
pub(crate) const DAMAGED: &str = "it is damaged: its parts contradict each other";

thread_local! {
    /// True while this thread is inside [`caught`], where a panic prints nothing.
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Calls `read` on this thread and returns its result, or `None` if it panics; the panic is not printed.
pub(crate) fn caught<T>(read: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    // The panic hook is global: it is set once, and checks the flag of the thread that panics.
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !QUIET.try_with(Cell::get).unwrap_or(false) {
                before(info);
            }
        }));
    });
    let outer = QUIET.replace(true);
    let result = catch_unwind(AssertUnwindSafe(read));
    QUIET.set(outer);
    result.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_nothing_and_the_next_reading_is_as_before() {
        assert_eq!(caught(|| 1), Some(1));
        assert_eq!(caught(|| Vec::<u8>::new()[0]), None);
        assert_eq!(caught(|| caught(|| Vec::<u8>::new()[0]).is_none()), Some(true));
        assert!(!QUIET.get());
    }
}
