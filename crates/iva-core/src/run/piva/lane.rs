//! One lane: the variables of a run that change in its steps.

use super::drive::{Swinging, laid, raised};
use super::scene::Scene;
use crate::absorber::piva::{PARTS, Piva, PivaState};
use crate::engine::counts::Counted;
use crate::engine::progress::Progress;
use crate::engine::simulate::Run;
use crate::host::DrivenHost;
use crate::measures::Ledger;
use crate::measures::steady::{Quiet, Steady};
use crate::number::arrays::{Laned, laned};
use crate::number::real::pick;
use crate::run::side_by_side::ScalarRun;

use super::round::Round;

/// The shortest part of a step that is tried.
const SHORTEST: f64 = 1.0 / (1 << (PARTS - 1)) as f64;

/// A run at the begin of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lane<P> {
    pub progress: Progress,
    pub state: PivaState<P>,
    /// The part of the step that is tried: 1, or less where nothing is decided about longer ones.
    pub part: f64,
    pub ledger: Ledger,
    /// The steps that its observers need not see.
    pub quiet: Quiet,
    /// True for a lane with a run.
    pub live: bool,
    /// The reasons why the event loop is needed: a step that is not simple; the end of the run; a limit reached.
    pub request: bool,
    pub stopped: bool,
    pub full: bool,
}

laned!(
    Lane<P>,
    Lanes {
        progress: Progress,
        state: PivaState<P>,
        part: f64,
        ledger: Ledger,
        quiet: Quiet,
        live: bool,
        request: bool,
        stopped: bool,
        full: bool,
    }
);

impl<P: Laned> Lane<P> {
    /// The lane of a run in flight; `None` if the event loop has to go on with the run.
    pub fn of<H: Swinging<Instant = P>, O>(run: &Run<'_, Piva<DrivenHost>, O>) -> Option<Self> {
        let state = || laid::<H>(&run.tally.state);
        run.is_for_lanes().then(|| Self::at(run.progress, &state()))
    }

    /// The lane of a run in flight, at the begin of a step.
    pub fn at(progress: Progress, state: &PivaState<P>) -> Self {
        Self { progress, live: true, ..Self::idle(state) }
    }

    /// A lane without a run, at rest in the middle of its gap.
    pub fn idle(state: &PivaState<P>) -> Self {
        Self {
            progress: Progress::idle(),
            state: *state,
            part: 1.0,
            ledger: Ledger::default(),
            quiet: Quiet::ALL,
            live: false,
            request: false,
            stopped: false,
            full: false,
        }
    }

    /// The lane after a round: impact, clock and the next step. Losses of a step that observers see are taken by
    /// them.
    #[inline(always)]
    pub fn after(&self, round: &Round<P>) -> Self {
        let Round { passed, hit, again, quiet, impact, losses, square, .. } = round;
        let (passed, hit, quiet) = (*passed, *hit, passed & quiet);
        let moved = self.progress.moved(passed, round.clock, round.first);
        let next = Self {
            progress: moved.struck(hit, &Counted::from(impact)),
            state: Laned::pick(passed, &round.after, &self.state),
            part: pick(*again, self.part * 0.5, 1.0),
            ledger: Laned::pick(quiet, &self.ledger.plus(losses), &self.ledger),
            quiet: self.quiet.with(quiet, self.progress.clock, *square),
            request: self.live & !passed & !again,
            stopped: passed & round.whole,
            ..*self
        };
        Self { full: passed & next.progress.is_full(), ..next }
    }

    /// True if a shorter part of the step can be tried.
    #[inline(always)]
    pub fn can_part(&self) -> bool {
        self.part > SHORTEST
    }

    /// Writes the variables back into the run.
    pub fn put_back<H: Swinging<Instant = P>, O>(
        &self,
        scene: &Scene,
        run: &mut Run<'_, Piva<DrivenHost>, O>,
    ) {
        run.progress = self.progress;
        run.tally.state = raised::<H>(scene, &self.state);
        if self.stopped {
            run.reach_end();
        }
    }

    /// Reads the sums of the measures of a run, and the steps that they need not see.
    pub fn see(&mut self, run: &ScalarRun<'_, Piva<DrivenHost>>) {
        self.ledger = run.observer.measures.ledger;
        self.quiet = run.observer.steady.as_ref().map_or(Quiet::ALL, Steady::quiet);
    }

    /// Writes the sums of its measures back into the run.
    pub fn put_back_sums(&self, run: &mut ScalarRun<'_, Piva<DrivenHost>>) {
        run.observer.measures.ledger = self.ledger;
        if let Some(steady) = &mut run.observer.steady {
            steady.take_square(&self.quiet);
        }
    }
}
