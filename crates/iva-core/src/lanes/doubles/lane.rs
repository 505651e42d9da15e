//! One lane: a run reduced to the plain numbers of its flight, and arrays of such lanes.

use super::motion::{State, States, Structure, Structures};
use crate::compensated::DoubleDouble;
use crate::force::Acts;
use crate::host::{Host, Phase};
use crate::lanes::arrays::arrays;
use crate::lanes::counts::{Counts, ManyCounts};
use crate::oscillator::Primary;
use crate::simulate::{Phase as Doing, Run, STOPS};
use crate::siva::{Siva, SivaState};
use crate::system::{Clock, System};

arrays! {
    /// The numbers of one run.
    Lane,
    /// Those of many.
    Lanes:
    /// The clock, and the instant of the next stop.
    time, time_rest, stop,
    /// The length of the next trial, and how far a rebound looks first.
    length, first,
    /// Where to look for a wall again, 0: nowhere; which wall that is, and how often one has looked or halved.
    again, again_far, tries,
    /// The absorber.
    mass_ratio, share, restitution, clearance, over_clearance,
    /// Impacts with an approach speed at or below this are for the event loop.
    floor,
    /// What the event loop is needed for: a stretch that is not simple; the next stop; a limit.
    request, stopped, full;
    /// Where it is.
    state: State, States,
    /// What moves.
    structure: Structure, Structures,
    /// What is counted and summed up.
    counts: Counts, ManyCounts
}

/// A lane takes no run that leaves a wall as slowly as this, over |x| + |ẋ|.
const SLOW: f64 = 1e-6;

impl<const W: usize> Lanes<W> {
    /// The clock of a lane.
    #[inline(always)]
    pub fn clock(&self, i: usize) -> DoubleDouble {
        DoubleDouble { value: self.time[i], rest: self.time_rest[i] }
    }
}

impl Lane {
    /// Without a run: at rest for ever.
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

    /// A run that has come to where flights in plain doubles can go on; `None` if it has not.
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
        // What has just come off its wall is told from what presses by more digits than a lane has.
        let Primary { x, v } = &tally.state.host.primary;
        let slow = SLOW * (x.value.abs() + v.value.abs());
        if tally.state.distance.value == 0.0 && tally.state.rate.value <= slow {
            return None;
        }
        let SivaState { host, side, distance, rate } = &tally.state;
        let [force, quadrature] = force_at(&siva.host, run.clock);
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
        let under_way = run.stopped < STOPS && remaining > 0.0;
        under_way.then_some(lane)
    }

    /// Puts the numbers back into the run.
    pub fn put_back<H: Host<Real = f64>, O>(&self, run: &mut Run<'_, Siva<H>, O>)
    where
        Siva<H>: System<Real = f64, State = SivaState<Phase<H>>>,
    {
        // At its end the run has set its clock itself.
        if run.stopped < STOPS {
            run.clock = self.clock();
        }
        run.tally.state = self.state(&run.system.host, run.clock);
        self.counts.put_back(run);
        run.phase = Doing::Flight { first: self.first };
    }

    /// The state as the event loop has it.
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

/// F cos(Ω t + φ) and F sin(Ω t + φ), of −a_g where the base moves.
pub(super) fn force_at<H: Host<Real = f64>>(host: &H, clock: Clock) -> [f64; 2] {
    let Some(harmonic) = host.force().and_then(|force| force.harmonics().first()) else {
        return [0.0; 2];
    };
    let push = harmonic.push(clock);
    let sign = if harmonic.acts == Acts::Base { -1.0 } else { 1.0 };
    [sign * push.value.value, -sign * push.rate.value / harmonic.frequency]
}
