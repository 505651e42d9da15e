//! A single line on standard error that tells how far a sweep is; silent unless it is a terminal.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::layout::WIDTH;

const BETWEEN_LINES: Duration = Duration::from_millis(100);

/// Counts finished points and shows them from whatever thread finishes them.
pub(crate) struct Progress {
    total: u64,
    done: AtomicU64,
    start: Instant,
    /// When the line was last written; `None`: nothing is shown.
    shown: Option<Mutex<Instant>>,
}

impl Progress {
    /// Starts the clock.
    pub(crate) fn new(total: u64, quiet: bool) -> Self {
        let now = Instant::now();
        let visible = !quiet && std::io::stderr().is_terminal();
        Self { total, done: AtomicU64::new(0), start: now, shown: visible.then(|| Mutex::new(now)) }
    }

    /// Adds finished points.
    pub(crate) fn add(&self, points: u64) {
        let done = self.done.fetch_add(points, Ordering::Relaxed) + points;
        let Some(shown) = &self.shown else { return };
        // Whoever finds the line being written moves on.
        let Ok(mut last) = shown.try_lock() else {
            return;
        };
        if last.elapsed() < BETWEEN_LINES {
            return;
        }
        *last = Instant::now();
        rewrite(&line(done, self.total, self.start.elapsed()));
    }

    /// Removes the line.
    pub(crate) fn clear(&self) {
        if self.shown.is_some() {
            rewrite("");
        }
    }
}

fn rewrite(line: &str) {
    // Nothing is lost if a progress line cannot be shown.
    let _ = write!(std::io::stderr(), "\r{line:<width$}\r{line}", width = WIDTH - 1);
}

fn line(done: u64, total: u64, elapsed: Duration) -> String {
    let seconds = elapsed.as_secs_f64().max(1e-9);
    let rate = done as f64 / seconds;
    let left = total.saturating_sub(done) as f64 / rate.max(1e-9);
    let percent = done.saturating_mul(100) / total.max(1);
    format!("{done} of {total} points ({percent} %), {rate:.0} a second, {} left", duration(left))
}

/// A time in words, to two figures.
pub(crate) fn duration(seconds: f64) -> String {
    if seconds < 1e-3 {
        "less than 1 ms".to_owned()
    } else if seconds < 1.0 {
        format!("{:.0} ms", seconds * 1e3)
    } else if seconds < 10.0 {
        format!("{seconds:.1} s")
    } else if seconds < 120.0 {
        format!("{seconds:.0} s")
    } else if seconds < 7200.0 {
        format!("{:.0} min", seconds / 60.0)
    } else if seconds < 172_800.0 {
        format!("{:.1} h", seconds / 3600.0)
    } else {
        format!("{:.1} days", seconds / 86_400.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_is_short_whatever_the_numbers() {
        let text = line(1 << 31, 1 << 32, Duration::from_secs(3600));
        assert!(text.chars().count() < WIDTH, "{text}");
        assert!(text.contains("(50 %)") && text.contains("60 min left"), "{text}");
    }
}
