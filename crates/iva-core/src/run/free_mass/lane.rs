//! One lane: the variables of a run that change in its flights, beside its state, and arrays of such lanes.

use super::Tier;
use crate::absorber::siva::Law;
use crate::absorber::siva::trial::Trial;
use crate::absorber::{Absorber as _, Clock};
use crate::engine::progress::Progress;
use crate::engine::simulate::Run;
use crate::number::arrays::{Laned as _, arrays};
use crate::run::side_by_side::SideBySide;

arrays! {
    /// The variables of one run.
    Lane, Lanes:
    /// The number of trials of the stretch that were not decided.
    tries,
    /// The absorber: d and 1/d.
    clearance, over_clearance;
    /// Clock, counts and limits. Impacts at or below the chatter floor are left to the event loop.
    progress: Progress,
    /// The next trial.
    trial: Trial,
    /// The impact laws at wall + and at wall −.
    laws: [Law; 2],
    /// The reasons why the event loop is needed: a stretch that is not simple; the end of the run; a limit reached.
    request: bool, stopped: bool, full: bool,
}

/// A run that leaves a wall with a smaller rate than this, over |x| + |ẋ|, is left to the event loop: whether the
/// absorber leaves the wall or presses on it is decided with more digits than the fast tier has.
const SLOW: f64 = 1e-6;

impl Lane {
    /// A lane without a run.
    pub fn idle() -> Self {
        let (progress, trial) = (Progress::idle(), Trial::new(1.0));
        Self { progress, trial, clearance: 1.0, over_clearance: 1.0, ..Self::default() }
    }

    /// The impact law at the wall with this sign.
    #[inline(always)]
    pub fn law(&self, side: f64) -> Law {
        let [plus, minus] = &self.laws;
        Law::pick(side > 0.0, plus, minus)
    }

    /// The lane after coasting for a time, with the next trial from there.
    #[inline(always)]
    pub fn later(&self, time: Clock, longest: f64) -> Self {
        let mut later = Self { progress: self.progress.later(time), ..*self };
        later.trial.length = longest.min(later.progress.ahead());
        later
    }

    /// The lane of a run in flight, in trials up to `longest`; `None` if the event loop has to go on with the
    /// run.
    pub fn of<T: Tier, O>(run: &Run<'_, T::System, O>, longest: f64) -> Option<Self> {
        let (system, progress) = (run.system, run.progress);
        let state = T::in_doubles(&run.tally.state);
        if state.distance == 0.0 && state.rate <= SLOW * (state.x.abs() + state.v.abs()) {
            return None;
        }
        let mut lane = Self {
            progress,
            laws: T::laws(system),
            clearance: system.clearance(),
            over_clearance: 1.0 / system.clearance(),
            ..Self::default()
        };
        lane.trial.length = longest.min(progress.ahead());
        Some(lane)
    }

    /// The lane of the same run at its begin, with the clock at this instant.
    pub fn repeated(&self, begin: Clock, longest: f64) -> Self {
        let progress = self.progress.repeated(begin);
        let trial = Trial::new(longest.min(progress.ahead()));
        Self { progress, trial, tries: 0.0, stopped: false, ..*self }
    }

    /// Writes the variables back into the run.
    pub fn put_back<S: SideBySide, O>(&self, run: &mut Run<'_, S, O>) {
        run.progress = self.progress;
        if self.stopped {
            run.reach_end();
        }
    }
}
