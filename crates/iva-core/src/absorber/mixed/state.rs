//! The state of a structure and of the free masses and pendulums on it.

use super::{MOST, Member};
use crate::absorber::Wall;
use crate::absorber::piva::PivaState;
use crate::host::oscillator::Primary;
use crate::host::{Host, Phase};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::GapPoint;

/// The place of one absorber in its gap, and its velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed<R> {
    /// The wall that the distance is measured from.
    pub(crate) wall: Wall,
    pub(crate) distance: DoubleDouble<R>,
    /// W = b θ̇; ẏ of a free mass.
    pub(crate) w: DoubleDouble<R>,
    /// cosθ; 1 for a free mass.
    pub(crate) cosine: DoubleDouble<R>,
    /// True if it is stuck to that wall.
    pub(crate) stuck: bool,
    /// True just after a release, where W and Ẇ are exactly 0.
    pub(crate) released: bool,
}

/// The state of the structure and of its absorbers between events.
#[derive(Debug, PartialEq)]
pub struct MixedState<H: Host> {
    /// The state of the drive.
    pub(crate) phase: Phase<H>,
    pub(crate) primary: Primary<H::Real>,
    /// Those after the last absorber mean nothing.
    pub(crate) places: [Placed<H::Real>; MOST],
    /// The index of the absorber at hand.
    pub(crate) at_hand: u8,
}

impl<H: Host> Clone for MixedState<H> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<H: Host> Copy for MixedState<H> {}

impl<R: Real> Placed<R> {
    /// The place of an absorber that is not there.
    pub(super) const UNUSED: Self = Self {
        wall: Wall::Plus,
        distance: DoubleDouble { value: R::ONE, rest: R::ZERO },
        w: DoubleDouble::ZERO,
        cosine: DoubleDouble { value: R::ONE, rest: R::ZERO },
        stuck: false,
        released: false,
    };

    /// The same place with the angle, distance and velocity of a state of one absorber.
    pub(super) fn moved_to<P>(&self, seen: &PivaState<P, R>) -> Self {
        let PivaState { wall, distance, w, cosine, .. } = *seen;
        Self { wall, distance, w, cosine, released: false, ..*self }
    }

    /// Gap displacement and gap velocity.
    pub(super) fn gap(&self, member: &Member<R>) -> GapPoint<R> {
        let (d, s) = (member.clearance, self.wall.sign());
        let y = ((d - self.distance.value) * s).clamp(-d, d);
        GapPoint { y: member.offset + y, w: self.cosine.value * self.w.value }
    }

    /// The same place, with the distance measured from the other wall.
    pub(super) fn across(&self, member: &Member<R>) -> Self {
        let across = self.distance.plus(-(member.clearance * 2.0)).negated();
        Self { wall: self.wall.opposite(), distance: across, ..*self }
    }

    /// The rate of the distance.
    pub(super) fn rate(&self) -> R {
        self.cosine.value * self.w.value * -self.wall.sign()
    }

    /// At its wall, with the cosine there.
    pub(super) fn touching(&self, member: &Member<R>) -> Self {
        Self { distance: DoubleDouble::ZERO, cosine: member.stops.cosine, ..*self }
    }
}
