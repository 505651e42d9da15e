//! What a run has come to: its counts and sums, and an instant of it.

use super::limits::Outcome;
use crate::absorber::{Absorber, Clock};
use crate::number::real::Real;

/// Counts and sums of a run, in natural units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tally<State, R = f64> {
    /// How the run ended.
    pub outcome: Outcome,
    /// Number of listed impacts.
    pub impacts: u64,
    /// Number of listed impacts at which the masses moved towards each other.
    pub effective_impacts: u64,
    /// Number of stick episodes: chatters that ended in stick, plastic sticks, starts at rest on a pressed
    /// wall.
    pub episodes: u64,
    /// Number of grazing extrema within rounding of a wall, counted as no contact.
    pub undecided: u64,
    /// Largest approach speed of all impacts on wall + and on wall −; 0 without any.
    pub approach_speeds: [R; 2],
    /// Total time stuck on a wall, in 1/ωn.
    pub time_stuck: R,
    /// Energy lost in all impacts, listed or summed.
    pub energy_impacts: R,
    /// What friction in the gap has done.
    pub friction: Rubbed<R>,
    /// Instant at which the run ended, in 1/ωn.
    pub end_time: R,
    /// Number of segments of flight and stick episode computed, and of impulses; steps of a coast count where they are leaps of a system with modes, else not.
    pub work: u64,
    /// The last state.
    pub state: State,
    /// The instant of the last state, in double-double.
    pub clock: Clock<R>,
}

/// What friction has done in a run to an absorber that rubs in its gap; nothing for any other.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rubbed<R = f64> {
    /// Energy lost in friction, per primary mass in ωn² × length².
    pub energy: Clock<R>,
    /// Number of stops in the gap.
    pub stops: u64,
    /// Number of stops after which the absorber was held; the others turned it round.
    pub holds: u64,
    /// Total time held in the gap, in 1/ωn.
    pub time_held: Clock<R>,
}

/// What a run has come to for one of several absorbers, in natural units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OfAbsorber<R = f64> {
    /// Number of its listed impacts.
    pub impacts: u64,
    /// Number of its listed impacts at which the masses moved towards each other.
    pub effective_impacts: u64,
    /// Number of its stick episodes.
    pub episodes: u64,
    /// Largest approach speed on wall + and on wall −; 0 without any.
    pub approach_speeds: [R; 2],
    /// Total time stuck on a wall, in 1/ωn.
    pub time_stuck: R,
    /// Energy lost in all its impacts, listed or summed.
    pub energy_impacts: R,
    /// Its largest impulse over the mass of the structure, in ωn × length.
    pub impulse: R,
}

impl<State: Copy, R: Real> Tally<State, R> {
    /// That of the absorber of a run that has one, with its largest impulse.
    pub fn of_absorber(&self, impulse: R) -> OfAbsorber<R> {
        let Self { impacts, effective_impacts, episodes, approach_speeds, .. } = *self;
        let Self { time_stuck, energy_impacts, .. } = *self;
        OfAbsorber {
            impacts,
            effective_impacts,
            episodes,
            approach_speeds,
            time_stuck,
            energy_impacts,
            impulse,
        }
    }

    /// The same counts and sums without the last state, for runs of any kind of scene side by side.
    pub fn without_state(&self) -> Tally<(), R> {
        let Self { outcome, impacts, effective_impacts, episodes, undecided, .. } = *self;
        let Self { approach_speeds, time_stuck, energy_impacts, end_time, work, clock, .. } = *self;
        let friction = self.friction;
        Tally {
            outcome,
            impacts,
            effective_impacts,
            episodes,
            undecided,
            approach_speeds,
            time_stuck,
            energy_impacts,
            friction,
            end_time,
            work,
            state: (),
            clock,
        }
    }

    /// The end of the run, from which another run can go on.
    pub fn instant(&self) -> Instant<State, R> {
        Instant { time: self.clock, state: self.state }
    }
}

/// An instant of a run, and the state at that instant.
///
/// The state of a driven system holds the instant of its drive. It is this instant, unless the state was made
/// for another one ([`Absorber::begin_at`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instant<State, R = f64> {
    /// The instant, in 1/ωn.
    pub time: Clock<R>,
    /// In flight, or stuck to the wall that it touches.
    pub state: State,
}

impl<State, R: Real> Instant<State, R> {
    /// A start at time zero.
    pub fn start<S: Absorber<Real = R, State = State>>(system: &S, start: &S::Start) -> Self {
        Self::at(system, start, R::ZERO)
    }

    /// A start at an instant.
    pub fn at<S: Absorber<Real = R, State = State>>(system: &S, start: &S::Start, time: R) -> Self {
        let time = Clock::new(time);
        Self { time, state: system.begin_at(start, time) }
    }
}
