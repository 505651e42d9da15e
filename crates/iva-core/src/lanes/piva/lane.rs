//! One lane: the variables of a run that change in its steps.

use super::drive::{Swinging, laid, raised};
use super::scene::Scene;
use crate::absorber::impact::Impact;
use crate::absorber::piva::{PARTS, Piva, PivaState};
use crate::absorber::system::Clock;
use crate::engine::simulate::counts::{Counted, Counts};
use crate::engine::simulate::{Phase, Run};
use crate::lanes::{ScalarRun, pick};
use crate::measures::Ledger;
use crate::measures::steady::{Quiet, Steady};
use crate::number::arrays::{Laned, laned};
use crate::number::real::Real;

use super::round::Round;

/// The shortest part of a step that is tried.
const SHORTEST: f64 = 1.0 / (1 << (PARTS - 1)) as f64;

/// A run at the begin of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lane<P> {
    pub clock: Clock,
    pub state: PivaState<P>,
    /// The longest step after a rebound.
    pub first: f64,
    /// The part of the step that is tried: 1, or less where nothing is decided about longer ones.
    pub part: f64,
    pub counts: Counts,
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
        clock: Clock,
        state: PivaState<P>,
        first: f64,
        part: f64,
        counts: Counts,
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
    pub fn of<H: Swinging<Instant = P>, O>(
        run: &Run<'_, Piva<H>, O>,
        scene: &Scene,
    ) -> Option<Self> {
        let Phase::Flight { first } = run.phase else { return None };
        let counts = run.counts;
        let idle = Self::idle(&laid::<H>(&run.tally.state));
        let lane = Self { clock: run.clock, first, counts, live: true, ..idle };
        // Low impacts of a streak wait for the decision whether they are listed.
        let goes_on = !run.ended && lane.remaining(scene) > 0.0 && counts.streak.low == 0.0;
        (goes_on && !lane.is_full(scene)).then_some(lane)
    }

    /// A lane without a run, at rest in the middle of its gap.
    pub fn idle(state: &PivaState<P>) -> Self {
        Self {
            clock: Clock::ZERO,
            state: *state,
            first: f64::INFINITY,
            part: 1.0,
            counts: Counts::default(),
            ledger: Ledger::default(),
            quiet: Quiet::ALL,
            live: false,
            request: false,
            stopped: false,
            full: false,
        }
    }

    /// The time to the end of the run.
    #[inline(always)]
    pub fn remaining(&self, scene: &Scene) -> f64 {
        -self.clock.minus(scene.stop)
    }

    /// True if the run has reached a limit.
    #[inline(always)]
    fn is_full(&self, scene: &Scene) -> bool {
        (self.counts.listed() >= scene.max_impacts) | (self.counts.work >= scene.max_work)
    }

    /// The lane after a round: impact, clock and the next step. Losses of a step that observers see are taken by
    /// them.
    #[inline(always)]
    pub fn after(&self, scene: &Scene, round: &Round<P>) -> Self {
        let Round { passed, hit, again, quiet, impact, losses, square, .. } = round;
        let (passed, hit, quiet) = (*passed, *hit, passed & quiet);
        let Impact { time, wall, energy_loss, .. } = *impact;
        let counted = Counted {
            time,
            side: wall.sign(),
            approach: impact.approach_speed(),
            energy_loss,
            effective: impact.effective(),
            low: false,
        };
        let work = self.counts.work + pick(passed, 1.0, 0.0);
        let next = Self {
            clock: Laned::pick(passed, &round.clock, &self.clock),
            state: Laned::pick(passed, &round.after, &self.state),
            first: pick(passed, round.first, self.first),
            part: pick(*again, self.part * 0.5, 1.0),
            counts: Counts { work, ..self.counts.after(hit, &counted) },
            ledger: Laned::pick(quiet, &self.ledger.plus(losses), &self.ledger),
            quiet: self.quiet.with(quiet, self.clock, *square),
            request: self.live & !passed & !again,
            stopped: passed & round.whole,
            ..*self
        };
        Self { full: passed & next.is_full(scene), ..next }
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
        run: &mut Run<'_, Piva<H>, O>,
    ) {
        (run.clock, run.counts) = (self.clock, self.counts);
        run.tally.state = f64::dispatched(
            #[inline(always)]
            || raised::<H>(scene, &self.state),
        );
        run.phase = Phase::Flight { first: self.first };
        if self.stopped {
            run.reach_end();
        }
    }

    /// Reads the sums of the measures of a run, and the steps that they need not see.
    pub fn see<H: Swinging>(&mut self, run: &ScalarRun<'_, Piva<H>>) {
        self.ledger = run.observer.measures.ledger;
        self.quiet = run.observer.steady.as_ref().map_or(Quiet::ALL, Steady::quiet);
    }

    /// Writes the sums of its measures back into the run.
    pub fn put_back_sums<H: Swinging>(&self, run: &mut ScalarRun<'_, Piva<H>>) {
        run.observer.measures.ledger = self.ledger;
        if let Some(steady) = &mut run.observer.steady {
            steady.take_square(&self.quiet);
        }
    }
}
