//! Flights that change nothing in the measures of a steady state but ∫x², so that lanes need not show them.

use super::{Steady, SteadyWanted};
use crate::absorber::Clock;
use crate::number::arrays::{Laned, laned};
use crate::number::clock::SLACK;
use crate::number::compensated::DoubleDouble;

/// The flights that need not be shown, and their ∫x².
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quiet {
    /// The begin of the window.
    from: f64,
    /// Quiet flights end before this instant, that of the next strobe.
    until: f64,
    /// In quiet flights of the window |x| and |ẍ + a_g| are smaller than these.
    least: [f64; 2],
    /// ∫x² of the window so far.
    square: DoubleDouble,
}

laned!(Quiet, AllQuiet { from: f64, until: f64, least: [f64; 2], square: DoubleDouble });

impl Quiet {
    /// Without measures of a steady state: all flights are quiet.
    pub const ALL: Self = Self {
        from: f64::INFINITY,
        until: f64::INFINITY,
        least: [f64::INFINITY; 2],
        square: DoubleDouble::ZERO,
    };

    /// True if a flight between two instants, with these bounds on |x| and |ẍ + a_g|, needs not be shown.
    #[inline(always)]
    pub fn covers(&self, [start, end]: [Clock; 2], [x, a]: [f64; 2]) -> bool {
        let small = (x < self.least[0]) & (a < self.least[1]) & self.counts(start);
        let early = end.minus(self.from) <= 0.0;
        (end.minus(self.until) < 0.0) & (small | early)
    }

    /// True if a flight from an instant on belongs to the window.
    #[inline(always)]
    fn counts(&self, start: Clock) -> bool {
        start.minus(self.from) >= 0.0
    }

    /// With ∫x² of a flight from an instant on, if it is `covered` and belongs to the window.
    #[inline(always)]
    pub fn with(&self, covered: bool, start: Clock, square: f64) -> Self {
        let counts = covered & self.counts(start);
        Self { square: Laned::pick(counts, &self.square.plus(square), &self.square), ..*self }
    }
}

impl Steady {
    /// The flights that need not be shown from here on.
    pub(crate) fn quiet(&self) -> Quiet {
        if !self.wanted.any() {
            return Quiet::ALL;
        }
        let strobe = self.next_strobe().map_or(f64::INFINITY, |instant| instant.value);
        let [x, a] = self.largest();
        let SteadyWanted { amplitude, regime, acceleration, .. } = self.wanted;
        Quiet {
            from: self.window.from,
            // A strobe may be taken a little after the end of the last flight.
            until: strobe - self.duration * (4.0 * SLACK),
            least: [
                if amplitude || regime { x } else { f64::INFINITY },
                if acceleration { a } else { f64::INFINITY },
            ],
            square: self.square,
        }
    }

    /// Takes over ∫x² of the window so far, to which quiet flights have been added.
    pub(crate) fn take_square(&mut self, quiet: &Quiet) {
        self.square = quiet.square;
    }
}
