//! Several masses on a structure with modes, as the event loop asks for them.

use super::state::{Modes, Place};
use super::{AT_ONCE_ULPS, Modal, ModalMotion, ModalStart, ModalState, wall_of};
use crate::absorber::chatter::Back;
use crate::absorber::impact::{self, Impact};
use crate::absorber::{
    Aboard, Absorber, Angle, Clock, Coasted, Coasts, Hop, OnStructure as _, Wall,
};
use crate::error::Invalid;
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::flight::Jet;
use crate::segment::slide::{Slide, Slip};

/// Masses whose distances differ by less than this, in units of 2⁻⁵² of the clearance, and their rates as little, move as one: rounding
/// has parted them.
const ALIKE_ULPS: f64 = 4.0;

/// Largest pressure of a stuck mass that is released with another, in units of 2⁻⁵² of the terms that cancel in it.
const RELEASED_ULPS: f64 = 16.0;

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// True if a chatter of this length is so short that even the fastest mode changes it by less than rounding: an impulse changes the
    /// derivatives of the pressure by its stiffness, which the sum of a chatter leaves out, and the structure moves in
    /// it as if the mass were stuck but for terms of the same order.
    fn is_sudden(&self, state: &ModalState<H, N, M>, time: R) -> bool {
        let turned = time * R::larger(self.whole.growth(), self.swinging_rate(&state.places));
        time * 4.0 * (turned * turned) <= R::NEGLIGIBLE
    }

    /// True if masses between two walls feel nothing but the motion of a structure that moves as one.
    pub(super) fn goes_by_steps(&self) -> bool {
        self.count() == 0 || (self.is_level() && self.masses().iter().all(|it| it.only.is_none()))
    }

    /// True if no other mass can meet a wall, stop or slide off within a time in which its point gains such a velocity, and A so much per velocity.
    fn others_stay(
        &self,
        state: &ModalState<H, N, M>,
        time: R,
        kicked: impl Fn(usize) -> R,
        growth: R,
    ) -> bool {
        let (at_hand, flight) = (self.index(state.at_hand.into()), self.flight(state));
        (0..self.count()).filter(|k| *k != at_hand).all(|k| {
            let place = &state.places[k];
            let Place { distance, rate, stuck, held, .. } = *place;
            let kicked = kicked(k) * self.follows(k, place).abs();
            if held {
                let left = self.held_up_to(k, place) - self.shaken(state, k)[0].abs();
                let fastest = growth.max(self.whole.growth() * 2.0);
                return left > flight.most_jerked(k) * time + kicked * fastest;
            }
            let shaken = flight.most_shaken(k) + kicked * growth;
            // A mass that slides goes on.
            if self.friction[k] != 0.0 && rate.value.abs() <= kicked + shaken * time {
                return false;
            }
            let travel = time * (rate.value.abs() + kicked + shaken * time);
            let (near, gap) = (distance.value, self.masses[k].half_play() * 2.0);
            !stuck && near > travel && gap - near > travel
        })
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Absorber for Modal<H, N, M> {
    type Start = ModalStart<R, N, M>;
    type Flight<'a>
        = ModalMotion<'a, H, N, M>
    where
        H: 'a;
    type Ride<'a>
        = ModalMotion<'a, H, N, M>
    where
        H: 'a;

    #[inline(always)]
    fn absorbers(&self) -> usize {
        self.count()
    }

    fn at_hand(&self, state: &Self::State) -> usize {
        usize::from(state.at_hand)
    }

    fn take_at_hand(&self, state: &mut Self::State, absorber: usize) {
        state.at_hand = absorber as u8;
    }

    fn turn<'a>(&'a self, flight: &mut ModalMotion<'a, H, N, M>, absorber: usize) {
        flight.from.at_hand = absorber as u8;
    }

    fn is_stuck(&self, state: &Self::State) -> bool {
        self.at_hand_of(state).2.stuck
    }

    fn freed(&self, state: &Self::State) -> Self::State {
        let (k, _, place) = self.at_hand_of(state);
        if !place.stuck {
            return *state;
        }
        let mut freed = state.renewed();
        freed.places[k].stuck = false;
        freed.places[k] = self.directed(k, &freed.places[k]);
        self.settle(&mut freed);
        freed
    }

    /// A mass travels |Ḋ| t + ½ |A| t² at most. The impulses of all impacts of a chatter sum to less than twice the reduced
    /// mass times (1 + e)/(1 − e) times the speed of the mass that chatters, and change A by what springs and dampers make of that
    /// velocity.
    fn others_wait(&self, state: &Self::State, time: R) -> bool {
        let (at_hand, mass, place) = self.at_hand_of(state);
        if self.oscillates() {
            // All impulses together change the velocity of the structure by less than twice that of the mass.
            return self.others_stay(state, time, |_| place.rate.value.abs() * 2.0, R::ZERO);
        }
        // The bound of a power law has four times the change of the pressure, and a longer first rebound.
        if !self.is_sudden(state, if mass.varies() { time * 2.0 } else { time }) {
            return false;
        }
        let e = mass.law(place.side).restitution;
        let shrinking = (R::ONE + e) / (R::ONE - e);
        // With an e that comes up to 1 all impulses together are what the pressure, less than twice as large, gives meanwhile.
        let gained = if mass.varies() {
            place.rate.value.abs() + self.pressure(state, at_hand).abs() * time * 2.0
        } else {
            shrinking * place.rate.value.abs()
        };
        let lever = self.lever(at_hand, &place).value.abs();
        let impulse = self.reduced(at_hand) * lever * 2.0 * gained;
        let kicked = |k: usize| {
            let both = self.mobility(k, k).value * self.mobility(at_hand, at_hand).value;
            impulse * both.sqrt()
        };
        self.others_stay(state, time, kicked, self.whole.growth() * 2.0)
    }

    /// One in flight that is as near to a wall as the one at hand may throw it, or that its own speed takes it.
    fn others_meet(&self, state: &Self::State, time: R) -> bool {
        let (at_hand, _, place) = self.at_hand_of(state);
        let kicked = place.rate.value.abs() * 2.0;
        let meets = |k: &usize| {
            let Place { distance, rate, stuck, held, .. } = state.places[*k];
            let (near, gap) = (distance.value, self.masses[*k].half_play() * 2.0);
            let travel = time * (rate.value.abs() + kicked);
            let clears = near > travel && gap - near > travel;
            !(*k == at_hand || stuck || held || clears)
        };
        (0..self.count()).any(|k| meets(&k))
    }

    fn others_touch(&self, state: &Self::State) -> bool {
        let at_hand = self.index(state.at_hand.into());
        let touches =
            |place: &Place<R>| !place.held && (place.stuck || place.distance.value == 0.0);
        (0..self.count()).any(|k| k != at_hand && touches(&state.places[k]))
    }

    /// That of all its energy in the motion of the gap.
    fn speeds(&self, state: &Self::State) -> R {
        let Modes { places, velocities } = &state.modes;
        let of = |j: usize| {
            let (q, v) = (places[j].value, velocities[j].value);
            self.whole.stiffness[j].value.mul_add(q * q, v * v)
        };
        let energy = (0..self.whole.count()).fold(R::ZERO, |sum, j| sum + of(j));
        let k = self.index(state.at_hand.into());
        (energy * self.mobility(k, k).value).sqrt()
    }

    fn strikes_first(&self, state: &Self::State) -> Option<usize> {
        self.first_struck(state)
    }

    fn clearance(&self) -> R {
        let smallest = self.masses().iter().map(|mass| mass.clearance).reduce(R::min);
        smallest.unwrap_or(R::ONE)
    }

    #[inline(always)]
    fn walls_reachable(&self) -> bool {
        self.count() > 0
    }

    fn clearance_of(&self, absorber: usize) -> R {
        self.masses[self.index(absorber)].clearance
    }

    fn half_play_of(&self, absorber: usize) -> R {
        self.masses[self.index(absorber)].half_play()
    }

    fn walls_of(&self, absorber: usize) -> [R; 2] {
        self.masses[self.index(absorber)].walls()
    }

    fn offset_of(&self, absorber: usize) -> R {
        self.masses[self.index(absorber)].offset
    }

    fn beside(&self, absorber: usize, gap: [R; 3]) -> [R; 3] {
        let k = self.index(absorber);
        if self.on_ground(k) {
            return gap.map(|it| -it);
        }
        self.hanging(k).map_or(gap, |is| is.swung_beside(gap).map(|it| is.lever * it))
    }

    fn angle(&self, state: &Self::State) -> Option<Angle<R>> {
        self.angle_of(state, self.at_hand_of(state).0)
    }

    fn impact_angles(&self, impact: &Impact<R>) -> Option<[Angle<R>; 2]> {
        let k = self.index(impact.absorber.into());
        let place = self.at_wall(k, impact.wall);
        let of = |w: R| {
            let rate = DoubleDouble::new(-place.side * w);
            self.angle_at(k, &Place { rate, ..place })
        };
        Some([of(impact.gap_velocity_before)?, of(impact.gap_velocity_after)?])
    }

    fn check_start(&self, start: &ModalStart<R, N, M>) -> Result<(), Invalid> {
        self.check(start)
    }

    fn begin_at(&self, start: &ModalStart<R, N, M>, time: Clock<R>) -> Self::State {
        self.first(start, time)
    }

    fn flight(&self, state: &Self::State) -> ModalMotion<'_, H, N, M> {
        ModalMotion::new(self, state)
    }

    fn ride(&self, state: &Self::State) -> ModalMotion<'_, H, N, M> {
        ModalMotion::new(self, state)
    }

    fn surely_pressing(&self, state: &Self::State) -> u64 {
        if self.oscillates() { 0 } else { self.pressed_by(state) }
    }

    fn hop(&self, state: &Self::State, remaining: R) -> Option<Hop<Self::State, R>> {
        self.hopped(state, remaining)
    }

    fn hopping(&self, state: &Self::State, time: R) -> ModalMotion<'_, H, N, M> {
        ModalMotion::within(self, state, Some(time))
    }

    const LEAPS: bool = true;

    fn coasts(&self, state: &Self::State, remaining: R) -> Coasts<Self::State, R> {
        if !self.oscillates() {
            return self.leap(state, remaining);
        }
        // A run of the structure alone sees its motion as it is.
        if self.goes_by_steps() {
            self.steps_ahead(state, remaining)
        } else {
            self.leap(state, remaining)
        }
    }

    fn coasted(&self, state: &Self::State, steps: usize) -> Coasted<Self::State, R> {
        if self.oscillates() && self.goes_by_steps() {
            self.stepped(state, steps)
        } else {
            self.leapt(state, steps)
        }
    }

    fn aboard(&self, state: &Self::State, _stuck: bool) -> Aboard {
        self.on_board(state)
    }

    fn wall(&self, state: &Self::State) -> Wall {
        wall_of(self.at_hand_of(state).2.side)
    }

    /// As if the absorber at hand were in flight, also while it is stuck. A structure alone has no wall: 1.
    fn distance(&self, state: &Self::State) -> Jet<R> {
        let (k, _, place @ Place { side, distance, rate, stuck, .. }) = self.at_hand_of(state);
        if self.count() == 0 {
            let value = if self.primary(state).x.is_finite() { R::ONE } else { R::NAN };
            return Jet { value, rate: R::ZERO, curvature: R::ZERO, jerk: R::ZERO };
        }
        let [a, jerk, ..] = self.shaken(state, k);
        let [mut curvature, jerk] = [a, jerk].map(|it| side * it);
        if stuck {
            // It would slide off its wall.
            curvature -= self.held_up_to(k, &place);
        } else if distance.value == 0.0 && rate.value == 0.0 {
            // At rest on its wall more friction holds it than in the slide that it would begin.
            curvature -= self.held_beyond(k, &place);
        }
        Jet { value: distance.value, rate: rate.value, curvature, jerk }
    }

    fn approach_of(&self, state: &Self::State, absorber: usize) -> [R; 2] {
        let place = state.places.get(absorber).filter(|_| absorber < self.count());
        place.map_or([R::ONE, R::ZERO], |place| [place.distance.value, place.rate.value])
    }

    /// Other masses that are about to meet their walls touch them as well.
    fn touch(&self, state: &Self::State, wall: Wall) -> (Self::State, R) {
        if self.count() == 0 {
            return (*state, R::ZERO);
        }
        let (at_hand, mass, place) = self.at_hand_of(state);
        let met = place.measured_from(wall, mass);
        let [acceleration, later] = match met.distance.value {
            none if none == 0.0 => [R::ZERO; 2],
            left => {
                let a = self.shaken(state, at_hand)[0];
                [a, impact::delay(left, met.rate.value, met.side * a)]
            }
        };
        let met = met.moved(later, acceleration);
        let mut touching = *state;
        self.move_on(&mut touching, later, &|k| k == at_hand);
        for (k, place) in touching.places[..self.count()].iter_mut().enumerate() {
            if k == at_hand {
                *place = Place { distance: DoubleDouble::ZERO, leaves: place.leaves, ..met };
            } else if !place.carried() {
                let alike = self.masses[k].clearance * (R::EPSILON * ALIKE_ULPS);
                let touches = |seen: Place<R>| {
                    let Place { side, distance, rate, .. } = seen;
                    let apart = (rate.value - met.rate.value).abs();
                    let twin = side == met.side && distance.value <= alike && apart <= alike;
                    let soon = distance.value <= -rate.value * (R::EPSILON * AT_ONCE_ULPS);
                    let rate = if twin { met.rate } else { rate };
                    let meets = rate.value < 0.0 && (soon || twin);
                    meets.then_some(Place { distance: DoubleDouble::ZERO, rate, ..seen })
                };
                let across = || {
                    let two = self.masses[k].only.is_none();
                    let opposite = wall_of(place.side).opposite();
                    two.then(|| place.measured_from(opposite, &self.masses[k]))
                };
                let seen = [Some(*place), across()];
                if let Some(touching) = seen.into_iter().flatten().find_map(touches) {
                    *place = touching;
                }
            }
        }
        (touching, later)
    }

    /// The release is where A of the absorber at hand is 0. Others whose pressure vanishes there as well are
    /// released with it, and their A is 0 without rounding.
    fn release(&self, state: &Self::State) -> (Self::State, R) {
        if self.count() == 0 {
            return (*state, R::ZERO);
        }
        let (at_hand, _, place) = self.at_hand_of(state);
        let [a, jerk, snap, _] = self.shaken(state, at_hand).map(|it| -place.side * it);
        let later = impact::delay(a + self.held_up_to(at_hand, &place), jerk, snap);
        let leaves = |k: usize| {
            let place = &state.places[k];
            let side = place.side;
            let terms = || self.terms(state, k) * (R::EPSILON * RELEASED_ULPS);
            let ends = || {
                let [a, jerk, ..] = self.shaken(state, k);
                self.held_up_to(k, place) - side * a <= terms() && side * jerk > 0.0
            };
            k == at_hand || (state.places[k].stuck && ends())
        };
        let leaves: [bool; N] = std::array::from_fn(|k| k < self.count() && leaves(k));
        let mut after = *state;
        self.move_on(&mut after, later, &|k| leaves[k]);
        after.renew();
        for (place, leaves) in after.places.iter_mut().zip(leaves) {
            place.stuck &= !leaves;
        }
        for k in (0..N).filter(|k| leaves[*k]) {
            let directed = self.directed(k, &after.places[k]);
            after.places[k] = Place { leaves: self.leaves_smoothly(k), ..directed };
        }
        self.settle(&mut after);
        (after, later)
    }

    #[inline(always)]
    fn rubs(&self, absorber: usize) -> bool {
        self.count() > 0 && self.friction[self.index(absorber)] != 0.0
    }

    #[inline(always)]
    fn is_held(&self, state: &Self::State) -> bool {
        self.count() > 0 && self.at_hand_of(state).2.held
    }

    fn slide<'a>(&'a self, flight: &ModalMotion<'a, H, N, M>, length: R) -> Option<Slide<R>> {
        self.first_end_of(flight, length)
    }

    fn stopped(&self, state: &Self::State) -> (Self::State, R) {
        self.at_stop(state)
    }

    fn first_slip<'a>(&'a self, ride: &ModalMotion<'a, H, N, M>, length: R) -> Slip<R> {
        ride.first_slip(length)
    }

    fn slipped<'a>(
        &'a self,
        ride: &ModalMotion<'a, H, N, M>,
        state: &Self::State,
        direction: R,
    ) -> Option<(Self::State, R)> {
        self.at_slip(ride, state, direction)
    }

    fn rubbed(&self, ends: [&Self::State; 2]) -> R {
        self.rubbed_by_all(ends)
    }

    fn back(&self, state: &Self::State) -> Option<Back<R>> {
        self.way_back(state)
    }
}
