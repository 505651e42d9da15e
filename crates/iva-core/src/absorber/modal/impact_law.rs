//! Impacts of masses at several points of a structure at one instant.
//!
//! An impulse P at a point p gains the modes φ(p) P, and the point k the velocity mₖₚ P with the mobility
//! mₖₗ = φ(pₖ)·φ(pₗ), of either sign or 0 between different points. With I the masses that have their impact, and L those
//! stuck masses that their walls push on, momentum and Newton's law for each,
//!
//! ```text
//! Pₖ/μₖ + Σ_{I ∪ L} mₖₗ Pₗ = (1 + eₖ) wₖ  for k in I,     = 0  for k in L,     wₖ⁺ = −eₖ wₖ,
//! loss = Σ_I ½ Pₖ (1 − eₖ) wₖ,
//! ```
//!
//! are one linear system. The rule for the masses that were stuck knows no order: a wall pushes and never pulls, s P ≥ 0,
//! for each that is carried, and for each that is left behind the wall does not move into it, s Σ m P ≥ 0.
//!
//! **There is one set of carried masses, always.** With the impulses of I eliminated this is a linear complementarity
//! problem whose matrix is a Schur complement of μ⁻¹ + Φᵀ Φ, thus symmetric and positive definite, and such a problem has
//! one solution for every right-hand side (H. Samelson, R. M. Thrall and O. Wesler, Proc. Amer. Math. Soc. 9, 1958). So
//! the set is never inconsistent. It is unique but for masses with neither impulse nor gap velocity, such as one at a
//! node of all that moves; there all choices give the same velocities, and the mass stays stuck. The set is found by
//! changing the first mass that breaks the rule, which ends for such matrices (K. G. Murty, Linear Algebra Appl. 7, 1974).
//! On a structure of one mode the velocity gained has one sign, whatever is carried, and so decides for each at once.
//!
//! Newton's law holds for each mass of I. If another impact at the very same instant throws the wall of a slow one away
//! faster than it returns, its impulse may pull, as for several masses on one mode. With unlike e such an instant could
//! even gain energy: then the fastest has its impact alone, and the others next, so that masses that chatter on each other come to rest. Impacts at one instant of masses at different points are a set of measure zero but for symmetric
//! scenes. Masses in flight keep their velocity; that of their approach to walls changes by what the structure gains, and the event
//! loop looks at each after the event. A mass that would be left behind for less than rounding of the clock is carried.

use super::state::Place;
use super::{Modal, ModalState, mobility, wall_of};
use crate::absorber::chatter::is_nothing;
use crate::absorber::impact::Impact;
use crate::absorber::{ImpactLaw, LawAt, OnStructure as _, Wall};
use crate::host::Host;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// A velocity in space below this, in units of 2⁻⁵² of the velocities that it is the sum of, is 0.
const AT_REST_ULPS: f64 = 4.0;

/// A search of which masses are carried ends after two to the power of so many sets: it seldom goes through more than there are masses.
pub(super) const MOST_CHANGED: usize = 12;

/// Impulses at one instant, and which of the stuck masses stay stuck.
#[derive(Debug, Clone, Copy)]
struct Blow<R, const N: usize> {
    impulses: [DoubleDouble<R>; N],
    carried: [bool; N],
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// w of a mass, in double-double.
    fn gap_velocity(place: &Place<R>) -> DoubleDouble<R> {
        DoubleDouble { value: -place.side * place.rate.value, rest: -place.side * place.rate.rest }
    }

    /// e of each mass that has an impact: it touches its wall and approaches it.
    fn struck(&self, state: &ModalState<H, N, M>) -> [Option<R>; N] {
        std::array::from_fn(|k| {
            let Place { side, distance, rate, stuck, .. } = state.places[k];
            let strikes = k < self.count() && !stuck && distance.value == 0.0 && rate.value < 0.0;
            strikes.then(|| self.masses[k].law_for(side, -rate.value).restitution)
        })
    }

    /// The fastest of those that have an impact, where all impacts together would gain energy.
    pub(super) fn first_struck(&self, state: &ModalState<H, N, M>) -> Option<usize> {
        let struck = self.struck(state);
        let mut each = struck.iter().flatten();
        let first = each.next()?;
        if each.all(|e| e == first) {
            return None;
        }
        let blow = self.blow(state, &struck, &[DoubleDouble::ZERO; N], R::ZERO);
        let all = || (0..self.count()).filter_map(|k| Some((k, struck[k]?)));
        let lost = |(k, e): (usize, R)| self.lost(k, &state.places[k], e, &blow.impulses);
        if all().map(lost).fold(R::ZERO, |sum, lost| sum + lost) >= 0.0 {
            return None;
        }
        let speed = |k: usize| -state.places[k].rate.value;
        all().map(|(k, _)| k).reduce(|a, b| if speed(b) > speed(a) { b } else { a })
    }

    /// The impulses where some masses have an impact with a restitution each, and the points of all masses gain these
    /// velocities from outside.
    fn blow(
        &self,
        state: &ModalState<H, N, M>,
        struck: &[Option<R>; N],
        outside: &[DoubleDouble<R>; N],
        time: R,
    ) -> Blow<R, N> {
        let places = &state.places;
        let mut carried = places.map(|place| place.stuck);
        let mut hops = [false; N];
        let rhs = std::array::from_fn(|k| {
            let w = || Self::gap_velocity(&places[k]) * self.lever(k, &places[k]);
            match struck[k] {
                Some(e) => w() * DoubleDouble::new(R::ONE).plus(e) - outside[k],
                None => -outside[k],
            }
        });
        let mut seen = None;
        for step in 1..=2_usize << MOST_CHANGED {
            let whole = |k: usize| struck[k].is_some() || carried[k];
            let impulses = self.impulses(&self.moved_along(places, whole), rhs);
            // Without rounding no set comes twice. Sets that alternate differ by nothing, and any of them is right.
            if seen == Some((carried, hops)) {
                return Blow { impulses, carried };
            }
            if step.is_power_of_two() {
                seen = Some((carried, hops));
            }
            let breaks = |k: &usize| {
                let side = places[*k].side * self.pressed_with(*k, &places[*k]);
                places[*k].stuck
                    && !hops[*k]
                    && if carried[*k] {
                        side * impulses[*k].value < 0.0
                    } else {
                        side * (self.pushed_by(*k, &impulses) + outside[*k]).value < 0.0
                    }
            };
            if let Some(k) = (0..self.count()).find(breaks) {
                carried[k] = !carried[k];
                continue;
            }
            let hopping = |k: &usize| {
                let Place { side, stuck, .. } = places[*k];
                if !stuck || carried[*k] {
                    return false;
                }
                let pressure = self.pressure(state, *k);
                let pushed = (self.pushed_by(*k, &impulses) + outside[*k]).value.abs();
                let speed = pushed * self.follows(*k, &places[*k]).abs();
                let e = self.masses[*k].law_for(side, speed).restitution;
                let falls = pressure * (R::ONE - e);
                // Less by a factor of 4: another mass that ends its chatter at the same instant is not to free this one.
                pressure > 0.0 && is_nothing(speed * 0.5 / falls, time)
            };
            let Some(k) = (0..self.count()).find(hopping) else {
                return Blow { impulses, carried };
            };
            (hops[k], carried[k]) = (true, true);
        }
        // Not found: the run ends as not finite, rather than with any of the sets.
        Blow { impulses: [DoubleDouble::new(R::NAN); N], carried }
    }

    /// The reciprocals of the inertias that move with their points in a blow: `whole` members, and parts of the pendulums in flight.
    fn moved_along(
        &self,
        places: &[Place<R>; N],
        whole: impl Fn(usize) -> bool,
    ) -> [Option<DoubleDouble<R>>; N] {
        let of = |k: usize| self.inertia_over(k, &places[k], whole(k));
        std::array::from_fn(|k| if k < self.count() { of(k) } else { None })
    }

    /// The energy that an impact of a member takes with a restitution e in a blow.
    fn lost(&self, k: usize, place: &Place<R>, e: R, impulses: &[DoubleDouble<R>; N]) -> R {
        let w = Self::gap_velocity(place);
        let impulse = match self.hanging(k) {
            None => impulses[k].value,
            Some(is) => {
                let y = self.gap_of_place(k, place);
                let c = is.precise_cosine(y);
                let turned = DoubleDouble::new(R::ONE).plus(e) * w / c;
                let own = DoubleDouble::new(is.inertia_ratio).times(is.lever);
                // Of a heavy pendulum these two nearly cancel.
                let opposed = turned * own - self.pushed_by(k, impulses) * is.lean(y, c);
                (opposed / c).value * is.lever * is.mass_ratio
            }
        };
        impulse * 0.5 * ((R::ONE - e) * w.value)
    }

    /// Applies impulses. Masses in flight keep their velocity.
    fn give(
        &self,
        after: &mut ModalState<H, N, M>,
        blow: &Blow<R, N>,
        outside: Option<DoubleDouble<R>>,
    ) {
        after.renew();
        for k in 0..self.count() {
            let place = &mut after.places[k];
            place.stuck &= blow.carried[k];
            if place.stuck {
                continue;
            }
            let mut gained = self.pushed_by(k, &blow.impulses);
            if let Some(impulse) = outside {
                gained = gained + impulse * self.pushed_at(k);
            }
            if self.hanging(k).is_some() {
                gained = gained * self.follows_precisely(k, place);
            }
            let [value, rest] = [gained.value, gained.rest].map(|part| place.side * part);
            place.rate = place.rate.plus_parts(value, rest);
            *place = self.directed(k, place);
        }
        for (k, impulse) in blow.impulses[..self.count()].iter().enumerate() {
            after.modes.push(self.gap_shape(k), *impulse);
        }
        if let Some(impulse) = outside {
            after.modes.push(self.whole.shape(self.pushed), impulse);
        }
    }

    /// The state after an impulse from outside, on the point on which the force acts.
    pub(super) fn blown(
        &self,
        state: &ModalState<H, N, M>,
        impulse: DoubleDouble<R>,
    ) -> ModalState<H, N, M> {
        let outside = std::array::from_fn(|k| impulse * self.pushed_at(k));
        let blow = self.blow(state, &[None; N], &outside, R::ZERO);
        let mut after = *state;
        self.give(&mut after, &blow, Some(impulse));
        after
    }

    /// The velocity in the gap of a mass per impulse from outside.
    fn pushed_at(&self, k: usize) -> DoubleDouble<R> {
        mobility(self.gap_shape(k), self.whole.shape(self.pushed))
    }

    /// 1/(1/μ + φ·φ): what the impulse of an impact is, over (1 + e) w, where no mass is stuck.
    pub(super) fn reduced(&self, k: usize) -> R {
        let lightness = match self.tied[k] {
            Some(_) => R::ZERO,
            None => R::ONE / self.masses[k].mass_ratio,
        };
        R::ONE / (lightness + self.mobility(k, k).value)
    }

    /// φᵀ D φ at the point of a mass: by how much an impulse raises the pressure there.
    fn stiffened(&self, k: usize) -> R {
        self.whole.damped(self.gap_shape(k))
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> ImpactLaw for Modal<H, N, M> {
    /// That on the structure without other masses stuck to it, where chatters are summed.
    fn law_of(&self, absorber: usize, wall: Wall, approach: R) -> LawAt<R> {
        let k = self.index(absorber);
        let own = self.masses[k].law_at(wall, approach, R::ZERO);
        let at_wall = self.at_wall(k, wall);
        let lever = self.lever(k, &at_wall).value;
        let impulse = (R::ONE + own.restitution) * lever * self.reduced(k);
        let gain = impulse * mobility(self.shape(k), self.shape(k)).value;
        let mut pressure = impulse * self.stiffened(k);
        if let Some(is) = self.hanging(k) {
            let turned = is.pivot_damping * (R::ONE + own.restitution);
            let shaken = turned * is.mass_ratio * lever * self.mobility(k, k).value;
            pressure = (pressure + shaken).mul_add(self.follows(k, &at_wall), turned);
        }
        LawAt { gain, pressure, ..own }
    }

    fn impulse_at(&self, wall: Wall, approach: R) -> R {
        (self.law_at(wall, approach).restitution + 1.0) * self.reduced(0)
    }

    /// That of a stop on the ground is what the ground takes, if no other member has its impact at the same instant.
    fn impulse_of(&self, impact: &Impact<R>) -> R {
        let k = self.index(impact.absorber.into());
        if self.on_ground(k) {
            let turned = impact.gap_velocity_before - impact.gap_velocity_after;
            return turned.abs() * self.reduced(k);
        }
        let gained = impact.absorber_velocity_after() - impact.absorber_velocity_before();
        gained.abs() * self.masses[k].mass_ratio
    }

    /// The record tells displacement and velocity of the structure at the point of the mass.
    fn impact(&self, state: &Self::State, time: R) -> (Self::State, Impact<R>) {
        if self.count() == 0 {
            let (none, seen) = ([R::ZERO; 2], self.primary(state));
            return (*state, Impact::of_free_mass(none, time, Wall::Plus, seen, R::ZERO));
        }
        let (k, mass, place) = self.at_hand_of(state);
        let e = mass.law_for(place.side, -place.rate.value).restitution;
        let mut struck = self.struck(state);
        // The one at hand has its impact also where an orbit is sought in which it would move away from its wall.
        struck[k].get_or_insert(e);
        if let Some(first) = self.first_struck(state) {
            struck = std::array::from_fn(|k| struck[k].filter(|_| k == first));
        }
        let blow = self.blow(state, &struck, &[DoubleDouble::ZERO; N], time);
        let mut after = *state;
        self.give(&mut after, &blow, None);
        for (k, e) in struck.iter().enumerate() {
            if let Some(e) = *e {
                let before = state.places[k].rate;
                after.places[k].rate = before.product(DoubleDouble::new(-e));
                after.places[k] = self.directed(k, &after.places[k]);
            }
        }
        self.align(&mut after);
        self.settle(&mut after);
        let [x, v] = state.modes.of_point(self.shape(k)).map(|it| it.value);
        let [_, v_after] = after.modes.of_point(self.shape(k)).map(|it| it.value);
        let w = -place.side * place.rate.value;
        // A mass at rest in space: its gap velocity is summed apart from that of the structure.
        let at_rest = (v + w).abs() <= v.abs() * (R::EPSILON * AT_REST_ULPS);
        let w = if at_rest { -v } else { w };
        // The ground does not move, not even by rounding.
        let [w, v_after] = if self.on_ground(k) { [v, -e * v] } else { [w, v_after] };
        let impact = Impact {
            time,
            absorber: state.at_hand,
            wall: wall_of(place.side),
            displacement: x,
            velocity_before: v,
            velocity_after: v_after,
            gap_velocity_before: w,
            gap_velocity_after: -e * w,
            lever: if self.on_ground(k) { -R::ONE } else { self.lever(k, &place).value },
            energy_loss: self.lost(k, &place, e, &blow.impulses),
        };
        (after, impact)
    }

    /// The absorber at hand sticks, with all masses that are stuck already.
    fn stick(&self, state: &Self::State) -> (Self::State, R) {
        if self.count() == 0 {
            return (*state, R::ZERO);
        }
        let (k, _, place) = self.at_hand_of(state);
        let carried = std::array::from_fn(|l| l == k || state.places[l].stuck);
        let mut rhs = [DoubleDouble::ZERO; N];
        rhs[k] = Self::gap_velocity(&place) * self.lever(k, &place);
        let moved = self.moved_along(&state.places, |l| carried[l]);
        let blow = Blow { impulses: self.impulses(&moved, rhs), carried };
        let mut after = *state;
        after.places[k].stuck = true;
        self.give(&mut after, &blow, None);
        let zero = DoubleDouble::ZERO;
        after.places[k] = Place { distance: zero, rate: zero, ..after.places[k] };
        self.settle(&mut after);
        (after, self.lost(k, &place, R::ZERO, &blow.impulses))
    }
}
