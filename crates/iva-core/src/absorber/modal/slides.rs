//! The ends of slides and of holds: stops, contacts and slips.

use super::ModalMotion;
use super::friction::DOUBT;
use super::state::Place;
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::contact::{first_release, keeps_pressing, meeting, stays_clear_by};
use crate::segment::enclosure::Enclosure;
use crate::segment::flight::{Curve, Jet, Motion as _, Side};
use crate::segment::slide::{Ends, Slip};

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> ModalMotion<'_, H, N, M> {
    /// True if it is proved that the absorber at hand does not stop between these places.
    pub(super) fn keeps_sliding(&self, [from, to]: [&Place<R>; 2], length: R) -> bool {
        let s = from.sliding;
        let of =
            |place: &Place<R>, shaken: [R; 4]| [-s * place.side * place.rate.value, -s * shaken[0]];
        let last = self.felt(self.at_hand(), length);
        let ends = [of(from, self.felt_first()), of(to, last)];
        let size = ends[0][0].abs()
            + ends[1][0].abs()
            + self.system.terms(&self.from, self.at_hand()) * length;
        keeps_pressing(ends, size, self.fourth_of(4), length)
    }

    /// The end of a slide towards a wall that values at both ends, their derivatives and bounds decide at once: there is nothing but one stop, or
    /// one contact, or the length.
    pub(super) fn sure_end(&self, ahead: Side, length: R) -> Option<(R, Ends)> {
        if !R::FAST_PATHS {
            return None;
        }
        let (k, from) = (self.at_hand(), &self.from.places[self.at_hand()]);
        let along = -from.sliding * from.side;
        let [begin, end] = [R::ZERO, length].map(|h| self.approach(k, h));
        let speeds = [begin, end].map(|[_, rate, bend]| [along * rate, along * bend]);
        let [[speed, bend], [last, last_bend]] = speeds;
        let wide = self.system.masses[k].half_play() * 2.0;
        let left = |distance: R| if ahead == Side::Near { distance } else { wide - distance };
        let doubt = (self.magnitude() * 2.0 + begin[1].abs() * length) * (R::EPSILON * DOUBT);
        let size = speed.abs() + last.abs() + self.system.terms(&self.from, k) * length;
        let fourth = self.fourth_of(4);
        if stays_clear_by(speeds, R::INFINITY, size, fourth, length) {
            if left(end[0]) > doubt {
                return Some((length, Ends::Length));
            }
            // The distance falls all the way, and so comes to 0 once.
            if left(end[0]) >= -doubt {
                return None;
            }
            let level = if ahead == Side::Near { R::ZERO } else { wide };
            let ends = [[begin[0], end[0]], [begin[1], end[1]]];
            let off = |h: R| {
                let [distance, rate, _] = self.approach(k, h);
                [distance - level, rate]
            };
            let h = meeting(ends, [begin[2], end[2]], level, length, off)?;
            return Some((h, Ends::Wall(ahead)));
        }
        let sure = size * (R::EPSILON * DOUBT);
        let falls = Enclosure::new([speed, last], [bend, last_bend], length, fourth);
        if speed <= sure || last >= -sure || !falls.falls(sure * 64.0 / length) {
            return None;
        }
        let bends = [R::ZERO, length].map(|h| along * self.turned(k, h));
        let off = |h: R| {
            let [_, rate, bend] = self.approach(k, h);
            [along * rate, along * bend]
        };
        let ends = [[speed, last], [bend, last_bend]];
        let h = meeting(ends, bends, R::ZERO, length, off)?;
        (left(self.approach(k, h)[0]) > doubt).then_some((h, Ends::Stop))
    }

    /// The first instant within a length at which friction no longer holds the absorber at hand.
    pub(super) fn first_slip(&self, length: R) -> Slip<R> {
        if R::FAST_PATHS && self.clears(length, &self.ahead(length)) {
            return Slip { h: length, direction: None, undecided: 0 };
        }
        let first = |off: R, length: R| first_release(&Slipping { ride: self, off }, length);
        let up = first(R::ONE, length);
        let whole = if up.contact.is_some() { up.end } else { length };
        let down = first(-R::ONE, whole);
        if down.contact.is_none() {
            let direction = up.contact.map(|_| R::ONE);
            return Slip { h: up.end, direction, undecided: up.undecided + down.undecided };
        }
        // Grazings of the other limit after the event were counted as well.
        let before = if up.undecided == 0 { 0 } else { first(R::ONE, down.end).undecided };
        Slip { h: down.end, direction: Some(-R::ONE), undecided: before + down.undecided }
    }
}

/// What is left of friction at rest before a held mass slides off in a direction.
#[derive(Debug)]
struct Slipping<'s, 'a, H: Host, const N: usize, const M: usize> {
    ride: &'s ModalMotion<'a, H, N, M>,
    off: H::Real,
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Curve
    for Slipping<'_, '_, H, N, M>
{
    type Real = R;

    fn jet(&self, h: R) -> Jet<R> {
        self.ride.carried_by(self.off, self.ride.felt(self.ride.at_hand(), h))
    }

    fn first(&self) -> Jet<R> {
        self.ride.carried_by(self.off, self.ride.felt_first())
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        DoubleDouble::new(self.jet(h).value)
    }

    fn fourth(&self) -> R {
        self.ride.fourth()
    }

    fn magnitude(&self) -> R {
        self.ride.magnitude()
    }
}

/// The speed |w| of the absorber at hand.
#[derive(Debug)]
pub(super) struct Speed<'s, 'a, H: Host, const N: usize, const M: usize> {
    pub slide: &'s ModalMotion<'a, H, N, M>,
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Speed<'_, '_, H, N, M> {
    /// The jet where the absorber at hand has a place, and A these values.
    fn jet_of(&self, place: &Place<R>, [a, jerk, snap, _]: [R; 4]) -> Jet<R> {
        let s = place.sliding;
        let value = -s * place.side * place.rate.value;
        Jet { value, rate: -s * a, curvature: -s * jerk, jerk: -s * snap }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Curve for Speed<'_, '_, H, N, M> {
    type Real = R;

    fn jet(&self, h: R) -> Jet<R> {
        let k = self.slide.at_hand();
        self.jet_of(&self.slide.place(k, h), self.slide.felt(k, h))
    }

    fn first(&self) -> Jet<R> {
        self.jet_of(self.slide.begun().1, self.slide.felt_first())
    }

    fn precise(&self, h: R) -> DoubleDouble<R> {
        let Place { side, rate, sliding, .. } = self.slide.place(self.slide.at_hand(), h);
        let factor = -sliding * side;
        DoubleDouble { value: factor * rate.value, rest: factor * rate.rest }
    }

    fn fourth(&self) -> R {
        self.slide.fourth_of(4)
    }

    /// The terms are bounded by the search ([`crate::segment::slide`]), as a slide from rest is as accurate as it is slow.
    fn magnitude(&self) -> R {
        self.slide.begun().1.rate.value.abs()
    }
}
