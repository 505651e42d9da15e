//! What rides on the structure: [`siva`], a free mass in a gap; [`piva`], a pendulum between two stops; [`modal`], free
//! masses and pendulums, each in a gap of its own at a point of a structure of any number of modes, with springs, dashpots, gravity and friction of each.
//!
//! The event loop ([`crate::engine::simulate`]) knows flights, contacts, impacts and stick episodes only through three
//! traits, each of which builds on the one before; a new absorber implements them, in one file or in a folder.
//!
//! * [`OnStructure`] is what a run sees of the structure: its motion, what drives it, and its energy.
//! * [`ImpactLaw`] is the law of one impact, and its limit for infinitely many. [`impact`] has the formulas of an impact,
//!   [`chatter`] the sum of infinitely many.
//! * [`Absorber`] is the rest: the gap, the start, the flight in the gap, and the ride on a wall. [`ride`] is the motion
//!   with the absorber stuck to its wall.

pub mod chatter;
pub mod derivatives;
pub mod impact;
mod impact_law;
pub mod modal;
mod on_structure;
pub mod piva;
pub(crate) mod plain;
pub mod restitution;
pub mod ride;
pub mod siva;

use crate::absorber::chatter::Back;
use crate::absorber::impact::Impact;
use crate::absorber::plain::Scene;
use crate::error::Invalid;
use crate::number::real::Real;
use crate::segment::flight::{Curve, Jet, Motion};
use crate::segment::slide::{Ends, Slide, Slip};

pub use crate::number::clock::Clock;
pub use crate::segment::place::{Point, Wall};
pub use impact_law::{ImpactLaw, LawAt};
pub use on_structure::OnStructure;

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

/// The absorbers in a motion of a decay that is logged.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Aboard {
    /// The mass ratio of those that are stuck to the structure.
    pub carried: f64,
    /// Absolute velocity of the absorber in flight; of several that with which one mass, as large as all of them, would have
    /// the kinetic energy of those in flight.
    pub velocity: f64,
    /// Distance of a single absorber from wall −.
    pub height: f64,
}

/// The state after some steps of a flight, and the time that they take.
pub type Coasted<State, R = f64> = (State, Clock<R>);
/// The number of steps of a coast, and what it ends in; `None` of none.
pub type Coasts<State, R = f64> = Option<(usize, Coasted<State, R>)>;

/// A motion so short that it is known at once, up to a contact.
#[derive(Debug, Clone, Copy)]
pub struct Hop<State, R = f64> {
    /// Its length.
    pub time: R,
    /// The absorber that meets the wall which it left last.
    pub absorber: usize,
    /// The state at the contact, to rounding.
    pub end: State,
}

/// An absorber on its primary system.
///
/// A state in flight measures the gap from the wall last touched: its *distance* is ≥ 0 and
/// exactly 0 at a contact, so that a rebound keeps its relative accuracy however low it is.
pub trait Absorber: ImpactLaw {
    /// The form in which a start is given.
    type Start: Copy + std::fmt::Debug;
    /// The flight of the absorber in its gap; its curve is the distance to the wall last touched.
    type Flight<'a>: Motion<Real = Self::Real, State = Self::State> + Curve<Real = Self::Real>
    where
        Self: 'a;
    /// The stick episode on a wall; its curve is the pressure on that wall per unit mass.
    type Ride<'a>: Motion<Real = Self::Real, State = Self::State> + Curve<Real = Self::Real>
    where
        Self: 'a;

    /// How many absorbers are on the structure. One of them is *at hand* in a state: what is asked about the absorber
    /// in that state, such as its wall, its distance, and its impact, is asked about that one.
    #[inline(always)]
    fn absorbers(&self) -> usize {
        1
    }
    /// The index of the absorber at hand.
    #[inline(always)]
    fn at_hand(&self, _state: &Self::State) -> usize {
        0
    }
    /// Takes the absorber of this index at hand.
    #[inline(always)]
    fn take_at_hand(&self, _state: &mut Self::State, _absorber: usize) {}
    /// The same state with the absorber of this index at hand.
    #[inline(always)]
    fn turned_to(&self, state: &Self::State, absorber: usize) -> Self::State {
        let mut turned = *state;
        self.take_at_hand(&mut turned, absorber);
        turned
    }
    /// Makes the curve of a motion that of the absorber of this index.
    fn turn<'a>(&'a self, _flight: &mut Self::Flight<'a>, _absorber: usize) {}
    /// True if several absorbers are on the structure and the one at hand is stuck to its wall.
    fn is_stuck(&self, _state: &Self::State) -> bool {
        false
    }
    /// The same state with the absorber at hand free, if it was stuck.
    fn freed(&self, state: &Self::State) -> Self::State {
        *state
    }
    /// The absorber whose impact comes first, where those of all that touch their walls would gain energy as one event; `None` where they are one.
    fn strikes_first(&self, _state: &Self::State) -> Option<usize> {
        None
    }
    /// True if another absorber may meet its wall, or leave it, in a time in which the one at hand chatters.
    fn others_meet(&self, _state: &Self::State, _time: Self::Real) -> bool {
        false
    }
    /// True if another absorber is stuck to its wall, or has just left it.
    fn others_touch(&self, _state: &Self::State) -> bool {
        false
    }
    /// The size of the velocities of the structure at the point of the absorber at hand.
    fn speeds(&self, _state: &Self::State) -> Self::Real {
        Self::Real::ZERO
    }
    /// True if it is proved that no other absorber meets a wall, or leaves one, in a time in which the one at hand
    /// chatters.
    fn others_wait(&self, _state: &Self::State, _time: Self::Real) -> bool {
        true
    }

    /// One-sided clearance d, half of the total play; of several absorbers the smallest.
    fn clearance(&self) -> Self::Real;
    /// The clearance of the absorber of this index.
    #[inline(always)]
    fn clearance_of(&self, _absorber: usize) -> Self::Real {
        self.clearance()
    }
    /// The clearance of the absorber at hand.
    #[inline(always)]
    fn clearance_at_hand(&self, state: &Self::State) -> Self::Real {
        self.clearance_of(self.at_hand(state))
    }
    /// Half of the way from wall to wall of the absorber of this index: ∞ where it has one wall only.
    #[inline(always)]
    fn half_play_of(&self, absorber: usize) -> Self::Real {
        self.clearance_of(absorber)
    }
    /// Between which values of y the absorber of this index moves.
    fn walls_of(&self, absorber: usize) -> [Self::Real; 2] {
        let (middle, d) = (self.offset_of(absorber), self.clearance_of(absorber));
        [middle - d, middle + d]
    }
    /// The middle of the gap, as a value of y: the walls are at y = offset ± d.
    fn offset(&self) -> Self::Real {
        Self::Real::ZERO
    }
    /// The middle of the gap of the absorber of this index.
    #[inline(always)]
    fn offset_of(&self, _absorber: usize) -> Self::Real {
        self.offset()
    }
    /// Displacement of the absorber's centre of mass relative to the structure, per gap displacement: 1 for a
    /// free mass, L/b for a pendulum.
    fn lever(&self) -> Self::Real {
        Self::Real::ONE
    }
    /// Displacement, velocity and acceleration of the centre of mass of the absorber of this index relative to the structure, along the line of its motion, from those
    /// in its gap.
    #[inline(always)]
    fn beside(&self, _absorber: usize, gap: [Self::Real; 3]) -> [Self::Real; 3] {
        gap.map(|it| self.lever() * it)
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
    /// The flight from a state.
    fn flight(&self, state: &Self::State) -> Self::Flight<'_>;
    /// The stick episode on the wall that the state touches.
    fn ride(&self, state: &Self::State) -> Self::Ride<'_>;
    /// Which absorbers are stuck and press on their walls, one bit each, as far as that is seen of all at once.
    fn surely_pressing(&self, _state: &Self::State) -> u64 {
        0
    }
    /// The next contact, if the motion up to it is so short that it is known at once.
    fn hop(
        &self,
        _state: &Self::State,
        _remaining: Self::Real,
    ) -> Option<Hop<Self::State, Self::Real>> {
        None
    }
    /// The motion of a hop of this length.
    fn hopping(&self, state: &Self::State, _time: Self::Real) -> Self::Flight<'_> {
        self.flight(state)
    }
    /// True if flights that begin at a wall coast too, before they are searched.
    const LEAPS: bool = false;
    /// How many steps (of one length, or pieces of a record) a flight is proved to go on without meeting a wall
    /// within the time `remaining`; and the state after them, with the time that they take. `None` of none.
    fn coasts(
        &self,
        _state: &Self::State,
        _remaining: Self::Real,
    ) -> Coasts<Self::State, Self::Real> {
        None
    }
    /// The state after some of these steps, and the time that they take.
    fn coasted(&self, state: &Self::State, _steps: usize) -> Coasted<Self::State, Self::Real> {
        (*state, Clock::ZERO)
    }
    /// The wall that distances are measured from.
    fn wall(&self, state: &Self::State) -> Wall;
    /// Distance to that wall and its derivatives in free motion.
    fn distance(&self, state: &Self::State) -> Jet<Self::Real>;
    /// Distance and rate of the absorber of this index alone.
    fn approach_of(&self, state: &Self::State, absorber: usize) -> [Self::Real; 2] {
        let Jet { value, rate, .. } = self.distance(&self.turned_to(state, absorber));
        [value, rate]
    }
    /// The state in contact with `wall`, and how much later it is: the small distance left over by rounding
    /// is covered at constant rate.
    fn touch(&self, state: &Self::State, wall: Wall) -> (Self::State, Self::Real);
    /// The state at the release, with distance, rate and pressure exactly 0, and the time from the given
    /// state to it.
    fn release(&self, state: &Self::State) -> (Self::State, Self::Real);
    /// True if the absorber can reach its walls at all.
    fn walls_reachable(&self) -> bool {
        true
    }
    /// True if the absorber of this index rubs on its structure: a flight also ends where it stops in the gap, and friction may hold it
    /// there. Then the methods below have a meaning; by default nothing rubs.
    #[inline(always)]
    fn rubs(&self, _absorber: usize) -> bool {
        false
    }
    /// True if friction holds the absorber at hand in its gap.
    fn is_held(&self, _state: &Self::State) -> bool {
        false
    }
    /// The first event of a flight of this length in which the absorber slides one way: a stop or a contact; `None` if its bounds
    /// are not finite.
    fn slide<'a>(
        &'a self,
        _flight: &Self::Flight<'a>,
        length: Self::Real,
    ) -> Option<Slide<Self::Real>> {
        Some(Slide { h: length, ends: Ends::Length, undecided: 0 })
    }
    /// The state at a stop, with a gap velocity of exactly 0 and the decision how the absorber goes on, and how much later
    /// it is.
    fn stopped(&self, state: &Self::State) -> (Self::State, Self::Real) {
        (*state, Self::Real::ZERO)
    }
    /// The first instant within a length at which friction no longer holds the absorber.
    fn first_slip<'a>(&'a self, _ride: &Self::Ride<'a>, length: Self::Real) -> Slip<Self::Real> {
        Slip { h: length, direction: None, undecided: 0 }
    }
    /// The state in which the absorber slips off with this sign of its gap velocity at the end of a ride, and the time from the
    /// given state to it; `None` if that is no such instant.
    fn slipped<'a>(
        &'a self,
        _ride: &Self::Ride<'a>,
        _state: &Self::State,
        _direction: Self::Real,
    ) -> Option<(Self::State, Self::Real)> {
        None
    }
    /// The energy that friction takes in the slides of all absorbers between two states, per primary mass.
    fn rubbed(&self, _ends: [&Self::State; 2]) -> Self::Real {
        Self::Real::ZERO
    }
    /// How the absorber returns from a rebound that begins in a state; `None` if it returns in the same motion.
    fn back(&self, _state: &Self::State) -> Option<Back<Self::Real>> {
        None
    }
    /// What the log of a decay keeps of the absorbers in a state, in which a single one is stuck or not.
    fn aboard(&self, state: &Self::State, stuck: bool) -> Aboard {
        let (gap, side) = (self.distance(state), self.wall(state).sign());
        let [distance, rate, v] = [gap.value, gap.rate, self.primary(state).v].map(Real::double);
        let (clearance, mass_ratio) = (self.clearance().double(), self.mass_ratio().double());
        let [carried, velocity] = if stuck { [mass_ratio, 0.0] } else { [0.0, v - side * rate] };
        let height = if side > 0.0 { 2.0 * clearance - distance } else { distance };
        Aboard { carried, velocity, height }
    }
    /// A free mass on a level line under one harmonic force, or on a base that it moves, in doubles. Its measures
    /// are computed from a log.
    fn forced(&self) -> Option<Scene> {
        None
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
