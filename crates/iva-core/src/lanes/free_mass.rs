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
use crate::arrays::any;
use crate::host::{DrivenHost, Host, Phase, UndrivenHost};
use crate::log::Entry;
use crate::plain::State;
use crate::siva::coasts::{Coast, Coasts, ManyCoasts};
use crate::siva::trial::{FreeMass, land, search};
use crate::siva::{Siva, SivaState};
use crate::system::Clock;

pub(super) use exact::{ExactDecays, ExactDriven};
pub(super) use fast::{FastDecays, FastDriven};
use lane::{Lane, Lanes};
use round::{Round, Rounds, commit, decide};

/// The states of all lanes.
pub(super) trait States<State> {
    fn new() -> Self;
    fn get(&self, i: usize) -> State;
    /// Stores the state of a lane, if `which`.
    fn put(&mut self, i: usize, which: bool, state: &State);
}

/// Free masses of one tier and one kind of drive: what the motions of all lanes depend on.
pub(super) trait Tier: Sized {
    /// The structure that they are on.
    type Host: Host<Real = f64>;
    /// The state of a lane.
    type State: Copy;
    /// The states of all lanes.
    type States: States<Self::State>;
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
    fn with<T>(&self, i: usize, from: &Self::State, act: impl FnOnce(&Self::Mass<'_>) -> T) -> T;
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
    /// The state after a coast.
    #[inline(always)]
    fn coasted(_coasts: &Coasts, state: &Self::State, _by: &Coast) -> Self::State {
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
    lanes: Lanes<W>,
    rounds: Rounds<W>,
    tier: T,
    /// The states at the begin of each trial.
    states: T::States,
    /// The states at the end of each trial, after an impact.
    ends: T::States,
    /// What the lanes coast by.
    coasting: ManyCoasts<W>,
}

impl<T: Tier, const W: usize> FreeMasses<T, W> {
    fn new(host: &T::Host) -> Self {
        Self {
            lanes: Lanes::new(),
            rounds: Rounds::new(),
            tier: T::new(host),
            states: T::States::new(),
            ends: T::States::new(),
            coasting: ManyCoasts::new(),
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
                |mass| {
                    let sight = search(mass, &from, &lane.trial(), lane.over_clearance);
                    let mut round = Round::of(&sight);
                    if !T::STAGED {
                        let size = [lane.clearance, lane.over_clearance];
                        let landing = land(mass, &from, &sight, lane.length, size);
                        let after;
                        (round, after) = decide(mass, &lane, &sight, &landing);
                        ends.put(i, true, &after);
                    }
                    rounds.set(i, &round);
                },
            );
        }
        if T::STAGED {
            for i in 0..W {
                let (lane, from, sight) = (lanes.get(i), states.get(i), rounds.get(i).sight());
                tier.with(
                    i,
                    &from,
                    #[inline(always)]
                    |mass| {
                        let size = [lane.clearance, lane.over_clearance];
                        let landing = land(mass, &from, &sight, lane.length, size);
                        let (round, after) = decide(mass, &lane, &sight, &landing);
                        ends.put(i, true, &after);
                        rounds.set(i, &round);
                    },
                );
            }
        }
    }

    /// Applies what the trials have found; true if a lane needs its run.
    #[inline(always)]
    fn advance(&mut self) -> bool {
        let Self { lanes, rounds, tier, states, ends, coasting } = self;
        for i in 0..W {
            let (lane, round) = (lanes.get(i), rounds.get(i));
            let clock = lane.clock().plus_parts(round.h, round.later);
            let after = tier.refreshed(i, &ends.get(i), clock);
            states.put(i, round.passed > 0.0, &after);
            let first = T::rebound(round.rebound, round.pressure, lane.over_clearance);
            lanes.set(i, &commit(&lane, &round, clock, [tier.longest(i), first]));
        }
        if let Some(coasts) = tier.coasts() {
            for i in 0..W {
                let (lane, round) = (lanes.get(i), rounds.get(i));
                let state = T::in_doubles(&states.get(i));
                let steps = coasts.count(&state, lane.clearance, lane.remaining());
                let flies = (round.passed > 0.0) & (round.hit == 0.0);
                coasting.steps[i] = pick(flies, steps, 0.0);
            }
            if any(&coasting.steps) {
                for i in 0..W {
                    coasting.set(i, &coasts.coast(coasting.steps[i]));
                }
                for i in 0..W {
                    let (lane, state, by) = (lanes.get(i), states.get(i), coasting.get(i));
                    let coasts_now = by.steps > 0.0;
                    states.put(i, coasts_now, &T::coasted(coasts, &state, &by));
                    let later = lane.later(coasts.time(by.steps), tier.longest(i));
                    lanes.set(i, &later.if_else(coasts_now, &lane));
                }
            }
        }
        any(&lanes.request) | any(&lanes.stopped) | any(&lanes.full)
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
        self.states.put(i, true, &state);
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
            self.states.put(i, true, &state);
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
        &self.lanes.time
    }

    #[inline(always)]
    fn hits(&self) -> bool {
        any(&self.rounds.hit)
    }

    #[inline(always)]
    fn motion(&self, i: usize) -> Option<Entry> {
        (self.rounds.hit[i] > 0.0).then(|| {
            let State { x, v, side, rate, .. } = T::in_doubles(&self.states.get(i));
            let v_before = self.rounds.v[i];
            Entry::new(self.lanes.get(i).clock(), [x, v], v_before, v - side * rate, false)
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
                let Round { passed, h, later, hit, rate, .. } = self.rounds.get(i);
                if passed > 0.0 {
                    let clock = self.lanes.get(i).clock();
                    let approach = if hit > 0.0 { -rate } else { 0.0 };
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
