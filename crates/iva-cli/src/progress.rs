//! The progress bar of a sweep on standard error, hidden unless that is a terminal.

use std::fmt::Write;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use iva_sweep::done::Done;

/// Template of the bar, at most 80 columns wide.
const TEMPLATE: &str = "{prefix} {bar:20} {percent:>3} %  {pos}/{len}  {rate}  {eta} left{msg}";
/// Interval at which the bar is redrawn even if no point finishes.
const TICK: Duration = Duration::from_millis(200);

/// A progress bar that counts finished points, from any thread.
pub(crate) struct Progress {
    bar: ProgressBar,
    failed: AtomicU64,
}

impl Progress {
    /// Shows a bar and starts its clock; `doing` is the word before it.
    pub(crate) fn new(doing: &'static str, total: u64, quiet: bool) -> Self {
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(total), target).with_prefix(doing);
        if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
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
    fn the_template_is_one_that_the_bar_understands() {
        assert!(ProgressStyle::with_template(TEMPLATE).is_ok());
    }
}
