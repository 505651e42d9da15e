//! How many threads work.

use std::env;

use iva_sweep::Invalid;
use iva_sweep::sweep::{MAX_THREADS, SweepError, Workers};

/// Where an environment says how many threads programs like this one start.
const VARIABLE: &str = "RAYON_NUM_THREADS";

/// Starts `threads` workers; `None`: as many as the environment says, else one a core.
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
        // As rayon reads it, 0 and what is no number count for nothing.
        other => Workers::new(other.filter(|wanted| *wanted > 0)),
    }
}
