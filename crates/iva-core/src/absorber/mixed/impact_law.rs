//! Impacts of free masses and pendulums on one structure at one instant.
//!
//! The generalised momentum that belongs to W of a pendulum is μ (λ c v + κλ² W), c its cosθ. An impact changes it for the
//! absorbers I that have their impact, and for those L that are stuck to walls which the impact pushes against them; W of
//! the others F follows the structure, ΔW = −β c Δv. With momentum along x and Newton's law W⁺ = −e W of each of I,
//!
//! ```text
//! Δv = Σ_I μ λ c (1 + e) W / T,     T = 1 + Σ_{I ∪ L} μ + Σ_F μ (1 − c²/κ),
//! loss_i = ½ μ (1 − e) W (κλ² (1 + e) W − λ c Δv),
//! ```
//!
//! where the loss is that of the impulse on each, which is the impulse times the mean of W at its begin and end. For
//! free masses (λ = κ = c = 1) these are the formulas of [`crate::absorber::modal::impact_law`] on one mode; the rule for the stuck ones is
//! the same.

use super::{Mixed, MixedState, Placed};
use crate::absorber::chatter::is_nothing;
use crate::absorber::impact::Impact;
use crate::absorber::{ImpactLaw, LawAt, OnStructure, Wall};
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

impl<R: Real, H: Host<Real = R>> Mixed<H> {
    /// T, where those that are stuck in a state, and some that have an impact, move with the structure.
    pub(super) fn together(
        &self,
        state: &MixedState<H>,
        struck: impl Fn(usize) -> bool,
    ) -> DoubleDouble<R> {
        let one = DoubleDouble::new(R::ONE);
        self.each(state).enumerate().fold(one, |sum, (k, (member, place))| {
            if place.stuck || struck(k) {
                sum.plus(member.pendulum.mass_ratio)
            } else {
                sum + member.pendulum.own_inertia(self.seen(state, k).y())
            }
        })
    }

    /// The state in which the structure has gained a velocity; W of those that have an impact stays.
    pub(super) fn jumped(
        &self,
        state: &MixedState<H>,
        gained: DoubleDouble<R>,
        struck: impl Fn(usize) -> bool,
    ) -> MixedState<H> {
        let mut after = *state;
        for (k, (member, place)) in self.members.iter().zip(&mut after.places).enumerate() {
            place.released = false;
            if !place.stuck && !struck(k) {
                let swing = gained.times(-member.pendulum.coupling).times_sum(place.cosine);
                place.w = place.w + swing;
            }
        }
        after.primary = state.primary.faster_by(gained);
        after
    }

    /// μ λ c (1 + e) W of one that has an impact with a restitution.
    fn push(&self, state: &MixedState<H>, k: usize, restitution: R) -> DoubleDouble<R> {
        let Placed { w, cosine, .. } = state.places[k];
        let pendulum = &self.members[k].pendulum;
        let pull = pendulum.mass_ratio * pendulum.lever;
        DoubleDouble::new(R::ONE).plus(restitution).times(pull).times_sum(w).times_sum(cosine)
    }

    /// The energy lost by one that has an impact, where the structure gains a velocity.
    fn lost(&self, state: &MixedState<H>, k: usize, restitution: R, gained: DoubleDouble<R>) -> R {
        let Placed { w, cosine, .. } = state.places[k];
        let pendulum = &self.members[k].pendulum;
        let lever = pendulum.lever;
        // Of a heavy absorber these two nearly cancel.
        let one = DoubleDouble::new(R::ONE).plus(restitution);
        let turned = one.times_sum(w).times(pendulum.inertia_ratio).times(lever).times(lever);
        let opposed = (turned - gained.times_sum(cosine).times(lever)).value;
        pendulum.mass_ratio * 0.5 * ((R::ONE - restitution) * w.value) * opposed
    }

    /// e of each absorber that has its impact in a state: it touches its wall and approaches it.
    fn struck(&self, state: &MixedState<H>) -> Vec<Option<R>> {
        let e = |(member, place): (&super::Member<R>, &Placed<R>)| {
            let Placed { wall, distance, stuck, .. } = *place;
            let rate = place.rate();
            let strikes = !stuck && distance.value == 0.0 && rate < 0.0;
            strikes.then(|| member.restitution(wall, -rate))
        };
        self.each(state).map(e).collect()
    }

    /// True if one that is stuck would be left behind by this velocity of the structure for less than rounding of the clock.
    fn hops(&self, state: &MixedState<H>, k: usize, gained: R, time: R) -> bool {
        let (member, place) = (&self.members[k], &state.places[k]);
        let pressure = -self.distance_of(state, k).curvature;
        let c = member.stops.cosine.value;
        let speed = gained.abs() * (c * c * member.pendulum.coupling);
        let falls = pressure * (R::ONE - member.restitution(place.wall, speed));
        // Less by a factor of 4: another one that ends its chatter at the same instant is not to free this one.
        pressure > 0.0 && is_nothing(speed * 0.5 / falls, time)
    }
}

impl<R: Real, H: Host<Real = R>> ImpactLaw for Mixed<H> {
    /// Without the gain of the structure, which depends on where the others are.
    fn law_of(&self, absorber: usize, wall: Wall, approach: R) -> LawAt<R> {
        let Some(member) = self.members.get(absorber) else {
            return LawAt::constant(R::ZERO, R::ZERO, R::ZERO, R::ZERO);
        };
        match &member.one {
            super::OneOf::Mass(mass) => mass.law_at(wall, approach, self.host.damping_ratio()),
            super::OneOf::Pendulum(piva) => piva.law_of(0, wall, approach),
        }
    }

    fn impact(&self, state: &Self::State, time: R) -> (Self::State, Impact<R>) {
        let struck = self.struck(state);
        let strikes = |k: usize| struck[k].is_some();
        let pushes = struck.iter().enumerate();
        let pushes = pushes.filter_map(|(k, e)| Some(self.push(state, k, (*e)?)));
        let push = pushes.fold(DoubleDouble::ZERO, |sum, push| sum + push);
        // Its sign is that of the velocity gained, whatever is carried.
        let mut left = *state;
        for k in 0..self.members.len() {
            let Placed { wall, stuck, .. } = state.places[k];
            let pushed = push.value * wall.sign() <= 0.0;
            left.places[k].stuck = stuck && (pushed || self.hops(state, k, push.value, time));
        }
        let together = self.together(&left, strikes);
        let gained = push / together;
        let mut after = self.jumped(&left, gained, strikes);
        for (k, restitution) in struck.iter().enumerate() {
            if let Some(e) = *restitution {
                after.places[k].w = state.places[k].w.times(-e);
            }
        }
        let (before, after_it) = (self.primary(state), self.primary(&after));
        let (k, member) = self.at_hand(state);
        let [w, turned] = [state, &after].map(|it| it.places[k].gap(member).w);
        let e = member.restitution(state.places[k].wall, w.abs());
        let impact = Impact {
            time,
            absorber: state.at_hand,
            wall: state.places[k].wall,
            displacement: before.x,
            velocity_before: before.v,
            velocity_after: after_it.v,
            gap_velocity_before: w,
            gap_velocity_after: turned,
            lever: member.pendulum.lever,
            energy_loss: self.lost(state, k, e, gained),
        };
        (after, impact)
    }

    /// The absorber at hand sticks, with all that are stuck already.
    fn stick(&self, state: &Self::State) -> (Self::State, R) {
        let (at_hand, member) = self.at_hand(state);
        let mut stuck = *state;
        stuck.places[at_hand].stuck = true;
        let gained = self.push(state, at_hand, R::ZERO) / self.together(&stuck, |_| false);
        let mut after = self.jumped(&stuck, gained, |_| false);
        let place = state.places[at_hand].touching(member);
        after.places[at_hand] =
            Placed { w: DoubleDouble::ZERO, stuck: true, released: false, ..place };
        (after, self.lost(state, at_hand, R::ZERO, gained))
    }
}
