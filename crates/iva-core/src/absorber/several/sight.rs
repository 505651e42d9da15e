//! What the values at both ends of a flight prove at once about one of several masses, without branches.

use super::InGap;
use crate::absorber::siva::exact::InFlight;
use crate::host::oscillator::Arrival;
use crate::host::{HostState, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::{Real, pick};
use crate::segment::contact::{nearest, only_contacts, stays_clear};

/// A flight of the structure, seen from both ends: the states of the structure, and its length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ends<'a, P, R> {
    pub begin: &'a HostState<P, R>,
    pub end: &'a HostState<P, R>,
    pub length: R,
}

/// The only contact of a mass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Met<R> {
    /// True if there is one, found within the flight.
    pub sure: bool,
    /// True if it is with the far wall.
    pub far: bool,
    /// Its instant.
    pub h: R,
}

impl<R: Real> InGap<R> {
    /// The place of a mass in flight after a motion of length h, in which the structure has gained this.
    #[inline(always)]
    pub(crate) fn flown(&self, gained: &Arrival<R>, h: R) -> Self {
        let sided = |sum: DoubleDouble<R>| DoubleDouble {
            value: self.side * sum.value,
            rest: self.side * sum.rest,
        };
        let straight = self.rate.product(DoubleDouble::new(h));
        Self {
            distance: self.distance.plus_both(straight, sided(gained.curved)),
            rate: self.rate + sided(gained.velocity),
            ..*self
        }
    }

    /// True if it is proved that a mass in flight meets no wall on its way to a place.
    #[inline(always)]
    pub(crate) fn clears<S: Structure<Real = R>>(
        &self,
        to: &Self,
        structure: &S,
        ends: &Ends<'_, S::Phase, R>,
        clearance: R,
    ) -> bool {
        let seen = |it: &Self| [it.distance.value, it.rate.value];
        let fourth = structure.bound::<2>(&ends.begin.primary);
        stays_clear([seen(self), seen(to)], clearance, fourth, ends.length)
    }

    /// The only contact of a mass in flight on its way to a place, by Newton's method.
    #[inline(always)]
    pub(crate) fn meets<S: Structure<Real = R>>(
        &self,
        to: &Self,
        InFlight { free, course }: &InFlight<'_, S>,
        Ends { begin, end, length }: &Ends<'_, S::Phase, R>,
        clearance: R,
    ) -> Met<R> {
        let fourth = free.bound::<2>(&begin.primary);
        let [values, rates] = [[self.distance, to.distance], [self.rate, to.rate]];
        let ends = [values, rates].map(
            #[inline(always)]
            |ends| [ends[0].value, ends[1].value],
        );
        let [near, far] = only_contacts(ends, clearance, clearance, fourth, *length);
        let level = pick(far, clearance * 2.0, R::ZERO);
        let bends = [self.side * begin.acceleration.value, self.side * end.acceleration.value];
        let [[distance, _], [rate, _]] = ends;
        let (h, close) = nearest(
            ends,
            bends,
            level,
            *length,
            #[inline(always)]
            |h| {
                let [curved, gained, _] = free.ahead(begin, course, h);
                let off = (distance - level) + (rate * h + self.side * curved);
                [off, rate + self.side * gained]
            },
        );
        Met { sure: (near | far) & close, far, h }
    }
}
