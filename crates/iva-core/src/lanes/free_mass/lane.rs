//! One lane: the variables of a run that change in its flights, beside its state, and arrays of such lanes.

use super::Tier;
use crate::absorber::siva::Law;
use crate::absorber::siva::trial::Trial;
use crate::absorber::system::{Clock, System as _};
use crate::engine::simulate::counts::Counts;
use crate::engine::simulate::{Phase as Doing, Run};
use crate::lanes::SideBySide;
use crate::number::arrays::{Laned as _, arrays};

arrays! {
    /// The variables of one run.
    Lane, Lanes:
    /// The instant at which the run ends, in 1/ωn.
    stop,
    /// The longest first trial after a rebound, and the number of trials of the stretch that were not decided.
    first, tries,
    /// Limits on the numbers of impacts and of stretches of motion.
    max_impacts, max_work,
    /// The absorber: d and 1/d.
    clearance, over_clearance,
    /// Chatter floor: impacts with an approach speed at or below it are left to the event loop.
    floor;
    /// The clock, in 1/ωn.
    clock: Clock,
    /// The next trial.
    trial: Trial,
    /// The impact laws at wall + and at wall −.
    laws: [Law; 2],
    /// The reasons why the event loop is needed: a stretch that is not simple; the end of the run; a limit reached.
    request: bool, stopped: bool, full: bool,
    /// Counts and sums.
    counts: Counts,
}

/// A run that leaves a wall with a smaller rate than this, over |x| + |ẋ|, is left to the event loop: whether the
/// absorber leaves the wall or presses on it is decided with more digits than the fast tier has.
const SLOW: f64 = 1e-6;

impl Lane {
    /// A lane without a run.
    pub fn idle() -> Self {
        let never = f64::INFINITY;
        let trial = Trial::new(1.0);
        let at_rest = Self { clearance: 1.0, over_clearance: 1.0, ..Self::default() };
        Self { stop: never, first: never, max_impacts: never, max_work: never, trial, ..at_rest }
    }

    /// The time to the end of the run.
    #[inline(always)]
    pub fn remaining(&self) -> f64 {
        -self.clock.minus(self.stop)
    }

    /// The impact law at the wall with this sign.
    #[inline(always)]
    pub fn law(&self, side: f64) -> Law {
        let [plus, minus] = &self.laws;
        Law::pick(side > 0.0, plus, minus)
    }

    /// True if the run has reached a limit.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        (self.counts.impacts >= self.max_impacts) | (self.counts.work >= self.max_work)
    }

    /// The lane after coasting for a time, with the next trial from there.
    #[inline(always)]
    pub fn later(&self, time: Clock, longest: f64) -> Self {
        let mut later = Self { clock: self.clock.plus_parts(time.value, time.rest), ..*self };
        later.trial.length = longest.min(later.remaining()).min(self.first);
        later
    }

    /// The lane of a run in flight, in trials up to `longest`; `None` if the event loop has to go on with the
    /// run.
    pub fn of<T: Tier, O>(run: &Run<'_, T::System, O>, longest: f64) -> Option<Self> {
        let Doing::Flight { first } = run.phase else { return None };
        let (system, limits) = (run.system, run.limits);
        let state = T::in_doubles(&run.tally.state);
        if state.distance == 0.0 && state.rate <= SLOW * (state.x.abs() + state.v.abs()) {
            return None;
        }
        let mut lane = Self {
            clock: run.clock,
            stop: limits.duration,
            laws: T::laws(system),
            clearance: system.clearance(),
            over_clearance: 1.0 / system.clearance(),
            floor: limits.chatter_floor,
            max_impacts: limits.max_impacts as f64,
            max_work: limits.max_work as f64,
            counts: run.counts,
            first,
            ..Self::default()
        };
        let remaining = lane.remaining();
        lane.trial.length = longest.min(remaining).min(first);
        // Low impacts of a streak wait for the decision whether they are listed.
        let goes_on = !run.ended && remaining > 0.0 && lane.counts.streak.low == 0.0;
        (goes_on && !lane.is_full()).then_some(lane)
    }

    /// The lane of the same run at its begin, with the clock at this instant.
    pub fn repeated(&self, begin: Clock, longest: f64) -> Self {
        let (first, counts) = (f64::INFINITY, Counts::default());
        let mut lane = Self { clock: begin, first, tries: 0.0, counts, stopped: false, ..*self };
        lane.trial = Trial::new(longest.min(lane.remaining()));
        lane
    }

    /// Writes the variables back into the run.
    pub fn put_back<S: SideBySide, O>(&self, run: &mut Run<'_, S, O>) {
        run.clock = self.clock;
        run.counts = self.counts;
        run.phase = Doing::Flight { first: self.first };
        if self.stopped {
            run.reach_end();
        }
    }
}
