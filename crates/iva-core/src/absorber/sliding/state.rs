//! The state of a mass with friction.

use crate::absorber::siva::SivaState;
use crate::host::Moment;
use crate::number::real::Real;

/// The state of structure and gap between events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlidingState<R: Real = f64> {
    /// The state of a free mass under the gravity that stands for friction in this direction.
    pub(crate) seen: SivaState<Moment<R>, R>,
    /// +1 if it slides up y, −1 if it slides down, 0 if it is held in its gap. At rest on a wall, the direction in which it would
    /// leave.
    pub(crate) direction: R,
}

impl<R: Real> SlidingState<R> {
    /// +1 if the mass slides up y, −1 if it slides down, 0 if friction holds it in its gap. At rest on a wall, the direction in
    /// which it would leave.
    pub fn direction(&self) -> R {
        self.direction
    }

    /// True if friction holds the mass in its gap.
    #[inline]
    pub fn is_held(&self) -> bool {
        self.direction == 0.0
    }
}
