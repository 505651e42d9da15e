//! The state of a structure and of the masses on it.

use super::MOST;
use crate::absorber::Wall;
use crate::absorber::plain::State;
use crate::absorber::siva::FreeMass;
use crate::host::oscillator::Primary;
use crate::host::{Host, HostState, Phase};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::GapPoint;

/// The place of one mass in its gap, and its velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InGap<R = f64> {
    /// Sign of the wall that the distance is measured from.
    pub(crate) side: R,
    pub(crate) distance: DoubleDouble<R>,
    pub(crate) rate: DoubleDouble<R>,
    /// True if the mass is stuck to that wall.
    pub(crate) stuck: bool,
}

/// The state of the structure and of its masses between events.
#[derive(Debug, PartialEq)]
pub struct SeveralState<H: Host, const N: usize = MOST> {
    /// The structure, with A of its mass and of those that are stuck to it.
    pub(crate) host: HostState<Phase<H>, H::Real>,
    pub(crate) masses: [InGap<H::Real>; N],
    /// The index of the absorber at hand.
    pub(crate) at_hand: u8,
}

impl<H: Host, const N: usize> Clone for SeveralState<H, N> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<H: Host, const N: usize> Copy for SeveralState<H, N> {}

impl<R: Real> InGap<R> {
    /// The place of a mass that is not there.
    pub(crate) const UNUSED: Self = Self {
        side: R::ONE,
        distance: DoubleDouble { value: R::ONE, rest: R::ZERO },
        rate: DoubleDouble::ZERO,
        stuck: false,
    };

    /// The same in doubles, on a structure.
    #[inline(always)]
    pub(crate) fn in_doubles(&self, structure: &Primary<R>) -> State {
        let Primary { x, v } = structure;
        let [x, v, distance, rate, side] =
            [x.value, v.value, self.distance.value, self.rate.value, self.side].map(Real::double);
        State { x, v, distance, rate, side, ..State::default() }
    }

    /// Gap displacement and gap velocity.
    pub(crate) fn gap(&self, mass: &FreeMass<R>) -> GapPoint<R> {
        let d = mass.clearance;
        let y = (self.side * (d - self.distance.value)).clamp(-d, d);
        GapPoint { y: mass.offset + y, w: -self.side * self.rate.value }
    }

    /// The same place, with the distance measured from a wall.
    pub(crate) fn measured_from(&self, wall: Wall, mass: &FreeMass<R>) -> Self {
        if R::from(wall.sign()) == self.side { *self } else { self.across(mass.clearance) }
    }

    /// The same place, with the distance measured from the other wall of a gap of this clearance.
    #[inline(always)]
    pub(crate) fn across(&self, clearance: R) -> Self {
        let distance = self.distance.plus(-(clearance * 2.0)).negated();
        Self { side: -self.side, distance, rate: self.rate.negated(), stuck: self.stuck }
    }

    /// The place a short time later, in which the structure's absolute velocity changes by `gained`.
    #[inline(always)]
    pub(crate) fn moved(&self, time: R, gained: R) -> Self {
        let distance = self.distance.plus(self.rate.value * time);
        Self { distance, rate: self.rate.plus(self.side * gained), ..*self }
    }
}
