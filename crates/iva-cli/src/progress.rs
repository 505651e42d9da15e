//! A bar on standard error that tells how far a sweep is; silent unless that is a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// What is shown, in at most 80 columns.
const TEMPLATE: &str = "{msg} {bar:24} {percent:>3} %  {pos}/{len}  {per_sec}  {eta} left";
/// How often the bar moves on by itself, so that long points show that time passes.
const TICK: Duration = Duration::from_millis(200);

/// Counts finished points and shows them from whatever thread finishes them.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// Starts the clock; `doing` says what is done to the points.
    pub(crate) fn new(doing: &'static str, total: u64, quiet: bool) -> Self {
        let target =
            if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(total), target).with_message(doing);
        if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
            bar.set_style(style);
        }
        if !bar.is_hidden() {
            bar.enable_steady_tick(TICK);
        }
        Self(bar)
    }

    /// Adds finished points.
    pub(crate) fn add(&self, points: u64) {
        self.0.inc(points);
    }

    /// Removes the bar.
    pub(crate) fn clear(&self) {
        self.0.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_one_that_the_bar_understands() {
        assert!(ProgressStyle::with_template(TEMPLATE).is_ok());
    }
}
