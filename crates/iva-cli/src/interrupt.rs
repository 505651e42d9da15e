//! Handling of Ctrl-C and requests to terminate: a flag asks the work under way to stop.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Installs the interrupt handler once, clears the flag that it sets, and returns that flag.
pub(crate) fn listen() -> &'static AtomicBool {
    static LISTENING: OnceLock<()> = OnceLock::new();
    LISTENING.get_or_init(|| {
        // Without a handler an interrupt ends the process at once, as by default.
        let _ = ctrlc::set_handler(|| REQUESTED.store(true, Ordering::Relaxed));
    });
    REQUESTED.store(false, Ordering::Relaxed);
    &REQUESTED
}
