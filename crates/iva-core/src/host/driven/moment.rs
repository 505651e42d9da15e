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
    /// The longest smooth motion that is no longer than `reach`: its length, and the instant at which the drive bends,
    /// jumps or has an impulse, if that ends it.
    #[inline(always)]
    pub(super) fn until_bend(&self, reach: R) -> (R, Option<Clock<R>>) {
        let until = |bend: Clock<R>| (bend - self.time).value;
        match self.smooth.end.filter(|bend| until(*bend) <= reach) {
            Some(bend) => (until(bend), Some(bend)),
            None => (reach, None),
        }
    }

    /// True if its piece has ended.
    #[inline(always)]
    pub(super) fn is_over(&self) -> bool {
        self.smooth.end.is_some_and(|end| (end - self.time).value <= 0.0)
    }
}
