//! One lane: the variables of a run that change in its flights, in plain doubles, and arrays of such lanes.

use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::host::{Host, Phase};
use crate::lanes::counts::{Counts, ManyCounts};
use crate::oscillator::Primary;
use crate::plain::{State, States, Structure, Structures};
use crate::real::Real;
use crate::simulate::{Phase as Doing, Run};
use crate::siva::{Siva, SivaState};
use crate::system::System;

arrays! {
    /// The variables of one run.
    Lane,
    /// [`Lane`] of many runs: every field an array over the lanes.
    Lanes:
    /// The clock in double-double, and the instant at which the run ends, in 1/ωn.
    time, time_rest, stop,
    /// The length of the next trial stretch, and the longest first trial after a rebound.
    length, first,
    /// Time after the begin of the stretch at which the wall is looked for again (0: it is not), 1 if that is
    /// the far wall, and the number of looks and halvings so far.
    again, again_far, tries,
    /// The absorber: mass ratio, share of the impact ([`crate::impact::primary_share`]), e, d, 1/d.
    mass_ratio, share, restitution, clearance, over_clearance,
    /// Chatter floor: impacts with an approach speed at or below it are left to the event loop.
    floor,
    /// 1 for each reason why the event loop is needed: a stretch that is not simple; the end of the run; a limit
    /// reached.
    request, stopped, full;
    /// The state at the begin of the stretch.
    state: State, States,
    /// The constants of the structure.
    structure: Structure, Structures,
    /// Counts and sums.
    counts: Counts, ManyCounts
}

/// A run that leaves a wall with a smaller rate than this, over |x| + |ẋ|, is left to the event loop.
const SLOW: f64 = 1e-6;

impl<const W: usize> Lanes<W> {
    /// The clock of a lane.
    #[inline(always)]
    pub fn clock(&self, i: usize) -> DoubleDouble {
        DoubleDouble { value: self.time[i], rest: self.time_rest[i] }
    }
}

impl Lane {
    /// A lane without a run: its state stays at rest.
    pub fn idle() -> Self {
        let never = f64::INFINITY;
        let state = State { distance: 1.0, side: 1.0, ..State::default() };
        let structure = Structure { longest: 1.0, over_longest: 1.0, ..Structure::default() };
        let at_rest = Self {
            clearance: 1.0,
            over_clearance: 1.0,
            length: 1.0,
            first: never,
            state,
            structure,
            ..Self::default()
        };
        Self { stop: never, counts: Counts::idle(), ..at_rest }
    }

    pub fn clock(&self) -> DoubleDouble {
        DoubleDouble { value: self.time, rest: self.time_rest }
    }

    /// The lane of a run in flight; `None` if the event loop has to go on with the run.
    pub fn of<H: Host<Real = f64>, O>(
        run: &Run<'_, Siva<H>, O>,
        structure: &Structure,
        stop: f64,
    ) -> Option<Self>
    where
        Siva<H>: System<Real = f64, State = SivaState<Phase<H>>>,
    {
        let Doing::Flight { first } = run.phase else { return None };
        let (siva, tally) = (run.system, &run.tally);
        let law = siva.common_law()?;
        // Whether the absorber leaves its wall or presses on it is decided with more digits than a lane has.
        let Primary { x, v } = &tally.state.host.primary;
        let slow = SLOW * (x.value.abs() + v.value.abs());
        if tally.state.distance.value == 0.0 && tally.state.rate.value <= slow {
            return None;
        }
        let SivaState { host, side, distance, rate } = &tally.state;
        let [force, quadrature] = f64::dispatched(
            #[inline(always)]
            || structure.force_at(run.clock),
        );
        let mut lane = Self {
            time: run.clock.value,
            time_rest: run.clock.rest,
            stop,
            mass_ratio: siva.mass_ratio(),
            share: law.share.value,
            restitution: law.restitution,
            clearance: siva.clearance(),
            over_clearance: 1.0 / siva.clearance(),
            floor: run.limits.chatter_floor,
            counts: Counts::of(run, [siva.mass_ratio(), law.restitution])?,
            first,
            state: State {
                x: host.primary.x.value,
                v: host.primary.v.value,
                force,
                quadrature,
                distance: distance.value,
                rate: rate.value,
                side: *side,
            },
            structure: *structure,
            ..Self::default()
        };
        let remaining = -run.clock.minus(stop);
        lane.length = structure.longest.min(remaining).min(first);
        (!run.ended && remaining > 0.0).then_some(lane)
    }

    /// Writes the variables back into the run.
    pub fn put_back<H: Host<Real = f64>, O>(&self, run: &mut Run<'_, Siva<H>, O>)
    where
        Siva<H>: System<Real = f64, State = SivaState<Phase<H>>>,
    {
        // At the end of the run the clock is already set to the duration.
        if !run.ended {
            run.clock = self.clock();
        }
        run.tally.state = self.state(&run.system.host, run.clock);
        self.counts.put_back(run);
        run.phase = Doing::Flight { first: self.first };
    }

    /// The state in the form of the event loop.
    pub fn state<H: Host<Real = f64>>(&self, host: &H, clock: DoubleDouble) -> SivaState<Phase<H>> {
        let State { x, v, distance, rate, side, .. } = self.state;
        let primary = Primary { x: DoubleDouble::new(x), v: DoubleDouble::new(v) };
        SivaState {
            host: host.state(host.begin_at(clock), primary),
            side,
            distance: DoubleDouble::new(distance),
            rate: DoubleDouble::new(rate),
        }
    }
}
