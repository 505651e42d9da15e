//! Free masses in lanes, in both accuracy tiers.
//!
//! The exact tier carries states in double-double, so that the error of a run is below one rounding of its
//! numbers. In the fast tier states are plain doubles and only the clock is compensated: every stretch of flight
//! adds rounding errors, and the error of a run is some rounding units times its condition number. The guarantee
//! on events is the same: every stretch is proved to meet no wall, or one wall once, for the motion as computed.
//! What is not simple (a low rebound, the sum of a chatter, a stick episode, a grazing) is left to the event loop,
//! from the same state.
//!
//! One round of a lane tries a stretch of flight and finds the contact in it ([`crate::siva::trial`]), so that
//! nearly every round completes a stretch; then it decides what follows ([`round::commit`]). Where nothing drives
//! the structure, an absorber far from its walls coasts ([`crate::siva::coasts`]). A [`Tier`] has the numbers of
//! a state, and what its motion depends on. Lanes only move, and log what measures need: free decays
//! ([`super::decays`]) the begins of their motions, driven runs ([`super::forced`]) their flights.

mod exact;
mod fast;
mod lane;
mod round;

use super::decays::{self, Decaying};
use super::forced::{self, Driven};
use super::{ScalarRun, SideBySide, pick};
use crate::arrays::{Laned, Lanes, any};
use crate::host::{DrivenHost, Host, Phase, UndrivenHost};
use crate::log::Entry;
use crate::plain::State;
use crate::siva::coasts::Coasts;
use crate::siva::trial::{FreeMass, Sight, search};
use crate::siva::{Siva, SivaState};
use crate::system::Clock;

pub(super) use exact::{ExactDecays, ExactDriven};
pub(super) use fast::{FastDecays, FastDriven};
use lane::Lane;
use round::{Round, Rounds, commit, decide};

/// Free masses of one tier and one kind of drive: what the motions of all lanes depend on.
pub(super) trait Tier: Sized {
    /// The structure that they are on.
    type Host: Host<Real = f64>;
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

    /// Idle lanes for absorbers on a structure like this one.
    fn new(host: &Self::Host) -> Self;
    /// Uses the motion of a lane from a state.
    fn with<T>(
        &self,
        i: usize,
        from: &Self::State,
        act: impl FnOnce(&Self::Mass<'_>, &Self::State) -> T,
    ) -> T;
    /// The longest stretch of a lane.
    fn longest(&self, i: usize) -> f64;
    /// The longest first stretch after a rebound from a pressing wall; `over` is 1/clearance.
    fn rebound(rate: f64, pressure: f64, over: f64) -> f64;
    /// The state at an instant, its force evaluated anew where the tier needs that.
    #[inline(always)]
    fn refreshed(&self, _i: usize, state: &Self::State, _clock: Clock) -> Self::State {
        *state
    }
    /// The motion in which no wall is met, on a structure without drive.
    #[inline(always)]
    fn coasts(&self) -> Option<&Coasts> {
        None
    }
    /// The responses of the structure after a number of steps of coasting.
    #[inline(always)]
    fn responses(&self, _steps: usize) -> Self::Responses {
        Self::Responses::default()
    }
    /// The state after these steps.
    #[inline(always)]
    fn coasted(&self, state: &Self::State, _steps: f64, _by: Self::Responses) -> Self::State {
        *state
    }
    /// Loads the motion of a run into a lane; its state.
    fn load(&mut self, i: usize, run: &TierRun<'_, Self>) -> Option<Self::State>
    where
        Siva<Self::Host>: SideBySide<State = SivaState<Phase<Self::Host>>>;
    /// The state in plain doubles.
    fn in_doubles(state: &Self::State) -> State;
    /// The state in the form of the event loop.
    fn unload(
        &self,
        state: &Self::State,
        host: &Self::Host,
        clock: Clock,
    ) -> SivaState<Phase<Self::Host>>;
    /// Makes a lane idle; its state.
    fn idle(&mut self, i: usize) -> Self::State;
}

/// The run of a lane in the event loop.
type TierRun<'a, T> = ScalarRun<'a, Siva<<T as Tier>::Host>>;

/// Lanes of free masses.
#[derive(Debug)]
pub(super) struct FreeMasses<T: Tier, const W: usize> {
    lanes: lane::Lanes<W>,
    rounds: Rounds<W>,
    tier: T,
    /// The states at the begin of each trial.
    states: <T::State as Laned>::Lanes<W>,
    /// The states at the end of each trial, after an impact.
    ends: <T::State as Laned>::Lanes<W>,
    /// The numbers of steps that the lanes coast, and the responses after them.
    steps: [f64; W],
    responses: <T::Responses as Laned>::Lanes<W>,
}

impl<T: Tier, const W: usize> FreeMasses<T, W> {
    fn new(host: &T::Host) -> Self {
        Self {
            lanes: Lanes::new(),
            rounds: Lanes::new(),
            tier: T::new(host),
            states: Lanes::new(),
            ends: Lanes::new(),
            steps: [0.0; W],
            responses: Lanes::new(),
        }
    }

    /// One trial of each lane.
    #[inline(always)]
    fn attempt(&mut self) {
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
    fn advance(&mut self) -> bool {
        let Self { lanes, rounds, tier, states, ends, steps, responses } = self;
        for i in 0..W {
            let (lane, round) = (lanes.get(i), rounds.get(i));
            let clock = lane.clock.plus_parts(round.sight.h, round.later);
            let after = tier.refreshed(i, &ends.get(i), clock);
            let next = Laned::pick(round.passed, &after, &states.get(i));
            states.set(i, &next);
            let first = T::rebound(round.rebound, round.pressure, lane.over_clearance);
            let lane = commit(&lane, &round, clock, [tier.longest(i), first]);
            lanes.set(i, &lane);
        }
        let requests = any(&lanes.request) | any(&lanes.stopped) | any(&lanes.full);
        let Some(coasts) = tier.coasts() else { return requests };
        for i in 0..W {
            let (lane, round) = (lanes.get(i), rounds.get(i));
            let within = [lane.over_clearance, lane.remaining()];
            let count = coasts.count(&T::in_doubles(&states.get(i)), within);
            steps.set(i, &pick(round.passed & !round.hit, count, 0.0));
        }
        if any(steps) {
            for i in 0..W {
                let count: f64 = steps.get(i);
                responses.set(i, &tier.responses(count as usize));
            }
            for i in 0..W {
                let (lane, state, count) = (lanes.get(i), states.get(i), steps.get(i));
                let coasted = tier.coasted(&state, count, responses.get(i));
                states.set(i, &Laned::pick(count > 0.0, &coasted, &state));
                let later = lane.later(coasts.time(count), tier.longest(i));
                lanes.clock.set(i, &Laned::pick(count > 0.0, &later.clock, &lane.clock));
                let length = pick(count > 0.0, later.trial.length, lane.trial.length);
                lanes.trial.length.set(i, &length);
            }
        }
        requests
    }

    /// The state at the end of the stretch that a lane has just completed, before an impact.
    #[inline(always)]
    fn end(&self, i: usize) -> State {
        let Round { v, rate, .. } = self.rounds.get(i);
        State { v, rate, ..T::in_doubles(&self.ends.get(i)) }
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.request[i] + self.lanes.stopped[i] + self.lanes.full[i] > 0.0
    }

    fn idle(&mut self, i: usize) {
        let state = self.tier.idle(i);
        self.states.set(i, &state);
        self.lanes.set(i, &Lane::idle());
    }
}

impl<T: Tier, const W: usize> FreeMasses<T, W>
where
    Siva<T::Host>: SideBySide<State = SivaState<Phase<T::Host>>>,
{
    fn take(&mut self, i: usize, run: &TierRun<'_, T>) -> bool {
        let Some(state) = self.tier.load(i, run) else { return false };
        let lane = Lane::of(run, self.tier.longest(i));
        if let Some(lane) = &lane {
            self.states.set(i, &state);
            self.lanes.set(i, lane);
        }
        lane.is_some()
    }

    fn put_back(&self, i: usize, run: &mut TierRun<'_, T>) {
        let lane = self.lanes.get(i);
        lane.put_back(run);
        run.tally.state = self.tier.unload(&self.states.get(i), &run.system.host, run.clock);
    }
}

impl<T: Tier<Host = UndrivenHost>, const W: usize> decays::Flights for FreeMasses<T, W> {
    const WIDTH: usize = W;

    fn new(siva: &Siva) -> Self {
        Self::new(&siva.host)
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        self.attempt();
        self.advance()
    }

    #[inline(always)]
    fn times(&self) -> &[f64] {
        &self.lanes.clock.value
    }

    #[inline(always)]
    fn hits(&self) -> bool {
        any(&self.rounds.hit)
    }

    #[inline(always)]
    fn motion(&self, i: usize) -> Option<Entry> {
        (self.rounds.get(i).hit).then(|| {
            let State { x, v, side, rate, .. } = T::in_doubles(&self.states.get(i));
            let v_before = self.rounds.v[i];
            Entry::new(self.lanes.clock.get(i), [x, v], v_before, v - side * rate, false)
        })
    }

    fn requests(&self, i: usize) -> bool {
        self.requests(i)
    }

    fn take(&mut self, i: usize, run: &Decaying<'_>) -> bool {
        self.take(i, run)
    }

    fn put_back(&self, i: usize, run: &mut Decaying<'_>) -> f64 {
        self.put_back(i, run);
        run.tally.state.in_doubles().v
    }

    fn idle(&mut self, i: usize) {
        self.idle(i);
    }
}

impl<T: Tier<Host = DrivenHost>, const W: usize> forced::Flights for FreeMasses<T, W> {
    const WIDTH: usize = W;

    fn new(siva: &Siva<DrivenHost>) -> Self {
        Self::new(&siva.host)
    }

    #[inline(always)]
    fn evaluate(
        &mut self,
        wanted: bool,
        mut take: impl FnMut(usize, Clock, f64, [f64; 2], [&State; 2]),
    ) -> bool {
        self.attempt();
        if wanted {
            for i in 0..W {
                let Round { passed, sight: Sight { h, .. }, later, hit, rate, .. } =
                    self.rounds.get(i);
                if passed {
                    let clock = self.lanes.clock.get(i);
                    let approach = if hit { -rate } else { 0.0 };
                    let impact = [clock.plus_parts(h, later).value, approach];
                    let begin = T::in_doubles(&self.states.get(i));
                    take(i, clock, h + later, impact, [&begin, &self.end(i)]);
                }
            }
        }
        self.advance()
    }

    fn requests(&self, i: usize) -> bool {
        self.requests(i)
    }

    fn take(&mut self, i: usize, run: &Driven<'_>) -> bool {
        self.take(i, run)
    }

    fn put_back(&self, i: usize, run: &mut Driven<'_>) {
        self.put_back(i, run);
    }

    fn idle(&mut self, i: usize) {
        self.idle(i);
    }
}
