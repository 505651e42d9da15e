//! Faults on purpose: the n-th call of the system fails, or it and all after it, as if the process had
//! been killed there.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is to go wrong below a folder.
struct Plan {
    below: PathBuf,
    calls: u64,
    at: u64,
    for_good: bool,
}

static PLANS: Mutex<Vec<Plan>> = Mutex::new(Vec::new());

fn plans() -> MutexGuard<'static, Vec<Plan>> {
    PLANS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Lets call number `at` in a folder and below it fail while `act` runs, and all after it if it is `for_good`.
/// Returns also how many calls there were.
pub fn with<T>(below: &Path, at: u64, for_good: bool, act: impl FnOnce() -> T) -> (T, u64) {
    let below = below.to_owned();
    plans().push(Plan { below: below.clone(), calls: 0, at, for_good });
    let result = act();
    let mut plans = plans();
    let place = plans.iter().position(|plan| plan.below == below);
    (result, place.map_or(0, |place| plans.swap_remove(place).calls))
}

/// Counts a call in a folder.
pub(crate) fn next(folder: &Path) -> io::Result<()> {
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
