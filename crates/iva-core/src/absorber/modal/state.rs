//! The state of the modes and of the masses.

use super::{MOST, MOST_MODES};
use crate::absorber::Wall;
use crate::absorber::plain::State;
use crate::absorber::siva::FreeMass;
use crate::host::oscillator::Primary;
use crate::host::{Host, Phase};
use crate::number::compensated::{DoubleDouble, two_product, two_sum};
use crate::number::real::Real;
use crate::segment::flight::GapPoint;

/// qⱼ and q̇ⱼ; those beyond the number of modes are 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modes<R = f64, const M: usize = MOST_MODES> {
    /// qⱼ.
    pub places: [DoubleDouble<R>; M],
    /// q̇ⱼ.
    pub velocities: [DoubleDouble<R>; M],
}

/// The place of one mass in its gap, its velocity, and the motion of the structure there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place<R = f64> {
    /// Sign of the wall that the distance is measured from.
    pub(super) side: R,
    pub(super) distance: DoubleDouble<R>,
    pub(super) rate: DoubleDouble<R>,
    /// True if the mass is stuck to that wall.
    pub(super) stuck: bool,
    /// True if friction holds the mass in its gap.
    pub(super) held: bool,
    /// The sign of the gap velocity of a mass that rubs, or with which it would leave its wall; 0 of others, and of one that is held.
    pub(super) sliding: R,
    /// True at a release or where a slide begins, at which A is 0 without rounding.
    pub(super) leaves: bool,
}

/// A, as the curve of one absorber is made of it, and its first three derivatives, where they are known already.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Felt<R> {
    pub of: usize,
    pub shaken: [R; 4],
}

/// The state of a structure with modes and of its masses between events.
#[derive(Debug, PartialEq)]
pub struct ModalState<H: Host, const N: usize = MOST, const M: usize = MOST_MODES> {
    pub(super) modes: Modes<H::Real, M>,
    pub(super) places: [Place<H::Real>; N],
    /// The state of the drive.
    pub(super) phase: Phase<H>,
    /// The index of the absorber at hand.
    pub(super) at_hand: u8,
    pub(super) felt: Option<Felt<H::Real>>,
}

impl<H: Host, const N: usize, const M: usize> Clone for ModalState<H, N, M> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<H: Host, const N: usize, const M: usize> Copy for ModalState<H, N, M> {}

impl<H: Host, const N: usize, const M: usize> ModalState<H, N, M> {
    /// After a change of what accelerates the structure.
    #[inline(always)]
    pub(super) fn renew(&mut self) {
        self.felt = None;
        self.places.iter_mut().for_each(|place| place.leaves = false);
    }

    /// The same state, after such a change.
    #[inline(always)]
    pub(super) fn renewed(&self) -> Self {
        let mut renewed = *self;
        renewed.renew();
        renewed
    }

    /// Which way a mass that rubs goes: +1 up y, −1 down, 0 if friction holds it in its gap; at rest on a wall, the direction in which it would
    /// leave. `None` without such a mass.
    pub fn direction(&self, mass: usize) -> Option<H::Real> {
        self.places.get(mass).map(|place| place.sliding)
    }

    /// A and its derivatives of a mass, if they are known.
    #[inline(always)]
    pub(super) fn felt_by(&self, k: usize) -> Option<[H::Real; 4]> {
        self.felt.filter(|felt| felt.of == k).map(|felt| felt.shaken)
    }

    /// qⱼ and q̇ⱼ.
    pub fn modes(&self) -> &Modes<H::Real, M> {
        &self.modes
    }
}

impl<R: Real, const M: usize> Modes<R, M> {
    /// At rest in the middle.
    pub(super) const REST: Self =
        Self { places: [DoubleDouble::ZERO; M], velocities: [DoubleDouble::ZERO; M] };

    /// Displacement and velocity of a point of this shape.
    pub(super) fn of_point(&self, shape: &[R]) -> [DoubleDouble<R>; 2] {
        // Normalised at the end only, so that a term waits for one addition of that before.
        let mut sums = [[R::ZERO; 2]; 2];
        for ((q, v), phi) in self.places.iter().zip(&self.velocities).zip(shape) {
            for ([sum, rest], part) in sums.iter_mut().zip([q, v]) {
                let (product, lost) = two_product(*phi, part.value);
                let (more, left) = two_sum(*sum, product);
                (*sum, *rest) = (more, *rest + (left + phi.mul_add(part.rest, lost)));
            }
        }
        sums.map(|[sum, rest]| DoubleDouble::new(sum).plus_parts(R::ZERO, rest))
    }

    /// The modes after an impulse on the point of this shape.
    pub(super) fn push(&mut self, shape: &[R], impulse: DoubleDouble<R>) {
        for (v, phi) in self.velocities.iter_mut().zip(shape) {
            *v = *v + impulse.times(*phi);
        }
    }
}

impl<R: Real> Place<R> {
    /// Far from its walls, over a structure at rest.
    pub(super) const FAR: Self = Self {
        side: R::ONE,
        distance: DoubleDouble { value: R::ONE, rest: R::ZERO },
        rate: DoubleDouble::ZERO,
        stuck: false,
        held: false,
        sliding: R::ZERO,
        leaves: false,
    };

    /// True if the mass moves with its point: stuck to a wall, or held in its gap.
    #[inline(always)]
    pub(super) fn carried(&self) -> bool {
        self.stuck || self.held
    }

    /// The same in doubles, on a structure that moves as one.
    #[inline(always)]
    pub(super) fn in_doubles(&self, structure: &Primary<R>) -> State {
        let Primary { x, v } = structure;
        let [x, v, distance, rate, side] =
            [x.value, v.value, self.distance.value, self.rate.value, self.side].map(Real::double);
        State { x, v, distance, rate, side, ..State::default() }
    }

    /// Gap displacement and gap velocity.
    pub(super) fn gap(&self, mass: &FreeMass<R>) -> GapPoint<R> {
        let d = mass.clearance;
        let within = (d - self.distance.value).min(d);
        let y = self.side * within.max(-mass.half_play());
        GapPoint { y: mass.offset + y, w: -self.side * self.rate.value }
    }

    /// The same place, with the distance measured from a wall.
    pub(super) fn measured_from(&self, wall: Wall, mass: &FreeMass<R>) -> Self {
        let side = R::from(wall.sign());
        if side == self.side {
            return *self;
        }
        let across = self.distance.plus(-(mass.clearance * 2.0)).negated();
        Self { side, distance: across, rate: self.rate.negated(), ..*self }
    }

    /// The place a short time later, with this A.
    pub(super) fn moved(&self, time: R, acceleration: R) -> Self {
        if self.carried() {
            return *self;
        }
        let distance = self.distance.plus(self.rate.value * time);
        let gained = acceleration * time;
        Self { distance, rate: self.rate.plus(self.side * gained), leaves: false, ..*self }
    }
}
