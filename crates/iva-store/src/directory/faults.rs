//! Injected faults for tests: the n-th system call in a folder fails, or all from the n-th on, as after a kill
//! of the process; or the program is ended for real at its n-th call. Always compiled, so that tests and wheel share one
//! library: without a plan a call looks at an empty list.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Number, from 1, of the system call in any folder before which the process is aborted; 0: never.
static ABORT_AT: AtomicU64 = AtomicU64::new(0);

/// Has the process aborted before its system call of this number, from 1, in any folder. Nothing is cleaned up then, as
/// after a kill. Only the native program asks for it, for its tests.
pub fn abort_at(call: u64) {
    ABORT_AT.store(call, Ordering::Relaxed);
}

/// The faults to inject in a folder and below it.
struct Plan {
    /// Folder whose calls are counted, with those below it.
    below: PathBuf,
    /// Number of calls so far.
    calls: u64,
    /// Number of the call that fails, from 1.
    at: u64,
    /// True if all later calls fail too.
    for_good: bool,
}

/// Plans of the tests that run now.
static PLANS: Mutex<Vec<Plan>> = Mutex::new(Vec::new());

fn plans() -> MutexGuard<'static, Vec<Plan>> {
    PLANS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs `act` while system call number `at` in the folder `below`, and with `for_good` every later one, fails.
/// Returns the result of `act` and the number of calls.
pub fn with<T>(below: &Path, at: u64, for_good: bool, act: impl FnOnce() -> T) -> (T, u64) {
    let below = below.to_owned();
    plans().push(Plan { below: below.clone(), calls: 0, at, for_good });
    let result = act();
    let mut plans = plans();
    let place = plans.iter().position(|plan| plan.below == below);
    (result, place.map_or(0, |place| plans.swap_remove(place).calls))
}

/// Counts a system call of the process, and ends it if that was asked for.
fn abort_if_asked() {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    let at = ABORT_AT.load(Ordering::Relaxed);
    if at > 0 && CALLS.fetch_add(1, Ordering::Relaxed) + 1 == at {
        std::process::abort();
    }
}

/// Counts a system call in a folder; an error if it is to fail.
pub(crate) fn next(folder: &Path) -> io::Result<()> {
    abort_if_asked();
    let mut plans = plans();
    let Some(plan) = plans.iter_mut().find(|plan| folder.starts_with(&plan.below)) else {
        return Ok(());
    };
    plan.calls += 1;
    match plan.calls == plan.at || plan.for_good && plan.calls > plan.at {
        true => Err(io::Error::other("a fault on purpose")),
        false => Ok(()),
    }
}
