//! Ctrl-C (or a request to terminate) asks the work under way to stop; nothing is cut off.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Begins to listen and returns the flag that an interrupt sets.
pub(crate) fn listen() -> &'static AtomicBool {
    static LISTENING: OnceLock<()> = OnceLock::new();
    LISTENING.get_or_init(|| {
        // Where no handler can be set, an interrupt ends the process as it would any other.
        let _ = ctrlc::set_handler(|| REQUESTED.store(true, Ordering::Relaxed));
    });
    REQUESTED.store(false, Ordering::Relaxed);
    &REQUESTED
}
