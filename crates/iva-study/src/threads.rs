//! The number of worker threads.

use std::env;

use iva_sweep::Invalid;
use iva_sweep::sweep::{MAX_THREADS, SweepError, Workers};

/// Environment variable of the number of threads, which is that of rayon.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Starts `threads` workers; for `None`, the number in `RAYON_NUM_THREADS`, or one a core without it.
///
/// # Errors
/// As [`Workers::new`]; also for more than [`MAX_THREADS`] in the environment.
pub fn workers(threads: Option<usize>) -> Result<Workers, SweepError> {
    if threads.is_some() {
        return Workers::new(threads);
    }
    let wanted = env::var(VARIABLE).ok().and_then(|text| text.trim().parse::<usize>().ok());
    match wanted {
        Some(wanted) if wanted > MAX_THREADS => {
            let allowed = format!("give a whole number from 1 to {MAX_THREADS}");
            Err(Invalid::new(VARIABLE, wanted, allowed).into())
        }
        // As in rayon, 0 and anything but a number are ignored.
        other => Workers::new(other.filter(|wanted| *wanted > 0)),
    }
}
