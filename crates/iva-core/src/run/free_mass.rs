//! Free masses in lanes, in both accuracy tiers.
//!
//! The exact tier carries states in double-double: measured errors of event times τ are below one rounding unit,
//! 2⁻⁵³ (max(condition, 1) + τ). In the fast tier states are plain doubles and only the clock is compensated: every
//! stretch of flight adds rounding errors, and the errors are some rounding units. The guarantee
//! on events is the same: every stretch is proved to meet no wall, or one wall once, for the motion as computed.
//! What is not simple (a low rebound, the sum of a chatter, a stick episode, a grazing) is left to the event loop,
//! from the same state.
//!
//! One round of a lane tries a stretch of flight and finds the contact in it ([`crate::absorber::siva::trial`]), so that
//! nearly every round completes a stretch; then it decides what follows ([`round::commit`]). Where nothing drives
//! the structure, an absorber far from its walls coasts ([`crate::absorber::siva::coasts`]). A [`Tier`] has the numbers of
//! a state, and what its motion depends on. Lanes only move, and log what measures need: free decays
//! ([`super::decays`]) the begins of their motions, driven runs ([`super::forced`]) their flights.

mod cycles;
mod exact;
mod fast;
mod lane;
mod listing;
mod round;
mod shown;
mod unforced;

use super::side_by_side::{ScalarRun, SideBySide};
use crate::absorber::plain::State;
use crate::absorber::siva::trial::{FreeMass, Sight, search};
use crate::absorber::siva::{Law, coasts};
use crate::absorber::{Aboard, Absorber, Clock, OnStructure};
use crate::engine::simulate::{Run, Tally};
use crate::host::Steps;
use crate::measures::forced::Forced;
use crate::measures::height;
use crate::measures::log::Entry;
use crate::number::arrays::{Laned, Lanes, any};
use crate::number::real::pick;

pub(crate) use exact::{ExactDecays, ExactDriven};
pub(crate) use fast::FastDriven;
use lane::Lane;
use listing::Struck;
use round::{Round, Rounds, commit, decide};
use shown::keep_coasts;
pub(crate) use unforced::ExactUnforced;

/// Free masses of one tier and one kind of drive: what the motions of all lanes depend on.
pub(crate) trait Tier: Sized {
    /// A free mass on its structure.
    type System: SideBySide;
    /// The state of a lane.
    type State: Laned;
    /// The responses that a lane coasts by.
    type Responses: Laned + Default;
    /// The motion of a lane.
    type Mass<'a>: FreeMass<Real = f64, State = Self::State>
    where
        Self: 'a;
    /// True if the stages of a round go through all lanes one after the other, so that a processor can overlap
    /// them; false if too much would have to be stored in between.
    const STAGED: bool;

    /// Idle lanes for absorbers on a structure like that of this one.
    fn new(system: &Self::System) -> Self;
    /// The impact laws at wall + and at wall −.
    fn laws(system: &Self::System) -> [Law; 2];
    /// A state in plain doubles.
    fn in_doubles(state: &<Self::System as OnStructure>::State) -> State;
    /// Uses the motion of a lane from a state.
    fn with<T>(
        &self,
        i: usize,
        from: &Self::State,
        act: impl FnOnce(&Self::Mass<'_>, &Self::State) -> T,
    ) -> T;
    /// The longest stretch of a lane.
    fn longest(&self, i: usize) -> f64;
    /// The state at an instant, its force evaluated anew where the tier needs that.
    #[inline(always)]
    fn refreshed(&self, _i: usize, state: &Self::State, _clock: Clock) -> Self::State {
        *state
    }
    /// The motion of a structure without drive over whole steps.
    #[inline(always)]
    fn steps(&self) -> Option<&Steps> {
        None
    }
    /// The responses of the structure after a number of steps.
    #[inline(always)]
    fn responses(_steps: &Steps, _count: usize) -> Self::Responses {
        Self::Responses::default()
    }
    /// The state after these steps.
    #[inline(always)]
    fn coasted(
        _steps: &Steps,
        state: &Self::State,
        _count: f64,
        _by: Self::Responses,
    ) -> Self::State {
        *state
    }
    /// Loads the motion from an instant of a run into a lane; its state.
    fn load(&mut self, i: usize, from: &Loaded<'_, Self::System>) -> Option<Self::State>;
    /// The state in the form of the event loop.
    fn unload(
        &self,
        state: &Self::State,
        system: &Self::System,
        clock: Clock,
    ) -> <Self::System as OnStructure>::State;
    /// [`Tier::unload`] for who needs no derivatives of the force.
    #[inline(always)]
    fn shown(
        &self,
        state: &Self::State,
        system: &Self::System,
        clock: Clock,
    ) -> <Self::System as OnStructure>::State {
        self.unload(state, system, clock)
    }
    /// Makes a lane idle; its state.
    fn idle(&mut self, i: usize) -> Self::State;
}

/// A flight of a lane: the instant and the state of its begin, its length, high and low part, whether it ends with
/// an impact, and whether that is on the far wall.
#[derive(Debug, Clone, Copy)]
struct Stretch<State> {
    pub clock: Clock,
    pub from: State,
    pub h: f64,
    pub later: f64,
    pub hit: bool,
    pub far: bool,
    /// The number of steps that the mass coasts after it.
    pub coasts: f64,
}

/// The run of a lane in the event loop.
type TierRun<'a, T> = ScalarRun<'a, <T as Tier>::System>;

/// An instant of a run from which a lane goes on.
#[derive(Debug)]
pub(crate) struct Loaded<'a, S: Absorber> {
    pub system: &'a S,
    pub clock: Clock,
    pub state: S::State,
    /// The tables of a driven motion in plain doubles.
    pub forced: Option<&'a Forced>,
}

/// What every [`Tier`] of [`Siva`](crate::absorber::siva::Siva) has.
macro_rules! of_siva {
    () => {
        fn laws(system: &Self::System) -> [$crate::absorber::siva::Law; 2] {
            *system.laws()
        }

        fn in_doubles(
            state: &<Self::System as $crate::absorber::OnStructure>::State,
        ) -> $crate::absorber::plain::State {
            state.in_doubles()
        }
    };
}
use of_siva;

/// Lanes of free masses.
#[derive(Debug)]
pub(crate) struct FreeMasses<T: Tier, const W: usize> {
    lanes: lane::Lanes<W>,
    rounds: Rounds<W>,
    tier: T,
    /// The states at the begin of each trial.
    states: <T::State as Laned>::Lanes<W>,
    /// The states at the end of each trial, after an impact.
    ends: <T::State as Laned>::Lanes<W>,
    /// The numbers of steps that the lanes coast, and the responses after them.
    counts: [f64; W],
    responses: <T::Responses as Laned>::Lanes<W>,
    /// What of each lane its run has not listed yet; empty if nothing is to be listed.
    struck: Vec<Struck<T::State>>,
    /// The flights of each lane that observers have not seen yet, if they are to see them; empty if no lane's are.
    flights: Vec<Option<Vec<Stretch<T::State>>>>,
}

impl<T: Tier, const W: usize> FreeMasses<T, W> {
    /// Idle lanes for absorbers on a structure like that of this one.
    pub fn new(system: &T::System) -> Self {
        Self {
            lanes: Lanes::new(),
            rounds: Lanes::new(),
            tier: T::new(system),
            states: Lanes::new(),
            ends: Lanes::new(),
            counts: [0.0; W],
            responses: Lanes::new(),
            struck: Vec::new(),
            flights: Vec::new(),
        }
    }

    /// One trial of each lane.
    #[inline(always)]
    pub fn attempt(&mut self) {
        let Self { lanes, rounds, tier, states, ends, .. } = self;
        for i in 0..W {
            let (lane, from) = (lanes.get(i), states.get(i));
            tier.with(
                i,
                &from,
                #[inline(always)]
                |mass, from| {
                    let sight = search(mass, from, &lane.trial, lane.over_clearance);
                    let mut round = Round { sight, ..Round::default() };
                    if !T::STAGED {
                        let after;
                        (round, after) = decide(mass, &lane, from, &sight);
                        ends.set(i, &after);
                    }
                    rounds.set(i, &round);
                },
            );
        }
        for i in 0..if T::STAGED { W } else { 0 } {
            let (lane, from, sight) = (lanes.get(i), states.get(i), rounds.get(i).sight);
            tier.with(
                i,
                &from,
                #[inline(always)]
                |mass, from| {
                    let (round, after) = decide(mass, &lane, from, &sight);
                    ends.set(i, &after);
                    rounds.set(i, &round);
                },
            );
        }
    }

    /// Applies what the trials have found; true if a lane needs its run.
    #[inline(always)]
    pub fn advance(&mut self) -> bool {
        let shown = !self.flights.is_empty() && self.keep_flights();
        let Self { lanes, rounds, tier, states, ends, .. } = self;
        for i in 0..W {
            let (lane, round) = (lanes.get(i), rounds.get(i));
            let clock = lane.progress.clock.plus_parts(round.sight.h, round.later);
            let after = tier.refreshed(i, &ends.get(i), clock);
            states.set(i, &Laned::pick(round.passed, &after, &states.get(i)));
            lanes.set(i, &commit(&lane, &round, clock, tier.longest(i)));
        }
        let full = shown | (!self.struck.is_empty() && self.list());
        let Self { lanes, rounds, tier, states, counts, responses, .. } = self;
        let requests = full | any(&lanes.request) | any(&lanes.stopped) | any(&lanes.full);
        let Some(steps) = tier.steps() else { return requests };
        for i in 0..W {
            let (lane, round) = (lanes.get(i), rounds.get(i));
            let within = [lane.over_clearance, lane.progress.remaining()];
            let count = coasts::count(steps, &T::Mass::in_doubles(&states.get(i)), within);
            counts.set(i, &pick(round.passed & !round.hit, count, 0.0));
        }
        if any(counts) {
            keep_coasts(&mut self.flights, counts);
            for i in 0..W {
                let count: f64 = counts.get(i);
                responses.set(i, &T::responses(steps, count as usize));
            }
            for i in 0..W {
                let (lane, state, count) = (lanes.get(i), states.get(i), counts.get(i));
                let coasted = T::coasted(steps, &state, count, responses.get(i));
                states.set(i, &Laned::pick(count > 0.0, &coasted, &state));
                let later = lane.later(steps.time(count), tier.longest(i));
                let clock = Laned::pick(count > 0.0, &later.progress.clock, &lane.progress.clock);
                lanes.progress.clock.set(i, &clock);
                let length = pick(count > 0.0, later.trial.length, lane.trial.length);
                lanes.trial.length.set(i, &length);
            }
        }
        requests
    }

    /// The flight that the trial of a lane has completed: the clock at its begin, its length, instant and approach
    /// speed of the impact at its end (0: none), and the states at both ends, the latter before the impact. To be
    /// asked for before [`FreeMasses::advance`].
    #[inline(always)]
    pub fn flight(&self, i: usize) -> Option<(Clock, f64, [f64; 2], [State; 2])> {
        let Round { passed, sight: Sight { h, .. }, later, hit, v, rate, .. } = self.rounds.get(i);
        passed.then(|| {
            let clock = self.lanes.progress.clock.get(i);
            let impact = [clock.plus_parts(h, later).value, if hit { -rate } else { 0.0 }];
            let begin = T::Mass::in_doubles(&self.states.get(i));
            let end = State { v, rate, ..T::Mass::in_doubles(&self.ends.get(i)) };
            (clock, h + later, impact, [begin, end])
        })
    }

    /// The clock of each lane.
    #[inline(always)]
    pub fn times(&self) -> &[f64; W] {
        &self.lanes.progress.clock.value
    }

    /// True if a trial has found an impact in any lane.
    #[inline(always)]
    pub fn hits(&self) -> bool {
        any(&self.rounds.hit)
    }

    /// The begin of the motion after the impact that the trial of a lane has found, if it has. To be asked for after
    /// [`FreeMasses::advance`].
    #[inline(always)]
    pub fn motion(&self, i: usize) -> Option<Entry> {
        let Round { hit, v: v_before, .. } = self.rounds.get(i);
        hit.then(|| {
            let State { x, v, side, rate, .. } = T::Mass::in_doubles(&self.states.get(i));
            let height = height(self.lanes.clearance[i], side, 0.0);
            let aboard = Aboard { carried: 0.0, velocity: v - side * rate, height };
            Entry::new(self.lanes.progress.clock.get(i), [x, v], v_before, aboard)
        })
    }

    /// True if a lane needs its run.
    pub fn requests(&self, i: usize) -> bool {
        let full = self.struck.get(i).is_some_and(Struck::is_full) || self.must_show(i);
        full || self.lanes.request[i] + self.lanes.stopped[i] + self.lanes.full[i] > 0.0
    }

    /// Makes a lane idle.
    pub fn idle(&mut self, i: usize) {
        if let Some(flights) = self.flights.get_mut(i) {
            *flights = None;
        }
        let state = self.tier.idle(i);
        self.states.set(i, &state);
        self.lanes.set(i, &Lane::idle());
    }

    /// Loads a run into a lane; false if the run is not at a state from which the lane can go on.
    pub fn take<O>(
        &mut self,
        i: usize,
        run: &Run<'_, T::System, O>,
        forced: Option<&Forced>,
    ) -> bool {
        if !run.is_for_lanes() {
            return false;
        }
        let Run { system, progress, tally: Tally { state, .. }, .. } = *run;
        let from = Loaded { system, clock: progress.clock, state, forced };
        let Some(state) = self.tier.load(i, &from) else { return false };
        let lane = Lane::of::<T, O>(run, self.tier.longest(i));
        if let Some(lane) = &lane {
            self.states.set(i, &state);
            self.lanes.set(i, lane);
        }
        lane.is_some()
    }

    /// Writes the variables of a lane back into its run.
    pub fn put_back<O>(&mut self, i: usize, run: &mut Run<'_, T::System, O>) {
        let lane = self.lanes.get(i);
        lane.put_back(run);
        run.tally.state = self.tier.unload(&self.states.get(i), run.system, run.progress.clock);
    }
}
