//! A free mass that slides on its structure with Coulomb friction.
//!
//! Friction decelerates the mass by R ≥ 0 against its gap velocity w and pulls the structure along. With s the sign of w, and
//! gravity G along the motion (`host/driven/weight.rs`, x measured from the position of rest with the mass on its lower stop):
//!
//! ```text
//! ẍ₁ = −(G + s R) − a_g,    ẍ + 2ζ ẋ + x = f/M − a_g + μ (G + s R)          sliding,
//! (1 + μ) ẍ + 2ζ ẋ + x = f/M − (1 + μ) a_g                                  held in the gap, or on a wall.
//! ```
//!
//! So *sliding one way is free flight under a constant gravity G + s R*, in closed form: a [`Sliding`] is made of three
//! [`Siva`]s, which differ in gravity only, and its motions are theirs. The reaction μ s R acts on the structure as the excess
//! μ G of a mass in flight does.
//!
//! With A = ẍ + a_g + G, the acceleration that the structure would have to give to a mass at rest on it, friction has to carry A
//! per unit of mass. It does as long as |A| ≤ R:
//!
//! * **Stop.** A slide ends where w = 0 ([`crate::segment::slide`]). The mass goes on upwards if A < −R, downwards if A > R, and
//!   is held otherwise. The signs of A ± R are those of the accelerations of a mass that slides, A (1 + μ) ± R (1 + μ), which are
//!   known in double-double; where one is 0, that of its derivative decides.
//! * **Held.** Mass and structure move as one until A reaches R or −R; then the mass slides off, with A ± R exactly 0.
//! * **At a wall** the impact is that of a free mass, w⁺ = −e w⁻. Riding a wall is being held by a wall that pushes: of the force
//!   that the mass needs, friction carries R at most in either direction and the wall pushes only. When the pressure on the wall
//!   falls, the wall force vanishes first; the mass leaves once it would have to be pulled off against more than R. That is the
//!   ride of a free mass under the gravity of the way off the wall.
//! * **Chatter.** A rebound decelerates with A + R (times 1 + μ) on its way out and returns with A − R, both as seen from a wall
//!   that is pressed with A: it is slower by the factor e √((A − R)/(A + R)) each time ([`crate::absorber::chatter`]). With A ≤ R
//!   the mass stops in the gap.
//!
//! Friction takes the energy μ R |Δy| per primary mass in a slide.
//!
//! Where a stop is decided within rounding, so that A is R but for rounding, a held mass and one that slides off differ by
//! rounding only. With R = 0 every event has the bits of [`Siva::inclined`] with the same gravity and force.

use crate::absorber::chatter::Back;
use crate::absorber::siva::{Siva, SivaState};
use crate::absorber::{Absorber, Clock, Coasted, Start, Wall, impact};
use crate::error::{Invalid, number};
use crate::force::Force;
use crate::host::oscillator::Primary;
use crate::host::{DrivenHost, Host, HostState, Moment, Structure, UndrivenHost};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;
use crate::segment::contact::Stretch;
use crate::segment::flight::{Curve, Jet};
use crate::segment::slide::{Slide, first_end};

pub use flight::SlidingFlight;
pub use ride::SlidingRide;
pub use state::SlidingState;

mod flight;
mod impact_law;
mod on_structure;
mod ride;
mod state;

/// A free mass with Coulomb friction in its gap, on a driven structure.
#[derive(Debug, Clone)]
pub struct Sliding<R: Real = f64> {
    /// Without friction: gravity G.
    pub(crate) level: Siva<DrivenHost<R>>,
    /// Sliding up y: gravity G + R.
    rising: Siva<DrivenHost<R>>,
    /// Sliding down y: gravity G − R.
    falling: Siva<DrivenHost<R>>,
    friction: R,
}

/// Largest difference of R and |A| where a held mass slides off, in units of 2⁻⁵² of the terms that cancel in it.
const BALANCED_ULPS: f64 = 1024.0;

impl<R: Real> Sliding<R> {
    /// A free mass on a structure under a force (the default one without), with gravity G along the motion and friction R, both
    /// accelerations in ωn² × length: of a mass on a plane of inclination α with the friction coefficient k, G = g sin α and
    /// R = k g cos α.
    ///
    /// # Errors
    /// [`Invalid`] for a friction that is negative or out of [`crate::range`].
    pub fn new(
        siva: &Siva<UndrivenHost<R>>,
        gravity: R,
        friction: R,
        force: Force<R>,
    ) -> Result<Self, Invalid> {
        range::size("absorber.friction", friction)?;
        if friction < 0.0 {
            let rule = "give a deceleration of 0 or more";
            return Err(Invalid::new("absorber.friction", number(friction), rule));
        }
        let inclined = |gravity: R| siva.inclined(gravity, force.clone());
        let [level, rising, falling] =
            [gravity, gravity + friction, gravity - friction].map(inclined);
        rising.host.share(&level.host);
        falling.host.share(&level.host);
        Ok(Self { level, rising, falling, friction })
    }

    /// The deceleration R by friction, in ωn² × length.
    pub fn friction(&self) -> R {
        self.friction
    }

    /// The same mass without friction.
    pub fn without_friction(&self) -> &Siva<DrivenHost<R>> {
        &self.level
    }

    /// The free mass whose flight is the slide in a direction; without friction where the mass is held.
    #[inline]
    pub(crate) fn going(&self, direction: R) -> &Siva<DrivenHost<R>> {
        if direction > 0.0 {
            &self.rising
        } else if direction < 0.0 {
            &self.falling
        } else {
            &self.level
        }
    }

    /// A state as that of a mass that slides in a direction, with A computed anew.
    fn seen_by(&self, direction: R, state: &SivaState<Moment<R>, R>) -> SivaState<Moment<R>, R> {
        if self.friction == 0.0 {
            return *state;
        }
        let host = &self.going(direction).host;
        let phase = host.taken_over(&state.host.phase);
        SivaState { host: host.state(phase, state.host.primary), ..*state }
    }

    /// The state of a mass that goes on in a direction.
    fn towards(&self, direction: R, state: &SivaState<Moment<R>, R>) -> SlidingState<R> {
        SlidingState { seen: self.seen_by(direction, state), direction }
    }

    /// The state of a mass that leaves the wall it touches, or rests on it.
    fn leaving(&self, state: &SivaState<Moment<R>, R>) -> SlidingState<R> {
        self.towards(-state.side, state)
    }

    /// How a mass goes on: as it moves, or where it is at rest, as A says.
    fn decided(&self, state: &SivaState<Moment<R>, R>) -> SlidingState<R> {
        if self.friction == 0.0 {
            return SlidingState { seen: *state, direction: R::ONE };
        }
        let w = state.gap_velocity();
        if w != 0.0 {
            return self.towards(if w > 0.0 { R::ONE } else { -R::ONE }, state);
        }
        if state.distance.value == 0.0 {
            return self.leaving(state);
        }
        for direction in [R::ONE, -R::ONE] {
            let seen = self.seen_by(direction, state);
            let a = seen.host.acceleration.value * direction;
            if a < 0.0 || (a == 0.0 && self.rates_of_a(direction, &seen)[0] * direction < 0.0) {
                return SlidingState { seen, direction };
            }
        }
        self.towards(R::ZERO, state)
    }

    /// The first three derivatives of A of a mass that slides in a direction.
    #[inline]
    fn rates_of_a(&self, direction: R, state: &SivaState<Moment<R>, R>) -> [R; 3] {
        let HostState { primary, acceleration, phase } = &state.host;
        let free = self.going(direction).host.free();
        free.derivatives(phase, primary.v.value, acceleration.value)
    }

    /// At the wall that it touches within rounding, or in the gap.
    fn placed(&self, state: SivaState<Moment<R>, R>) -> SivaState<Moment<R>, R> {
        let across = -state.distance.minus(self.level.mass.clearance * 2.0);
        if state.distance.value <= 0.0 {
            SivaState { distance: DoubleDouble::ZERO, ..state }
        } else if across <= 0.0 {
            SivaState { side: -state.side, distance: DoubleDouble::ZERO, ..state }
        } else {
            state
        }
    }
}

impl<R: Real> Absorber for Sliding<R> {
    type Start = Start<R>;
    type Flight<'a> = SlidingFlight<'a, R>;
    type Ride<'a> = SlidingRide<'a, R>;

    fn clearance(&self) -> R {
        self.level.clearance()
    }

    fn offset(&self) -> R {
        self.level.mass.offset
    }

    fn check_start(&self, start: &Start<R>) -> Result<(), Invalid> {
        self.level.check_start(start)
    }

    fn begin_at(&self, start: &Start<R>, time: Clock<R>) -> SlidingState<R> {
        self.decided(&self.level.begin_at(start, time))
    }

    fn flight(&self, state: &SlidingState<R>) -> SlidingFlight<'_, R> {
        SlidingFlight::new(self, state)
    }

    fn ride(&self, state: &SlidingState<R>) -> SlidingRide<'_, R> {
        SlidingRide::new(self, state)
    }

    fn coasts(
        &self,
        state: &SlidingState<R>,
        remaining: R,
    ) -> (usize, Coasted<SlidingState<R>, R>) {
        if self.friction != 0.0 {
            return (0, (*state, Clock::ZERO));
        }
        let (count, (seen, time)) = self.level.coasts(&state.seen, remaining);
        (count, (SlidingState { seen, ..*state }, time))
    }

    fn coasted(&self, state: &SlidingState<R>, steps: usize) -> Coasted<SlidingState<R>, R> {
        let (seen, time) = self.level.coasted(&state.seen, steps);
        (SlidingState { seen, ..*state }, time)
    }

    fn wall(&self, state: &SlidingState<R>) -> Wall {
        self.level.wall(&state.seen)
    }

    fn distance(&self, state: &SlidingState<R>) -> Jet<R> {
        self.going(state.direction).distance(&state.seen)
    }

    fn touch(&self, state: &SlidingState<R>, wall: Wall) -> (SlidingState<R>, R) {
        let (seen, later) = self.going(state.direction).touch(&state.seen, wall);
        (SlidingState { seen, ..*state }, later)
    }

    fn release(&self, state: &SlidingState<R>) -> (SlidingState<R>, R) {
        let (seen, later) = self.going(state.direction).release(&state.seen);
        (SlidingState { seen, ..*state }, later)
    }

    #[inline]
    fn rubs(&self, _absorber: usize) -> bool {
        self.friction != 0.0
    }

    fn is_held(&self, state: &SlidingState<R>) -> bool {
        state.is_held()
    }

    fn slide<'a>(
        &'a self,
        flight: &SlidingFlight<'a, R>,
        length: R,
    ) -> Option<Slide<SlidingState<R>, R>> {
        let speed = flight.speed();
        if !(flight.fourth().is_finite() && speed.fourth().is_finite()) {
            return None;
        }
        let ends = (flight, &speed);
        Some(first_end(ends, flight.begin(), flight.ahead(), self.clearance(), length))
    }

    fn stopped(&self, state: &SlidingState<R>) -> (SlidingState<R>, R) {
        let SlidingState { seen, direction } = *state;
        let HostState { primary: Primary { x, v }, acceleration, phase } = seen.host;
        let a = acceleration.value;
        let [jerk, ..] = self.rates_of_a(direction, &seen);
        let later = impact::delay(seen.rate.value, seen.side * a, seen.side * jerk);
        let free = self.going(direction).host.free();
        let [base, ..] = free.base(&phase);
        let primary = Primary { x: x.plus(v.value * later), v: v.plus(a * later - base * later) };
        let host = HostState { primary, acceleration, phase: free.later(&phase, later) };
        let distance = seen.distance.plus(seen.rate.value * later * 0.5);
        let at_rest = SivaState { host, distance, rate: DoubleDouble::ZERO, ..seen };
        (self.decided(&self.placed(at_rest)), later)
    }

    fn first_slip<'a>(
        &'a self,
        ride: &SlidingRide<'a, R>,
        length: R,
    ) -> (Stretch<SlidingState<R>, R>, R) {
        ride.first_slip(length)
    }

    fn slipped<'a>(
        &'a self,
        ride: &SlidingRide<'a, R>,
        state: &SlidingState<R>,
        direction: R,
    ) -> Option<(SlidingState<R>, R)> {
        let ride = ride.sliding_off(direction);
        let beyond = ride.jet(state).value.abs();
        if beyond > ride.magnitude() * (R::EPSILON * BALANCED_ULPS) {
            return None;
        }
        let seen = self.seen_by(direction, &state.seen);
        let (released, later) = self.going(direction).release(&seen);
        let seen = SivaState { distance: seen.distance, ..released };
        Some((SlidingState { seen, direction }, later))
    }

    /// μ R |Δy|.
    fn rubbed(&self, [from, to]: [&SlidingState<R>; 2]) -> R {
        let way = (to.seen.distance - from.seen.distance).value.abs();
        self.level.mass_ratio() * self.friction * way
    }

    fn back(&self, state: &SlidingState<R>) -> Option<Back<R>> {
        if self.friction == 0.0 {
            return None;
        }
        let side = state.seen.side;
        let seen = self.seen_by(side, &state.seen);
        let Jet { curvature, jerk, .. } = self.going(side).distance(&seen);
        Some(Back { pressure: -curvature, jerk, spare: -curvature })
    }
}
