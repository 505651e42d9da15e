//! The interface between an absorber and the event loop.
//!
//! The loop ([`crate::engine::simulate`]) knows flights, contacts, impacts and stick episodes only through these
//! traits; a new absorber is one file that implements them.

use crate::absorber::impact::{Impact, primary_share};
use crate::absorber::plain::Scene;
use crate::error::Invalid;
use crate::host::{Excitation, Sinusoidal};
pub use crate::number::clock::Clock;
use crate::number::real::Real;
use crate::segment::flight::{Curve, Jet, Motion};
pub use crate::segment::place::{Point, Wall};

/// State at time zero, in natural units (time in 1/ωn, lengths in the user's unit).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Start<R = f64> {
    /// Displacement x of the primary system.
    pub displacement: R,
    /// Velocity ẋ of the primary system.
    pub velocity: R,
    /// Gap displacement y.
    pub gap_displacement: R,
    /// Gap velocity w.
    pub gap_velocity: R,
}

/// Angle of a pendulum and its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Angle<R = f64> {
    /// θ from the hanging position, in [−π, π].
    pub value: R,
    /// θ̇ in ωn.
    pub rate: R,
}

/// The impact law at one wall, for impacts of one approach speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawAt<R = f64> {
    /// Newton's coefficient e on the gap velocity.
    pub restitution: R,
    /// The speed of the rebound over the approach speed: the ratio of consecutive rebounds of a chatter.
    pub rebound: R,
    /// Velocity that the structure gains per gap velocity: the impulse over the mass of the structure.
    pub gain: R,
    /// Rise of the pressure on the wall at an impact, over the approach speed: the damper responds to the jump of the
    /// structure's velocity.
    pub pressure: R,
    /// The derivative of the speed of the rebound with respect to the approach speed.
    pub slope: R,
    /// A bound on how far `rebound` is from this value at any lower approach speed.
    pub spread: R,
}

impl<R: Real> LawAt<R> {
    /// A law that is the same at every approach speed.
    pub fn constant(restitution: R, rebound: R, gain: R, pressure: R) -> Self {
        Self { restitution, rebound, gain, pressure, slope: rebound, spread: R::ZERO }
    }

    /// The law of a free mass of mass ratio μ whose e depends on the approach speed w: e, de/dw, a bound on how far e
    /// is from this value at any lower approach speed, and the damping ratio ζ of the structure.
    pub fn of_free_mass(
        mass_ratio: R,
        [restitution, rate, spread]: [R; 3],
        approach: R,
        damping_ratio: R,
    ) -> Self {
        let gain = primary_share(mass_ratio, restitution).value;
        let pressure = damping_ratio * 2.0 * gain;
        let slope = restitution + rate * approach;
        Self { slope, spread, ..Self::constant(restitution, restitution, gain, pressure) }
    }

    /// The derivatives of the velocity that the structure gains, and of the speed of the rebound, with respect to the
    /// approach speed. The impulse grows with 1 + e.
    pub fn slopes(&self) -> [R; 2] {
        let Self { rebound, gain, slope, .. } = *self;
        let steeper = if slope == rebound { R::ONE } else { (R::ONE + slope) / (R::ONE + rebound) };
        [gain * steeper, slope]
    }

    /// True if rebounds from this speed on become ever lower.
    pub fn dies_out(&self) -> bool {
        self.rebound + self.spread < 1.0
    }
}

/// The state after some steps of a flight, and the time that they take.
pub type Coasted<State, R = f64> = (State, Clock<R>);

/// An absorber on its primary system.
///
/// A state in flight measures the gap from the wall last touched: its *distance* is ≥ 0 and
/// exactly 0 at a contact, so that a rebound keeps its relative accuracy however low it is.
pub trait System {
    /// The number type of the motion.
    type Real: Real;
    /// What drives the structure.
    type Excitation: Excitation<Real = Self::Real>;
    /// The state between events.
    type State: Copy + std::fmt::Debug;
    /// The form in which a start is given.
    type Start: Copy + std::fmt::Debug;
    /// The flight of the absorber in its gap; its curve is the distance to the wall last touched.
    type Flight<'a>: Motion<Real = Self::Real, State = Self::State>
        + Curve<Real = Self::Real, Sample = Self::State>
    where
        Self: 'a;
    /// The stick episode on a wall; its curve is the pressure on that wall per unit mass.
    type Ride<'a>: Motion<Real = Self::Real, State = Self::State>
        + Curve<Real = Self::Real, Sample = Self::State>
    where
        Self: 'a;

    /// What drives the structure.
    fn excitation(&self) -> &Self::Excitation;
    /// The state of the drive in a state.
    fn phase(state: &Self::State) -> &<Self::Excitation as Excitation>::Phase;

    /// Mass ratio μ; 0 without absorber.
    fn mass_ratio(&self) -> Self::Real;
    /// One-sided clearance d, half of the total play.
    fn clearance(&self) -> Self::Real;
    /// The middle of the gap, as a value of y: the walls are at y = offset ± d.
    fn offset(&self) -> Self::Real {
        Self::Real::ZERO
    }
    /// The impact law at a wall, for impacts of an approach speed.
    fn law_at(&self, wall: Wall, approach: Self::Real) -> LawAt<Self::Real>;
    /// Displacement of the absorber's centre of mass relative to the structure, per gap displacement: 1 for a
    /// free mass, L/b for a pendulum.
    fn lever(&self) -> Self::Real {
        Self::Real::ONE
    }

    /// Checks that a start lies in the gap.
    ///
    /// # Errors
    /// [`Invalid`] naming the field.
    fn check_start(&self, _start: &Self::Start) -> Result<(), Invalid> {
        Ok(())
    }
    /// The state of a start, with the drive at an instant. Its distance is exactly 0 at a wall.
    fn begin_at(&self, start: &Self::Start, time: Clock<Self::Real>) -> Self::State;

    /// The state of a start at time zero.
    fn begin(&self, start: &Self::Start) -> Self::State {
        self.begin_at(start, Clock::ZERO)
    }
    /// The same places and velocities with the drive of another state.
    fn with_drive_of(&self, state: &Self::State, _like: &Self::State) -> Self::State {
        *state
    }
    /// The flight from a state.
    fn flight(&self, state: &Self::State) -> Self::Flight<'_>;
    /// The stick episode on the wall that the state touches.
    fn ride(&self, state: &Self::State) -> Self::Ride<'_>;
    /// How many steps (of one length, or pieces of a record) a flight is proved to go on without meeting a wall
    /// within the time `remaining`; and the state after them, with the time that they take.
    fn coasts(
        &self,
        state: &Self::State,
        _remaining: Self::Real,
    ) -> (usize, Coasted<Self::State, Self::Real>) {
        (0, (*state, Clock::ZERO))
    }
    /// The state after some of these steps, and the time that they take.
    fn coasted(&self, state: &Self::State, _steps: usize) -> Coasted<Self::State, Self::Real> {
        (*state, Clock::ZERO)
    }
    /// The wall that distances are measured from.
    fn wall(&self, state: &Self::State) -> Wall;
    /// Distance to that wall and its derivatives in free motion.
    fn distance(&self, state: &Self::State) -> Jet<Self::Real>;
    /// The state in contact with `wall`, and how much later it is: the small distance left over by rounding
    /// is covered at constant rate.
    fn touch(&self, state: &Self::State, wall: Wall) -> (Self::State, Self::Real);
    /// Applies the impact law to a state in contact: the state after the impact, and its record.
    fn impact(&self, state: &Self::State, time: Self::Real) -> (Self::State, Impact<Self::Real>);
    /// The state after an infinite tail of rebounds, stuck with the common velocity, and the energy lost in
    /// the tail.
    fn stick(&self, state: &Self::State) -> (Self::State, Self::Real);
    /// The state at the release, with distance, rate and pressure exactly 0, and the time from the given
    /// state to it.
    fn release(&self, state: &Self::State) -> (Self::State, Self::Real);
    /// Displacement and velocity of the primary.
    fn primary(&self, state: &Self::State) -> Point<Self::Real>;
    /// Total energy per primary mass.
    fn energy(&self, state: &Self::State) -> Self::Real;
    /// True if the absorber can reach its walls at all.
    fn walls_reachable(&self) -> bool {
        true
    }
    /// The structure of a free mass in doubles, if its motion between events is a damped sinusoid in closed form
    /// (`host/sinusoid.rs`). The measures of its decays are computed from a log.
    fn sinusoidal(&self) -> Option<Sinusoidal> {
        None
    }
    /// A free mass on a level line under one harmonic force, or on a base that it moves, in doubles. Its measures
    /// are computed from a log.
    fn forced(&self) -> Option<Scene> {
        None
    }
    /// The state after the impulse that is due, of P/M = `velocity`, with the absorber free or stuck to its
    /// wall.
    fn apply_impulse(
        &self,
        state: &Self::State,
        _velocity: Self::Real,
        _stuck: bool,
    ) -> Self::State {
        *state
    }
    /// Angle and angular velocity of a pendulum; `None` for an absorber without angle.
    fn angle(&self, _state: &Self::State) -> Option<Angle<Self::Real>> {
        None
    }
    /// Angles and angular velocities just before and just after an impact.
    fn impact_angles(&self, _impact: &Impact<Self::Real>) -> Option<[Angle<Self::Real>; 2]> {
        None
    }
}
