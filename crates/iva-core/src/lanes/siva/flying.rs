//! The flight of one run: the variables that fast flights change.

use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::host::{Host, HostState, Phase};
use crate::lanes::counts::{Counts, ManyCounts};
use crate::oscillator::Primary;
use crate::simulate::{Phase as Doing, Run};
use crate::siva::{Siva, SivaState};
use crate::system::System;

/// Aim of an evaluation: the end of a whole trial stretch, which is searched for a contact.
pub(in crate::lanes) const SEARCH: f64 = 0.0;
/// Aim of an evaluation: an estimate of the contact with the near wall.
pub(in crate::lanes) const NEAR: f64 = 1.0;
/// Aim of an evaluation: an estimate of the contact with the far wall.
pub(in crate::lanes) const FAR: f64 = 2.0;

/// Reason why a lane has stopped: the end of the run.
pub(in crate::lanes) const STOP: f64 = 1.0;
/// Reason why a lane has stopped: a limit of the run.
pub(in crate::lanes) const FULL: f64 = 2.0;

arrays! {
    /// The flight of one run.
    Flying,
    /// [`Flying`] of many runs: every field an array over the lanes.
    Flyings:
    /// The state at the begin of the stretch, in double-double.
    x, x_rest, v, v_rest, a, a_rest, distance, distance_rest, rate, rate_rest, side,
    /// The clock in double-double, and the instant at which the run ends, in 1/ωn.
    time, time_rest, stop,
    /// The aim of the next evaluation and its time h, the length of the trial stretch, the number of
    /// evaluations made close to the wall, and the longest first trial after a rebound.
    aim, h, length, looks, first,
    /// The absorber: share of the impact in double-double, e, d.
    share, share_rest, restitution, clearance,
    /// Chatter floor: impacts with an approach speed at or below it are left to the event loop.
    floor,
    /// 1 if the stretch is no fast flight, so that the event loop is needed; reason why the lane has stopped,
    /// 0: none.
    request, stopped;
    /// Counts and sums.
    counts: Counts, ManyCounts
}

impl Flying {
    #[inline(always)]
    pub fn state<P>(&self, phase: P) -> SivaState<P> {
        let sum = |value, rest| DoubleDouble { value, rest };
        SivaState {
            host: HostState {
                primary: Primary { x: sum(self.x, self.x_rest), v: sum(self.v, self.v_rest) },
                acceleration: sum(self.a, self.a_rest),
                phase,
            },
            side: self.side,
            distance: sum(self.distance, self.distance_rest),
            rate: sum(self.rate, self.rate_rest),
        }
    }

    #[inline(always)]
    pub fn put_state<P>(&mut self, state: &SivaState<P>) {
        let HostState { primary: Primary { x, v }, acceleration, .. } = &state.host;
        (self.x, self.x_rest) = (x.value, x.rest);
        (self.v, self.v_rest) = (v.value, v.rest);
        (self.a, self.a_rest) = (acceleration.value, acceleration.rest);
        (self.distance, self.distance_rest) = (state.distance.value, state.distance.rest);
        (self.rate, self.rate_rest) = (state.rate.value, state.rate.rest);
        self.side = state.side;
    }

    #[inline(always)]
    pub fn clock(&self) -> DoubleDouble {
        DoubleDouble { value: self.time, rest: self.time_rest }
    }

    /// A lane without a run: its state stays at rest.
    pub fn idle() -> Self {
        let never = f64::INFINITY;
        let at_rest = Self { clearance: 1.0, distance: 1.0, side: 1.0, ..Self::default() };
        Self { stop: never, first: never, counts: Counts::idle(), ..at_rest }
    }

    /// The flight of a run, in trials up to this length; `None` if the event loop has to go on with the run.
    pub fn of<H: Host<Real = f64>, O>(run: &Run<'_, Siva<H>, O>, reach: f64) -> Option<Self>
    where
        Siva<H>: System<Real = f64, State = SivaState<Phase<H>>>,
    {
        let Doing::Flight { first } = run.phase else { return None };
        let (siva, tally) = (run.system, &run.tally);
        let law = siva.common_law()?;
        let stop = run.limits.duration;
        let mut flying = Self {
            time: run.clock.value,
            time_rest: run.clock.rest,
            stop,
            share: law.share.value,
            share_rest: law.share.rest,
            restitution: law.restitution,
            clearance: siva.clearance(),
            floor: run.limits.chatter_floor,
            counts: Counts::of(run, [siva.mass_ratio(), law.restitution])?,
            first,
            ..Self::default()
        };
        flying.put_state(&tally.state);
        let remaining = -run.clock.minus(stop);
        flying.length = reach.min(remaining).min(first);
        flying.h = flying.length;
        (!run.ended && remaining > 0.0).then_some(flying)
    }

    /// Writes the variables back into the run, with the given state of the drive.
    pub fn put_back<H: Host<Real = f64>, O>(&self, run: &mut Run<'_, Siva<H>, O>, phase: Phase<H>)
    where
        Siva<H>: System<Real = f64, State = SivaState<Phase<H>>>,
    {
        run.tally.state = self.state(phase);
        run.clock = self.clock();
        self.counts.put_back(run);
        run.phase = Doing::Flight { first: self.first };
        if self.stopped == STOP {
            run.reach_end();
        }
    }
}
