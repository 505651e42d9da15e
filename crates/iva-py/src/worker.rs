//! Long calls: the work runs on a thread of its own while the calling thread serves Python. Work of a
//! few milliseconds runs on the calling thread.
//!
//! The caller detaches from the interpreter and wakes every 50 ms to let signal handlers run and
//! to call the progress callback. Whatever these raise cancels the work and surfaces unchanged.
//! The work never touches Python, and its panics end at the thread's border.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use iva_sweep::done::Done;
use iva_sweep::dynamics::Tracker;
use iva_sweep::sweep::{STACK, SweepError};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::errors::{failed, internal};

const WAKE: Duration = Duration::from_millis(50);
/// Longest wait for cancelled work; after it the work is left to end by itself.
const PATIENCE: Duration = Duration::from_millis(900);
/// The same for work that returns what it has: on a busy machine that may take longer, and is not to be lost.
const PATIENCE_TO_KEEP: Duration = Duration::from_secs(20);

/// The state shared by the work and the calling thread.
#[derive(Default)]
pub struct Shared {
    /// Flag that asks the work to stop.
    pub cancel: AtomicBool,
    /// Number of points finished so far.
    pub done: AtomicU64,
    /// Number of points so far with another outcome than `finished`.
    pub failed: AtomicU64,
}

impl Shared {
    /// Flag and count for work that returns what it has once it is cancelled.
    pub fn tracker(&self) -> Tracker<'_> {
        Tracker { cancel: &self.cancel, done: &self.done }
    }

    /// Adds finished points to the counts.
    pub fn add(&self, done: Done) {
        self.failed.fetch_add(done.failed, Ordering::Relaxed);
        self.done.fetch_add(done.points, Ordering::Relaxed);
    }
}

/// A Python callable for progress, called with (done, total, failed) when a change is seen.
pub struct Progress<'a, 'py> {
    /// The callable.
    pub callback: &'a Bound<'py, PyAny>,
    /// Number of points of the whole call; 0: it is not known.
    pub total: u64,
}

/// Runs `work` on its own thread until it ends, or until a signal handler or `progress` raises.
///
/// # Errors
/// What [`failed`] makes of the error, `IvaError` for a panic, and what handler or callback raised.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Progress<'_, '_>>,
    work: impl FnOnce(&Shared) -> Result<T, SweepError> + Send + 'static,
) -> PyResult<T> {
    run_any(py, progress, work)?.map_err(failed)
}

/// Runs `work` like [`run`], but returns its error, of any type, instead of raising it.
///
/// # Errors
/// `IvaError` for a panic, and what handler or callback raised.
pub fn run_any<T: Send + 'static, E: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Progress<'_, '_>>,
    work: impl FnOnce(&Shared) -> Result<T, E> + Send + 'static,
) -> PyResult<Result<T, E>> {
    match attended(py, progress, PATIENCE, work)? {
        (_, Some(raised)) => Err(raised),
        (Some(result), None) => Ok(result),
        (None, None) => Err(internal("work without a result")),
    }
}

/// The result of work, if there is one, and what was raised meanwhile.
type Attended<T, E> = (Option<Result<T, E>>, Option<PyErr>);

/// The result of `work`, and what handler or callback raised meanwhile. After a `KeyboardInterrupt` there may be both.
fn attended<T: Send + 'static, E: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Progress<'_, '_>>,
    patience: Duration,
    work: impl FnOnce(&Shared) -> Result<T, E> + Send + 'static,
) -> PyResult<Attended<T, E>> {
    let shared = Arc::new(Shared::default());
    let (sender, mut receiver) = channel();
    let theirs = Arc::clone(&shared);
    thread::Builder::new()
        .name("iva".to_owned())
        .stack_size(STACK)
        .spawn(move || {
            let result = catch_unwind(AssertUnwindSafe(|| work(&theirs)));
            // The receiver is gone if an interrupted caller has stopped waiting.
            let _ = sender.send(result);
        })
        .map_err(|error| internal(&format!("cannot start a thread: {error}")))?;

    let mut reported = 0;
    loop {
        let (back, message) = py.detach(move || wait(receiver, WAKE));
        receiver = back;
        let ended = !matches!(message, Err(RecvTimeoutError::Timeout));
        let done = shared.done.load(Ordering::Relaxed);
        let attended = py.check_signals().and_then(|()| match progress {
            Some(progress) if done != reported => {
                reported = done;
                let failed = shared.failed.load(Ordering::Relaxed);
                progress.callback.call1((done, progress.total, failed)).map(drop)
            }
            _ => Ok(()),
        });
        if let Err(raised) = attended {
            shared.cancel.store(true, Ordering::Relaxed);
            let last = if ended { message } else { py.detach(move || wait(receiver, patience).1) };
            let partial = last.ok().and_then(Result::ok);
            let kept = partial.filter(|_| raised.is_instance_of::<PyKeyboardInterrupt>(py));
            return Ok((kept, Some(raised)));
        }
        match message {
            Ok(Ok(result)) => return Ok((Some(result), None)),
            Ok(Err(panic)) => return Err(internal(words(&*panic))),
            Err(RecvTimeoutError::Disconnected) => return Err(internal("a thread vanished")),
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Runs `work` like [`run_any`], whose result is what it has so far if it is cancelled: that goes with the
/// `KeyboardInterrupt` that cancelled it, if it comes soon.
///
/// # Errors
/// As [`run_any`].
pub fn run_partly<T: Send + 'static, E: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Progress<'_, '_>>,
    work: impl FnOnce(&Shared) -> Result<T, E> + Send + 'static,
) -> PyResult<(Result<T, E>, Option<PyErr>)> {
    match attended(py, progress, PATIENCE_TO_KEEP, work)? {
        (Some(result), raised) => Ok((result, raised)),
        (None, Some(raised)) => Err(raised),
        (None, None) => Err(internal("work without a result")),
    }
}

/// Runs work of some milliseconds on the calling thread.
///
/// # Errors
/// What [`failed`] makes of the error, and `IvaError` for a panic.
pub fn at_once<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, SweepError> + Send,
) -> PyResult<T> {
    match py.detach(|| catch_unwind(AssertUnwindSafe(work))) {
        Ok(result) => result.map_err(failed),
        Err(panic) => Err(internal(words(&*panic))),
    }
}

type Message<T> = Result<thread::Result<T>, RecvTimeoutError>;
type Mailbox<T> = Receiver<thread::Result<T>>;

fn wait<T>(receiver: Mailbox<T>, time: Duration) -> (Mailbox<T>, Message<T>) {
    let message = receiver.recv_timeout(time);
    (receiver, message)
}

fn words(panic: &(dyn Any + Send)) -> &str {
    panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("a panic without words")
}
