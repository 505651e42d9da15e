//! Coulomb friction of masses in their gaps, and of pendulums in their pivots.
//!
//! A mass that slides with the sign s of its gap velocity is decelerated by R, and pulls its point along with s μ R: gravity G + s R in
//! place of G (`modal/equations.rs`). One at rest in its gap moves with its point, as one that is stuck does, while |A| ≤ Rₛ, with
//! A = ü + a_g + G + k y/μ and Rₛ ≥ R. On a wall it is stuck while −s A + Rₛ ≥ 0: the wall pushes only, and friction carries Rₛ at most.
//! Where Rₛ > R a slide begins with a jump of the acceleration. Between R and Rₛ a mass may slide or be held: it goes on as it is.
//!
//! Friction is finite, so a blow carries no mass that friction holds: it slides from then on. Each beginning, turn and end of a slide
//! changes the force on the structure in a jump, and so A of all others: which of the masses at rest are held is decided for all of them
//! at once ([`Modal::settle`]).
//!
//! **In a pivot** a constant moment T opposes the swing, R = b T/I: Ẇ has the term −s R, and a pendulum at rest is held while what would turn it,
//! |β c A + r² y + σ² φ|, is Rₛ at most. In its gap that is −ÿ of a pendulum that were free, and c Rₛ, in place of A and Rₛ.

use super::impact_law::MOST_CHANGED;
use super::slides::Speed;
use super::state::Place;
use super::structure::same;
use super::{Modal, ModalMotion, ModalState};
use crate::absorber::chatter::Back;
use crate::absorber::{Absorber as _, impact};
use crate::error::{Invalid, number};
use crate::host::{Host, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::flight::{Curve, Jet, Side};
use crate::segment::slide::{Slide, first_end};

/// What rounding may do to a speed, in units of 2⁻⁵² of the numbers that it is the sum of.
pub(super) const DOUBT: f64 = 64.0;

/// Largest difference of R and |A| where a held mass slides off, in units of 2⁻⁵² of the terms that cancel in it.
const BALANCED_ULPS: f64 = 1024.0;

impl<R: Real, const N: usize, const M: usize> Modal<UndrivenHost<R>, N, M> {
    /// The same members with Coulomb friction, which decelerates each that slides by R, an acceleration; R = b T/I of a pendulum with the moment T in its pivot.
    ///
    /// # Errors
    /// [`Invalid`] for a negative number or one out of [`crate::range`], and for numbers that are not as many as masses.
    pub fn with_friction(mut self, friction: &[R]) -> Result<Self, Invalid> {
        same("absorber.friction", friction.len(), self.count())?;
        let given = &self.friction[..self.count()];
        if friction == given && given == &self.static_friction[..self.count()] {
            return Ok(self);
        }
        for (k, (own, given)) in self.friction.iter_mut().zip(friction).enumerate() {
            let field = format!("absorber.{k}.friction");
            range::size(&field, *given)?;
            if *given < 0.0 {
                let value = number(given.double());
                return Err(Invalid::new(field, value, "give 0 or more"));
            }
            *own = *given;
        }
        self.static_friction = self.friction;
        Ok(self.completed())
    }

    /// The same masses, each of which friction holds at rest up to Rₛ, an acceleration: as large as that of a slide, or larger.
    ///
    /// # Errors
    /// [`Invalid`] for a number smaller than the deceleration of a slide or out of [`crate::range`], for one without friction, and for numbers that are not as many as masses.
    pub fn with_static_friction(mut self, static_friction: &[R]) -> Result<Self, Invalid> {
        same("absorber.static_friction", static_friction.len(), self.count())?;
        if static_friction == &self.static_friction[..self.count()] {
            return Ok(self);
        }
        let all = self.static_friction.iter_mut().zip(&self.friction).zip(static_friction);
        for (k, ((own, sliding), given)) in all.enumerate() {
            let field = format!("absorber.{k}.static_friction");
            range::size(&field, *given)?;
            if *given < *sliding || (*given > 0.0 && *sliding == 0.0) {
                let value = number(given.double());
                let rule = "give friction too, and at least as much at rest as in a slide";
                return Err(Invalid::new(field, value, rule));
            }
            *own = *given;
        }
        Ok(self)
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> Modal<H, N, M> {
    /// s R of a mass that slides; 0 of others.
    #[inline(always)]
    pub(super) fn rubbing(&self, k: usize, place: &Place<R>) -> R {
        if place.carried() { R::ZERO } else { place.sliding * self.friction[k] }
    }

    /// G of a mass, of a body with the weight of what rides on it, and s R of one that slides. Weight and friction of a pendulum are part of its swing.
    #[inline(always)]
    pub(super) fn pull(&self, k: usize, place: &Place<R>) -> DoubleDouble<R> {
        if self.hanging(k).is_some() {
            return DoubleDouble::ZERO;
        }
        DoubleDouble::new(self.weights[k]).plus(self.rubbing(k, place))
    }

    /// Up to which acceleration in its gap friction holds a member at rest in a place: Rₛ, or c Rₛ.
    #[inline(always)]
    pub(super) fn held_up_to(&self, k: usize, place: &Place<R>) -> R {
        self.static_friction[k] * self.turned_by(k, place)
    }

    /// By how much more than a slide decelerates it.
    #[inline(always)]
    pub(super) fn held_beyond(&self, k: usize, place: &Place<R>) -> R {
        (self.static_friction[k] - self.friction[k]) * self.turned_by(k, place)
    }

    /// The place with the sign of its slide: that of the gap velocity, or at a wall that of the way off it.
    pub(super) fn directed(&self, k: usize, place: &Place<R>) -> Place<R> {
        if self.friction[k] == 0.0 || place.stuck {
            return *place;
        }
        let w = -place.side * place.rate.value;
        let sliding = match w {
            w if w != 0.0 => w.signum(),
            _ if place.distance.value == 0.0 => -place.side,
            _ => return *place,
        };
        Place { sliding, held: false, ..*place }
    }

    /// Holds each mass at rest in its gap, or lets it slide off where friction cannot hold it.
    ///
    /// What one of them does changes A of all others. The forces are those of a linear complementarity problem with a positive
    /// definite matrix, as those of impacts (`modal/impact_law.rs`), and the first mass that breaks its rule is changed until none does.
    /// Where that does not end the state is no number.
    pub(super) fn settle(&self, state: &mut ModalState<H, N, M>) {
        let rests: [bool; N] = std::array::from_fn(|k| {
            let place = &state.places[k];
            let inside = place.distance.value > 0.0 && !place.stuck;
            k < self.count() && self.friction[k] != 0.0 && inside && place.rate.value == 0.0
        });
        if !rests.contains(&true) {
            return;
        }
        for _ in 0..4_usize << (2 * self.count().min(MOST_CHANGED)) {
            let Some((k, sliding)) = (0..self.count())
                .filter(|k| rests[*k])
                .find_map(|k| self.broken(state, k).map(|sliding| (k, sliding)))
            else {
                // Who slips at the same instant as another is balanced as well.
                for (k, _) in rests.iter().enumerate().filter(|(_, rests)| **rests) {
                    if !state.places[k].held && self.leaves_smoothly(k) {
                        let [a, ..] = self.shaken(state, k);
                        state.places[k].leaves |= self.balanced(state, k, a) == 0.0;
                    }
                }
                return;
            };
            state.renew();
            state.places[k].leaves = false;
            state.places[k].sliding = sliding;
            state.places[k].held = sliding == 0.0;
        }
        // Not found in more changes than there are states: the run ends as not finite, rather than with any of them.
        state.modes.places[0] = DoubleDouble::new(R::NAN);
    }

    /// A difference of accelerations of a member at rest; 0 where it is rounding of what friction holds it with.
    fn balanced(&self, state: &ModalState<H, N, M>, k: usize, value: R) -> R {
        let holds = self.held_up_to(k, &state.places[k]);
        if value.abs() <= holds * (R::EPSILON * BALANCED_ULPS) { R::ZERO } else { value }
    }

    /// With which sign a mass at rest in its gap has to slide, 0 if it has to be held, where what is said of it contradicts A; else `None`.
    fn broken(&self, state: &ModalState<H, N, M>, k: usize) -> Option<R> {
        let Place { held, sliding, .. } = state.places[k];
        let [a, jerk, ..] = self.shaken(state, k);
        if held {
            let over = |s: R| {
                let left = s.mul_add(a, self.held_up_to(k, &state.places[k]));
                let left = self.balanced(state, k, left);
                left < 0.0 || (left == 0.0 && s * jerk < 0.0)
            };
            return [R::ONE, -R::ONE].into_iter().find(|s| over(*s));
        }
        let a = self.balanced(state, k, a);
        let goes = sliding * a < 0.0 || (a == 0.0 && sliding * jerk < 0.0);
        (sliding == 0.0 || !goes).then_some(R::ZERO)
    }

    /// True if it is proved that a mass does not stop in a leap, by distance and rate at both ends, a bound on the third derivative of the
    /// distance, and the length.
    pub(super) fn slides_on(
        &self,
        k: usize,
        place: &Place<R>,
        [[_, begin], [_, end]]: [[R; 2]; 2],
        [third, length]: [R; 2],
    ) -> bool {
        let along = -place.sliding * place.side;
        let least = (along * begin).min(along * end);
        // A speed is off the chord by h²/8 of its second derivative at most.
        let bent = length * length * third * 0.125;
        let size = begin.abs() + end.abs() + self.masses[k].size_at(place.distance.value);
        least > bent + R::EPSILON * DOUBT * size
    }

    /// The first event of a slide of the absorber at hand.
    pub(super) fn first_end_of(
        &self,
        flight: &ModalMotion<'_, H, N, M>,
        length: R,
    ) -> Option<Slide<R>> {
        let speed = Speed { slide: flight };
        if !(flight.fourth().is_finite() && speed.fourth().is_finite()) {
            return None;
        }
        let (k, _, place) = self.at_hand_of(&flight.from);
        let ahead = if place.sliding == place.side { Side::Near } else { Side::Far };
        if let Some((h, ends)) = flight.sure_end(ahead, length) {
            return Some(Slide { h, ends, undecided: 0 });
        }
        let wide = self.masses[k].half_play();
        Some(first_end((flight, &speed), ahead, wide, length))
    }

    /// The state in which the absorber at hand has stopped in its gap, and how much later it is.
    pub(super) fn at_stop(&self, state: &ModalState<H, N, M>) -> (ModalState<H, N, M>, R) {
        let (k, mass, place) = self.at_hand_of(state);
        let [a, jerk, ..] = self.shaken(state, k);
        let later = impact::delay(place.rate.value, place.side * a, place.side * jerk);
        let mut after = *state;
        self.move_on(&mut after, later, &|l| l == k);
        after.renew();
        let distance = place.distance.plus(place.rate.value * later * 0.5);
        let (rate, sliding) = (DoubleDouble::ZERO, R::ZERO);
        let at_rest = Place { distance, rate, held: true, sliding, ..after.places[k] };
        let across = -distance.minus(mass.half_play() * 2.0);
        let at_wall = |side: R| {
            let there = Place { side, distance: DoubleDouble::ZERO, held: false, ..at_rest };
            self.directed(k, &there)
        };
        after.places[k] = match at_rest {
            _ if distance.value <= 0.0 => at_wall(place.side),
            _ if across <= 0.0 => at_wall(-place.side),
            _ => at_rest,
        };
        self.align(&mut after);
        self.settle(&mut after);
        (after, later)
    }

    /// The state in which the absorber at hand slides off with this sign at the end of a ride, and how much later it is; `None` if that is
    /// no such instant.
    pub(super) fn at_slip(
        &self,
        ride: &ModalMotion<'_, H, N, M>,
        state: &ModalState<H, N, M>,
        off: R,
    ) -> Option<(ModalState<H, N, M>, R)> {
        let Jet { value, rate, curvature, .. } =
            ride.carried_by(off, self.shaken(state, self.index(state.at_hand.into())));
        if value.abs() > ride.magnitude() * (R::EPSILON * BALANCED_ULPS) {
            return None;
        }
        let k = self.index(state.at_hand.into());
        let later = impact::delay(value, rate, curvature);
        let mut after = *state;
        self.move_on(&mut after, later, &|l| l == k);
        after.renew();
        (after.places[k].held, after.places[k].sliding) = (false, off);
        after.places[k].leaves = self.leaves_smoothly(k);
        self.settle(&mut after);
        Some((after, later))
    }

    /// True if A is 0 without rounding as a mass begins to slide: there is no more friction at rest.
    pub(super) fn leaves_smoothly(&self, k: usize) -> bool {
        self.static_friction[k] <= self.friction[k]
    }

    /// Σ μ R |Δy| of all masses, and Σ μκλ² R |Δφ| of all pendulums, that slide between two states.
    pub(super) fn rubbed_by_all(&self, [from, to]: [&ModalState<H, N, M>; 2]) -> R {
        let sliding = |k: &usize| self.rubbing(*k, &from.places[*k]) != 0.0;
        (0..self.count()).filter(sliding).fold(R::ZERO, |sum, k| {
            let [begin, end] = [from, to].map(|it| &it.places[k]);
            let swung = |place: &Place<R>| self.angle_at(k, place).map_or(R::ZERO, |it| it.value);
            let (inertia, way) = match self.hanging(k) {
                None => (self.masses[k].mass_ratio, (end.distance - begin.distance).value),
                Some(is) => {
                    let way = (swung(end) - swung(begin)) * is.contact_distance;
                    (is.swung_inertia(), way)
                }
            };
            (inertia * self.friction[k]).mul_add(way.abs(), sum)
        })
    }

    /// How the absorber at hand returns from a rebound that begins in a state.
    pub(super) fn way_back(&self, state: &ModalState<H, N, M>) -> Option<Back<R>> {
        let (k, _, place) = self.at_hand_of(state);
        if self.friction[k] == 0.0 {
            return None;
        }
        let mut back = state.renewed();
        back.places[k].sliding = place.side;
        let Jet { curvature, jerk, .. } = self.distance(&back);
        Some(Back { pressure: -curvature, jerk, spare: -curvature - self.held_beyond(k, &place) })
    }
}
