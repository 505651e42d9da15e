//! Impacts of several masses on one structure at one instant.
//!
//! With I the masses that have their impact and L those that are stuck to walls which the impact pushes against them,
//! momentum and Newton's law for each mass of I,
//!
//! ```text
//! v⁺ + Σ_L μ v⁺ + Σ_I μ (v⁺ + w⁺) = v + Σ_L μ v + Σ_I μ (v + w),     w⁺ = −e w,
//! ```
//!
//! give the velocity that the structure gains, and the energy of the impulse on each mass, which is the impulse times the
//! mean of the relative velocities at its begin and end:
//!
//! ```text
//! Δv = Σ_I μ (1 + e) w / T,     T = 1 + Σ_I μ + Σ_L μ,
//! loss_i = ½ μᵢ (1 − eᵢ) wᵢ ((1 + eᵢ) wᵢ − Δv).
//! ```
//!
//! With unlike e an instant of several impacts may gain energy: a fast elastic mass can throw the wall at a slow one that
//! hardly returns, which then pulls (see [`crate::absorber::modal`]). Masses in flight keep their velocity. A stuck mass is in L if Δv moves its wall towards it; otherwise it is left
//! behind, and flies. The sign of Δv does not depend on L, so that there is one solution. A mass that would be left behind
//! for less than rounding of the clock is carried. For a single mass on a structure
//! that carries none these are the formulas of [`crate::absorber::impact`].

use super::{InGap, Several, SeveralState};
use crate::absorber::chatter::is_nothing;
use crate::absorber::impact::{Impact, share_of};
use crate::absorber::{Absorber, ImpactLaw, LawAt, OnStructure, Wall};
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

impl<R: Real> InGap<R> {
    /// The velocity that the structure gains where it has gained some already, from a mass that has its impact with this
    /// share of the gap velocity.
    #[inline(always)]
    pub(crate) fn kicks(&self, gained: DoubleDouble<R>, share: DoubleDouble<R>) -> DoubleDouble<R> {
        let Self { side, rate, .. } = *self;
        let kick = share.value * (-side * rate.value);
        let rest = -side * (share.value * rate.rest + share.rest * rate.value);
        gained.plus_parts(kick, rest)
    }

    /// The place of a mass in flight whose structure has gained a velocity.
    #[inline(always)]
    pub(crate) fn left_by(&self, gained: DoubleDouble<R>) -> Self {
        let kick = [self.side * gained.value, self.side * gained.rest];
        Self { rate: self.rate.plus_parts(kick[0], kick[1]), ..*self }
    }

    /// The place after an impact with a restitution.
    #[inline(always)]
    pub(crate) fn rebounded(&self, restitution: R) -> Self {
        Self { rate: self.rate.product(DoubleDouble::new(-restitution)), ..*self }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> Several<H, N> {
    /// The masses that have their impact in a state: they touch their walls and approach them.
    fn struck(&self, state: &SeveralState<H, N>) -> [bool; N] {
        state.masses.map(|InGap { distance, rate, stuck, .. }| {
            !stuck && distance.value == 0.0 && rate.value < 0.0
        })
    }

    /// 1 and the mass ratios of some masses.
    pub(super) fn together(&self, which: impl Fn(usize) -> bool) -> DoubleDouble<R> {
        let masses = (0..self.count).filter(|k| which(*k)).map(|k| self.masses[k].mass_ratio);
        masses.fold(DoubleDouble::new(R::ONE), DoubleDouble::plus)
    }

    /// The velocity that the structure gains where some masses, with a restitution each, have an impact and all that
    /// moves together has a mass.
    #[inline(always)]
    fn gained(
        &self,
        state: &SeveralState<H, N>,
        struck: [Option<R>; N],
        together: DoubleDouble<R>,
    ) -> DoubleDouble<R> {
        let mut gained = DoubleDouble::ZERO;
        for (k, restitution) in struck.iter().enumerate() {
            let Some(restitution) = *restitution else { continue };
            let share = share_of(self.masses[k].mass_ratio, restitution, together);
            gained = state.masses[k].kicks(gained, share);
        }
        gained
    }

    /// The restitution of each mass that has an impact.
    fn restitutions(&self, state: &SeveralState<H, N>, struck: [bool; N]) -> [Option<R>; N] {
        std::array::from_fn(|k| {
            let InGap { side, rate, .. } = state.masses[k];
            struck[k].then(|| self.masses[k].law_for(side, -rate.value).restitution)
        })
    }

    /// The state after the impacts of all masses that touch their walls and approach them, and that of the absorber at hand.
    #[inline(always)]
    fn collided(&self, state: &SeveralState<H, N>, time: R) -> (SeveralState<H, N>, Impact<R>) {
        let struck = self.struck(state);
        let restitutions = self.restitutions(state, struck);
        // Its sign is that of the velocity gained, whatever is carried, and its size is no smaller.
        let push = self.gained(state, restitutions, DoubleDouble::new(R::ONE)).value;
        let carried = |k: usize| {
            let InGap { side, stuck, .. } = state.masses[k];
            let pressure = -side * state.host.acceleration.value;
            let hop = || {
                let falls =
                    pressure * (R::ONE - self.masses[k].law_for(side, push.abs()).restitution);
                // Less by a factor of 4: another mass that ends its chatter at the same instant is not to free this one.
                push.abs() * 0.5 / falls
            };
            stuck && (side * push <= 0.0 || (pressure > 0.0 && is_nothing(hop(), time)))
        };
        let together = self.together(|k| struck[k] || carried(k));
        let gained = self.gained(state, restitutions, together);
        let mut left = *state;
        for (k, mass) in left.masses[..self.count].iter_mut().enumerate() {
            mass.stuck &= carried(k);
        }
        let mut after = self.jumped(&left, gained);
        for (k, restitution) in restitutions.iter().enumerate() {
            let (Some(e), before) = (*restitution, &state.masses[k]) else { continue };
            after.masses[k].rate = before.rebounded(e).rate;
        }
        let (before, after_it) = (self.primary(state), self.primary(&after));
        let Some((mass, place)) = self.seen(state) else {
            let none = [R::ZERO; 2];
            return (after, Impact::of_free_mass(none, time, Wall::Plus, before, R::ZERO));
        };
        let e = mass.law_for(place.side, -place.rate.value).restitution;
        let w = -place.side * place.rate.value;
        // Of a heavy mass these two nearly cancel.
        let rest = -place.side * place.rate.rest;
        let turned = DoubleDouble::new(R::ONE).plus(e).times_sum(DoubleDouble { value: w, rest });
        let opposed = (turned - gained).value;
        let impact = Impact {
            time,
            absorber: state.at_hand,
            wall: self.wall(state),
            displacement: before.x,
            velocity_before: before.v,
            velocity_after: after_it.v,
            gap_velocity_before: w,
            gap_velocity_after: -e * w,
            lever: R::ONE,
            energy_loss: mass.mass_ratio * 0.5 * (R::ONE - e) * w * opposed,
        };
        (after, impact)
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> ImpactLaw for Several<H, N> {
    /// That on the structure without other masses stuck to it, where chatters are summed.
    fn law_of(&self, absorber: usize, wall: Wall, approach: R) -> LawAt<R> {
        let Some(mass) = self.masses().get(absorber) else {
            return LawAt::constant(R::ZERO, R::ZERO, R::ZERO, R::ZERO);
        };
        mass.law_at(wall, approach, self.host.damping_ratio())
    }

    fn impact(&self, state: &Self::State, time: R) -> (Self::State, Impact<R>) {
        self.collided(state, time)
    }

    /// The absorber at hand sticks, with all masses that are stuck already.
    fn stick(&self, state: &Self::State) -> (Self::State, R) {
        let Some((mass, place)) = self.seen(state) else { return (*state, R::ZERO) };
        let at_hand = usize::from(state.at_hand);
        let together = self.together(|k| k == at_hand || state.masses[k].stuck);
        let plastic = std::array::from_fn(|k| (k == at_hand).then_some(R::ZERO));
        let gained = self.gained(state, plastic, together);
        let mut stuck = *state;
        stuck.masses[at_hand].stuck = true;
        let mut after = self.jumped(&stuck, gained);
        let zero = DoubleDouble::ZERO;
        after.masses[at_hand] = InGap { distance: zero, rate: zero, stuck: true, ..*place };
        let (mass, speed) = (mass.mass_ratio, place.rate.value);
        let reduced = mass * (together.plus(-mass).value / together.value);
        (after, reduced * 0.5 * (speed * speed))
    }
}
