//! The part of a run that counts as its steady state, and the strobes in it.

use super::regime::RETURNS_KEPT;
use crate::compensated::DoubleDouble;
use crate::force::Harmonic;
use crate::real::Real;

/// What a steady state is measured by.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window<R = f64> {
    /// Instant from which on it counts: the end of the transient.
    pub from: R,
    /// The force whose cycles count; `None` if none of the forces has any.
    pub cycle: Option<Harmonic<R>>,
}

impl<R: Real> Window<R> {
    /// The instants Ω t + phase = 2π k, from the first at or after time zero on.
    pub(super) fn instant(&self, index: u64) -> Option<DoubleDouble<R>> {
        let Harmonic { frequency, phase, .. } = self.cycle?;
        let first = (phase / R::TURN.value).ceil();
        let turns = R::TURN.times(first + index as f64);
        Some(turns.plus(-phase).over(frequency))
    }
}

impl<R: Real> Window<R> {
    /// The first strobe of the window, or one a little before.
    pub(super) fn first(&self) -> u64 {
        self.before(self.from).saturating_sub(1)
    }

    /// How many strobes there are before an instant, but for rounding.
    fn before(&self, instant: R) -> u64 {
        let Some(Harmonic { frequency, phase, .. }) = self.cycle else { return 0 };
        let first = (phase / R::TURN.value).ceil();
        let count = (frequency * instant + phase) / R::TURN.value - first;
        count.max(0.0).whole() as u64
    }

    /// The first strobe that a regime is told by, or one a little before.
    pub(super) fn last_kept(&self, duration: R) -> u64 {
        self.before(duration).saturating_sub(RETURNS_KEPT as u64 + 1)
    }
}
