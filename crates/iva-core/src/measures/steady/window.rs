//! The part of a run that counts as its steady state, and the strobes in it.

use super::regime::RETURNS_KEPT;
use crate::force::Harmonic;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// The window of a steady state.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window<R = f64> {
    /// Instant in 1/ωn from which measures count: the end of the transient.
    pub from: R,
    /// The harmonic force whose cycles are counted; `None` if no force is harmonic.
    pub cycle: Option<Harmonic<R>>,
}

impl<R: Real> Window<R> {
    /// The instant of a strobe, Ω t + phase = 2π k; index 0 is the first at or after time zero.
    pub(super) fn instant(&self, index: u64) -> Option<DoubleDouble<R>> {
        let Harmonic { frequency, phase, .. } = self.cycle?;
        let first = (phase / R::TURN.value).ceil();
        let turns = R::TURN.times(first + index as f64);
        Some(turns.plus(-phase).over(frequency))
    }
}

impl<R: Real> Window<R> {
    /// Index of the first strobe of the window, or of one a little before.
    pub(super) fn first(&self) -> u64 {
        self.before(self.from).saturating_sub(1)
    }

    /// Number of strobes before an instant, within rounding.
    fn before(&self, instant: R) -> u64 {
        let Some(Harmonic { frequency, phase, .. }) = self.cycle else { return 0 };
        let first = (phase / R::TURN.value).ceil();
        let count = (frequency * instant + phase) / R::TURN.value - first;
        count.max(0.0).whole() as u64
    }

    /// Index of the first strobe that the regime depends on, or of one a little before.
    pub(super) fn last_kept(&self, duration: R) -> u64 {
        self.before(duration).saturating_sub(RETURNS_KEPT as u64 + 1)
    }
}
