//! One lane: the variables of a run that change in its flights, beside its state, and arrays of such lanes.

use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::host::Host;
use crate::lanes::counts::{Counts, ManyCounts};
use crate::lanes::{ScalarRun, SideBySide};
use crate::simulate::Phase as Doing;
use crate::siva::trial::Trial;
use crate::siva::{Law, Siva, SivaState};
use crate::system::{Clock, System};

arrays! {
    /// The variables of one run.
    Lane,
    /// [`Lane`] of many runs: every field an array over the lanes.
    Lanes:
    /// The clock in double-double, and the instant at which the run ends, in 1/ωn.
    time, time_rest, stop,
    /// The length of the next trial, and the longest first trial after a rebound.
    length, first,
    /// Time after the begin of the stretch at which the wall is looked for again (0: it is not), 1 if that is
    /// the far wall, and the number of looks and halvings so far.
    again, again_far, tries,
    /// The absorber: share of the impact in double-double ([`crate::impact::primary_share`]), e, d, 1/d.
    share, share_rest, restitution, clearance, over_clearance,
    /// Chatter floor: impacts with an approach speed at or below it are left to the event loop.
    floor,
    /// 1 for each reason why the event loop is needed: a stretch that is not simple; the end of the run; a limit
    /// reached.
    request, stopped, full;
    /// Counts and sums.
    counts: Counts, ManyCounts
}

/// A run that leaves a wall with a smaller rate than this, over |x| + |ẋ|, is left to the event loop: whether the
/// absorber leaves the wall or presses on it is decided with more digits than the fast tier has.
const SLOW: f64 = 1e-6;

impl Lane {
    /// A lane without a run.
    pub fn idle() -> Self {
        let never = f64::INFINITY;
        let at_rest = Self { clearance: 1.0, over_clearance: 1.0, length: 1.0, ..Self::default() };
        Self { stop: never, first: never, counts: Counts::idle(), ..at_rest }
    }

    /// The clock.
    #[inline(always)]
    pub fn clock(&self) -> Clock {
        DoubleDouble { value: self.time, rest: self.time_rest }
    }

    /// The time to the end of the run.
    #[inline(always)]
    pub fn remaining(&self) -> f64 {
        -self.clock().minus(self.stop)
    }

    /// The lane after coasting for a time, high and low part, with the next trial from there.
    #[inline(always)]
    pub fn later(&self, [time, rest]: [f64; 2], longest: f64) -> Self {
        let DoubleDouble { value, rest } = self.clock().plus_parts(time, rest);
        let mut later = Self { time: value, time_rest: rest, ..*self };
        later.length = longest.min(later.remaining()).min(self.first);
        later
    }

    /// The next trial.
    #[inline(always)]
    pub fn trial(&self) -> Trial {
        Trial { length: self.length, again: self.again, far: self.again_far > 0.0 }
    }

    /// The impact law.
    #[inline(always)]
    pub fn law(&self) -> Law {
        let share = DoubleDouble { value: self.share, rest: self.share_rest };
        Law { restitution: self.restitution, share }
    }

    /// The lane of a run in flight, in trials up to `longest`; `None` if the event loop has to go on with the
    /// run.
    pub fn of<H: Host<Real = f64>>(run: &ScalarRun<'_, Siva<H>>, longest: f64) -> Option<Self>
    where
        Siva<H>: SideBySide<State = SivaState<crate::host::Phase<H>>>,
    {
        let Doing::Flight { first } = run.phase else { return None };
        let (siva, limits) = (run.system, run.limits);
        let law = siva.common_law()?;
        let state = run.tally.state.in_doubles();
        if state.distance == 0.0 && state.rate <= SLOW * (state.x.abs() + state.v.abs()) {
            return None;
        }
        let mut lane = Self {
            time: run.clock.value,
            time_rest: run.clock.rest,
            stop: limits.duration,
            share: law.share.value,
            share_rest: law.share.rest,
            restitution: law.restitution,
            clearance: siva.clearance(),
            over_clearance: 1.0 / siva.clearance(),
            floor: limits.chatter_floor,
            counts: Counts::of(run, [siva.mass_ratio(), law.restitution])?,
            first,
            ..Self::default()
        };
        let remaining = lane.remaining();
        lane.length = longest.min(remaining).min(first);
        (!run.ended && remaining > 0.0).then_some(lane)
    }

    /// Writes the variables back into the run.
    pub fn put_back<H: Host<Real = f64>>(&self, run: &mut ScalarRun<'_, Siva<H>>)
    where
        Siva<H>: SideBySide<State = SivaState<crate::host::Phase<H>>>,
    {
        run.clock = self.clock();
        self.counts.put_back(run);
        run.phase = Doing::Flight { first: self.first };
        if self.stopped > 0.0 {
            run.reach_end();
        }
    }
}
