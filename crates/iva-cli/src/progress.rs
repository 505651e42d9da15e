//! The progress bar of a command on standard error, hidden unless that is a terminal.

use std::fmt::Write;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use iva_sweep::done::Done;
use iva_sweep::dynamics::Tracker;

/// Template of the bar, at most 80 columns wide.
const TEMPLATE: &str = "{prefix} {bar:20} {percent:>3} %  {pos}/{len}  {rate}  {eta} left{msg}";
/// Template where it is not known how many there will be.
const COUNT: &str = "{prefix} {pos}  {rate}";
/// Interval at which the bar is redrawn even if no point finishes.
const TICK: Duration = Duration::from_millis(200);

/// A progress bar that counts finished points, from any thread.
pub(crate) struct Progress {
    bar: ProgressBar,
    failed: AtomicU64,
}

impl Progress {
    /// Shows a bar and starts its clock; `doing` is the word before it, and `total` how many points there will be, if
    /// that is known.
    pub(crate) fn new(doing: &'static str, total: Option<u64>, quiet: bool) -> Self {
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(total, target).with_prefix(doing);
        let template = if total.is_some() { TEMPLATE } else { COUNT };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.with_key("rate", write_rate));
        }
        if !bar.is_hidden() {
            bar.enable_steady_tick(TICK);
        }
        Self { bar, failed: AtomicU64::new(0) }
    }

    /// Sets the points that were finished earlier; they count neither for the rate nor for the time left.
    pub(crate) fn begin_at(&self, points: u64, failed: u64) {
        self.bar.set_position(points);
        self.bar.reset_eta();
        self.show_failed(failed);
    }

    /// Adds finished points.
    pub(crate) fn add(&self, points: u64) {
        self.bar.inc(points);
    }

    /// Adds finished points and shows how many points have failed so far.
    pub(crate) fn done(&self, done: Done) {
        self.show_failed(done.failed);
        self.add(done.points);
    }

    fn show_failed(&self, more: u64) {
        let failed = more + self.failed.fetch_add(more, Ordering::Relaxed);
        if more > 0 {
            self.bar.set_message(format!("  {failed} failed"));
        }
    }

    /// Prints a line above the bar.
    pub(crate) fn say(&self, line: &str) {
        self.bar.suspend(|| eprintln!("{line}"));
    }

    /// Removes the bar.
    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Does work that counts what it has done, beside a bar that shows it; `doing` and `total` are those of [`Progress::new`].
pub(crate) fn watched<T: Send>(
    doing: &'static str,
    total: Option<u64>,
    cancel: &AtomicBool,
    work: impl FnOnce(Tracker<'_>) -> T + Send,
) -> T {
    let (progress, done) = (Progress::new(doing, total, false), AtomicU64::new(0));
    let ended = thread::scope(|scope| {
        let (working, ends) = channel::<()>();
        let tracker = Tracker { cancel, done: &done };
        let job = scope.spawn(move || {
            // The channel closes with the work, also by a panic.
            let _working = working;
            work(tracker)
        });
        while ends.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
            progress.bar.set_position(done.load(Ordering::Relaxed));
        }
        job.join()
    });
    progress.clear();
    ended.unwrap_or_else(|panic| resume_unwind(panic))
}

/// Writes the rate in points a second, with fewer decimals than the bar by default.
fn write_rate(state: &ProgressState, to: &mut dyn Write) {
    let decimals = if state.per_sec() < 10.0 { 1 } else { 0 };
    // A failure to write to the terminal is ignored.
    let _ = write!(to, "{:.decimals$}/s", state.per_sec());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_work_ends_with_comes_through() {
        let cancel = AtomicBool::new(false);
        let counted = |tracker: Tracker<'_>| tracker.done.fetch_add(7, Ordering::Relaxed);
        assert_eq!(watched("running", Some(7), &cancel, counted), 0);
        let panics = || watched("running", None, &cancel, |_| -> u64 { panic!("of the work") });
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(panics)).is_err());
    }

    #[test]
    fn the_templates_are_some_that_the_bar_understands() {
        for template in [TEMPLATE, COUNT] {
            assert!(ProgressStyle::with_template(template).is_ok(), "{template}");
        }
    }
}
