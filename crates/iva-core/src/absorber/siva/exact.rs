//! A free mass in flight in the exact tier: its state in double-double.

use super::motion::{SivaFlight, after, arrived};
use super::trial::{FreeMass, fast_flight};
use super::{Law, SivaState, collided};
use crate::absorber::plain::State;
use crate::host::oscillator::Primary;
use crate::host::{Host, HostState, Phase, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::{Real, pick};
use crate::segment::flight::FastFlight;

/// A free mass on a structure, and the course of the structure from the begin of the flight.
#[derive(Debug)]
pub(crate) struct InFlight<'a, S: Structure> {
    pub free: &'a S,
    pub course: &'a S::Course,
}

impl<R: Real, S: Structure<Real = R>> FreeMass for InFlight<'_, S> {
    type Real = R;
    type State = SivaState<S::Phase, R>;
    const STRAIGHT: f64 = 1e-3;
    const CLOSE: f64 = 1.0 / 16.0;

    #[inline(always)]
    fn curve(&self, at: &Self::State) -> [R; 3] {
        [at.distance.value, at.rate.value, at.side * at.host.acceleration.value]
    }

    #[inline(always)]
    fn ahead(&self, from: &Self::State, h: R) -> [R; 3] {
        let SivaState { side, distance, rate, .. } = *from;
        let [curved, gained, a] = self.free.ahead(&from.host, self.course, h);
        let moved = rate.value.mul_add(h, side * curved);
        [distance.value + moved, side.mul_add(gained, rate.value), side * a]
    }

    #[inline(always)]
    fn in_doubles(at: &Self::State) -> State {
        at.in_doubles()
    }

    #[inline(always)]
    fn bounds(&self, from: &Self::State) -> [R; 2] {
        let primary = &from.host.primary;
        [self.free.bound::<3>(primary), self.free.bound::<4>(primary)]
    }

    #[inline(always)]
    fn nearly(&self, from: &Self::State, h: R) -> Self::State {
        after(from, &self.free.nearly_flown(&from.host, self.course, h), h)
    }

    #[inline(always)]
    fn near(&self, at: &Self::State, beyond: R) -> [R; 5] {
        let HostState { primary, acceleration, phase } = &at.host;
        let [jerk, snap, _] = self.free.derivatives(phase, primary.v.value, acceleration.value);
        let bends = [acceleration.value, jerk, snap].map(
            #[inline(always)]
            |derivative| at.side * derivative,
        );
        [at.distance.minus(beyond), at.rate.value, bends[0], bends[1], bends[2]]
    }

    #[inline(always)]
    fn touching(&self, at: &Self::State, hit: bool, far: bool, t: R) -> Self::State {
        let HostState { primary: Primary { x, v }, acceleration, phase } = at.host;
        let a = acceleration.value;
        let [jerk, snap, fifth] = self.free.derivatives(&phase, v.value, a);
        // One term more than in the search for the contact: the errors of many impacts would add up.
        let raised = |[a, jerk, snap, fifth]: [R; 4]| {
            t * (a + t * (jerk * 0.5 + t * (snap * (1.0 / 6.0) + t * (fifth * (1.0 / 24.0)))))
        };
        let gained = raised([a, jerk, snap, fifth]);
        let (mut faster, mut moved) = (gained, raised([v.value, a, jerk, snap]));
        if self.free.moves_base() {
            let [base, rate, second, third] = self.free.base(&phase);
            faster -= raised([base, rate, second, third]);
            moved = raised([v.value, a - base, jerk - rate, snap - second]);
        }
        let primary = Primary { x: x.plus(moved), v: v.plus(faster) };
        let phase = self.free.later(&phase, t);
        let acceleration = self.free.acceleration(&phase, &primary);
        let turn = pick(hit & far, -R::ONE, R::ONE);
        let rate = at.rate.plus(at.side * gained);
        let DoubleDouble { value, rest } = at.distance;
        SivaState {
            host: HostState { primary, acceleration, phase },
            side: turn * at.side,
            distance: DoubleDouble {
                value: pick(hit, R::ZERO, value),
                rest: pick(hit, R::ZERO, rest),
            },
            rate: DoubleDouble { value: turn * rate.value, rest: turn * rate.rest },
        }
    }

    #[inline(always)]
    fn arrived(&self, from: &Self::State, h: R) -> Self::State {
        let mut end = arrived(self.free, self.course, from, h);
        self.free.refresh(&mut end.host);
        end
    }

    #[inline(always)]
    fn struck(&self, touching: &Self::State, hit: bool, law: &Law<R>) -> Self::State {
        collided(self.free, touching, hit, law)
    }
}

impl<R: Real, H: Host<Real = R>> SivaFlight<'_, H> {
    /// The end of a flight of this length, or of a part of it, if that is decided in closed form.
    #[inline(always)]
    pub(super) fn fast_flight(&self, length: R) -> Option<FastFlight<SivaState<Phase<H>, R>, R>> {
        let mass = InFlight { free: self.structure(), course: &self.course };
        fast_flight(&mass, &self.from, length, self.siva.mass.clearance)
    }
}
