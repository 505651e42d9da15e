//! The state of a drive at one instant.

use crate::force::{Pushes, Smooth};
use crate::number::arrays::laned;
use crate::number::clock::Clock;
use crate::number::real::Real;

/// The state of a drive at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment<R = f64> {
    /// The instant.
    pub(crate) time: Clock<R>,
    /// Number of impulses that have acted.
    pub(crate) kicks: u32,
    /// The smooth piece that acts from then on, or that ends there if a motion has just ended.
    pub(crate) smooth: Smooth<R>,
    /// f/M, and a_g plus gravity along the motion.
    pub(crate) pushes: Pushes<R>,
}

laned!(Moment, Moments { time: Clock, pushes: Pushes } kicks = 0, smooth = Smooth::ALL);

impl<R: Real> Moment<R> {
    /// The longest smooth motion that is no longer than `reach`.
    #[inline(always)]
    pub(super) fn smooth_for(&self, reach: R) -> R {
        match self.smooth.end.map(|end| (end - self.time).value) {
            Some(until) if until <= reach => until,
            _ => reach,
        }
    }

    /// The instant a time h later; exactly that at which its piece ends, if it is as far as that.
    #[inline(always)]
    pub(super) fn after(&self, h: R) -> Clock<R> {
        let ends = |end: &Clock<R>| (*end - self.time).value == h;
        self.smooth.end.filter(ends).unwrap_or(self.time.plus(h))
    }

    /// The same drive at a later instant of its piece.
    #[inline(always)]
    pub(crate) fn waited(&self, time: Clock<R>) -> Self {
        Self { time: self.time.plus_parts(time.value, time.rest), ..*self }
    }

    /// True if its piece has ended.
    #[inline(always)]
    pub(super) fn is_over(&self) -> bool {
        self.smooth.end.is_some_and(|end| (end - self.time).value <= 0.0)
    }
}
