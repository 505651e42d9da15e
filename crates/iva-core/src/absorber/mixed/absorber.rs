//! Free masses and pendulums on one structure, as the event loop sees them.

use super::{AT_ONCE_ULPS, Mixed, MixedFlight, MixedStart, MixedState, Placed};
use crate::absorber::impact::{Impact, delay};
use crate::absorber::{Absorber, Angle, Clock, Wall};
use crate::error::Invalid;
use crate::force::Drive;
use crate::host::oscillator::Primary;
use crate::host::{Host, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::Jet;
use crate::segment::taylor::Series;

/// Largest pressure of a stuck absorber that leaves its wall together with the one at hand, in units of 2⁻⁵² of the terms
/// that cancel in it.
const FREE_ULPS: f64 = 16.0;

impl<R: Real, H: Host<Real = R>> Mixed<H> {
    /// The state a short time later, by the first coefficients of its motion.
    fn shortly(&self, state: &MixedState<H>, ahead: &[Series<R, 4>], later: R) -> MixedState<H> {
        let mut after = *state;
        for (place, Series { y, w, c, .. }) in after.places.iter_mut().zip(ahead) {
            if !place.stuck {
                place.distance = place.distance.plus(y[1] * later * -place.wall.sign());
                place.w = place.w.plus(w[1] * later);
                place.cosine = place.cosine.plus(c[1] * later);
                place.released = false;
            }
        }
        let Primary { x, v } = state.primary;
        let u = &ahead[0].u;
        after.primary = Primary { x: x.plus(u[0] * later), v: v.plus(u[1] * later) };
        after.phase = self.host.free().later(&state.phase, later);
        after
    }

    /// The size of the terms that cancel in the acceleration of the structure.
    fn terms(&self, state: &MixedState<H>) -> R {
        let Primary { x, v } = state.primary;
        let own = x.value.abs() + self.host.damping_ratio() * 2.0 * v.value.abs();
        let drive = self.host.drive_ahead::<1>(&state.phase);
        own + drive.map_or(R::ZERO, |Drive { primary, base }| primary[0].abs() + base[0].abs())
    }
}

impl<R: Real, H: Host<Real = R>> Absorber for Mixed<H> {
    type Start = MixedStart<R>;
    type Flight<'a>
        = MixedFlight<'a, H>
    where
        H: 'a;
    type Ride<'a>
        = MixedFlight<'a, H>
    where
        H: 'a;

    fn absorbers(&self) -> usize {
        self.members.len()
    }

    fn at_hand(&self, state: &Self::State) -> usize {
        usize::from(state.at_hand)
    }

    fn take_at_hand(&self, state: &mut Self::State, absorber: usize) {
        state.at_hand = absorber as u8;
    }

    fn turn<'a>(&'a self, flight: &mut MixedFlight<'a, H>, absorber: usize) {
        flight.from.at_hand = absorber as u8;
    }

    fn is_stuck(&self, state: &Self::State) -> bool {
        let (k, _) = self.at_hand(state);
        state.places[k].stuck
    }

    fn freed(&self, state: &Self::State) -> Self::State {
        let (k, _) = self.at_hand(state);
        let mut freed = *state;
        freed.places[k].stuck = false;
        freed
    }

    /// Chatters are not summed.
    fn others_wait(&self, _state: &Self::State, _time: R) -> bool {
        false
    }

    /// The smallest.
    fn clearance(&self) -> R {
        let each = self.members.iter().map(|it| it.clearance);
        each.reduce(R::min).unwrap_or(R::ONE)
    }

    fn clearance_of(&self, absorber: usize) -> R {
        self.members.get(absorber).map_or(R::ONE, |it| it.clearance)
    }

    fn offset_of(&self, absorber: usize) -> R {
        self.members.get(absorber).map_or(R::ZERO, |it| it.offset)
    }

    fn lever_of(&self, absorber: usize) -> R {
        self.members.get(absorber).map_or(R::ONE, |it| it.pendulum.lever)
    }

    fn check_start(&self, start: &MixedStart<R>) -> Result<(), Invalid> {
        self.check(start)
    }

    fn begin_at(&self, start: &MixedStart<R>, time: Clock<R>) -> Self::State {
        self.first_state(start, time)
    }

    fn flight(&self, state: &Self::State) -> MixedFlight<'_, H> {
        MixedFlight::new(self, *state)
    }

    fn ride(&self, state: &Self::State) -> MixedFlight<'_, H> {
        MixedFlight::new(self, *state)
    }

    fn wall(&self, state: &Self::State) -> Wall {
        let (k, _) = self.at_hand(state);
        state.places[k].wall
    }

    fn distance(&self, state: &Self::State) -> Jet<R> {
        let (k, _) = self.at_hand(state);
        self.distance_of(state, k)
    }

    fn approach_of(&self, state: &Self::State, absorber: usize) -> [R; 2] {
        let place = &state.places[absorber];
        [place.distance.value, place.rate()]
    }

    /// Others that are about to meet their walls touch them as well.
    fn touch(&self, state: &Self::State, wall: Wall) -> (Self::State, R) {
        let (k, member) = self.at_hand(state);
        let ahead: Vec<Series<R, 4>> = self.beginning(state);
        let mut met = *state;
        if met.places[k].wall != wall {
            met.places[k] = met.places[k].across(member);
        }
        let Series { y, c, .. } = &ahead[k];
        let place = &met.places[k];
        let flat = delay(place.distance.value, place.rate(), y[2] * (-wall.sign() * 2.0));
        let steep = delay((place.cosine - member.stops.cosine).value, c[1], c[2] * 2.0);
        let later = if member.stops.steep { steep } else { flat };
        let mut after = self.shortly(&met, &ahead, later);
        after.places[k] = after.places[k].touching(member);
        for (other, (member, place)) in self.members.iter().zip(&mut after.places).enumerate() {
            let within = R::EPSILON * AT_ONCE_ULPS;
            let meets = |seen: &Placed<R>| {
                seen.rate() < 0.0 && seen.distance.value <= -seen.rate() * within
            };
            if other == k || place.stuck {
                continue;
            }
            if let Some(seen) = [*place, place.across(member)].into_iter().find(meets) {
                *place = seen.touching(member);
            }
        }
        (after, later)
    }

    /// Stuck absorbers that the wall of the one at hand lets go at the same instant leave theirs as well.
    fn release(&self, state: &Self::State) -> (Self::State, R) {
        let (k, _) = self.at_hand(state);
        let Jet { value, rate, curvature, .. } = self.pressure_of(state, k);
        let later = delay(value, rate, curvature);
        let mut after = self.shortly(state, &self.beginning(state), later);
        let pull = self.terms(&after);
        for other in 0..self.members.len() {
            let member = &self.members[other];
            let place = &state.places[other];
            let [factor, constant] = member.pressure(place.wall);
            let leaves = || {
                let Jet { value, rate, .. } = self.pressure_of(&after, other);
                let size = constant.abs() * 2.0 + factor.abs() * pull;
                rate < 0.0 && value <= size * (R::EPSILON * FREE_ULPS)
            };
            if place.stuck && (other == k || leaves()) {
                let w = DoubleDouble::ZERO;
                after.places[other] =
                    Placed { w, stuck: false, released: true, ..place.touching(member) };
            }
        }
        (after, later)
    }

    fn angle(&self, state: &Self::State) -> Option<Angle<R>> {
        let (k, _) = self.at_hand(state);
        let (piva, seen) = (self.pendulum(k)?, self.seen(state, k));
        let rate = seen.w.value / piva.pendulum.contact_distance;
        Some(Angle { value: piva.angle_of(&seen), rate })
    }

    fn impact_angles(&self, impact: &Impact<R>) -> Option<[Angle<R>; 2]> {
        self.pendulum(usize::from(impact.absorber))?.impact_angles(impact)
    }
}
