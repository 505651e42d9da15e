//! What the search for the event of a mass follows: its distance in flight, and what has to carry it while it is stuck.

use super::{Modal, Place};
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// A, as the curve of a mass is made of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Followed<'a, R> {
    /// Of the displacement that it is the second derivative of.
    pub shape: &'a [R],
    /// How much of it a pendulum on its wall feels.
    pub factor: R,
    /// True if the acceleration of the base is part of it.
    pub with_base: bool,
    /// What gravity and the spring of a stuck mass add.
    pub constant: DoubleDouble<R>,
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// What the curve of a member is made of: the motion of its gap in flight, that of the point which has to carry it while it is stuck. Not of a pendulum in
    /// flight.
    pub(super) fn followed(&self, k: usize, place: &Place<R>) -> Followed<'_, R> {
        let gravity = DoubleDouble::new(self.gravity[k]);
        if place.carried() && self.grounded(k).is_none() {
            let pulled = gravity + self.pulled(k, place.gap(&self.masses[k]).y);
            let (factor, constant) = (self.follows(k, place), pulled + self.drawn(k, place));
            return Followed { shape: self.shape(k), factor, with_base: true, constant };
        }
        // What reaches a tied mass reaches it by its coordinate.
        let alone = self.tied[k].is_none();
        let constant = if alone { self.pull(k, place) } else { DoubleDouble::ZERO };
        Followed { shape: self.gap_shape(k), factor: R::ONE, with_base: alone, constant }
    }
}
