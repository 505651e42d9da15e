//! Steps of pendulums, side by side, free or under one harmonic force; they have one tolerance, and large angles or small.
//!
//! A lane goes through steps of flight that meet no wall, or one in the simplest way: then it goes there in
//! the next round, and its run applies the impact. Everything else (a hard search, a ride, a step across the instants that
//! measures look at) is for the event loop.
//!
//! The measures of a decay are taken in the lanes. Those of a driven run are shown each step as the event loop shows it
//! them.

mod lane;
mod rows;
mod step;
mod watch;

use super::{Job, LANES, Lockstep, ScalarRun};
use crate::arrays::Lanes as _;
use crate::compensated::DoubleDouble;
use crate::flight::{Losses, Side};
use crate::measures::Wanted;
use crate::observe::{Observer, Span};
use crate::piva::{Known, Piva, PivaFlight};
use crate::settling::Crossing;
use crate::simulate::Phase;
use crate::steady::SteadyWanted;
use crate::system::System;
use lane::{FAR, Lane, Lanes, NEAR};
use rows::Rows;

/// Lanes side by side whose series have the order N.
#[derive(Debug)]
pub(super) struct Steps<const N: usize, const DRIVEN: bool, const SMALL: bool> {
    lanes: Lanes<LANES>,
    rows: Rows<LANES>,
    shared: Shared,
}

/// The settings that all lanes share.
#[derive(Debug, Clone, Copy)]
struct Shared {
    /// Largest truncation error of a step, relative to the size of each variable.
    tolerance: f64,
    /// Longest step, over the fastest time scale.
    longest: f64,
    /// Bound on the error of y, relative to the clearance.
    doubt: f64,
    /// True if measures read the displacement of a free decay.
    decay: bool,
    /// True if losses are asked for.
    ledger: bool,
    /// True if pivots are damped.
    pivots: bool,
    /// 1 if the measures of driven runs are shown their steps.
    tells: f64,
    /// True if mean squares of displacements are asked for.
    squares: bool,
    /// True if largest displacements or accelerations are asked for.
    extremes: bool,
}

impl<const N: usize, const DRIVEN: bool, const SMALL: bool> Steps<N, DRIVEN, SMALL> {
    /// Lets a lane go on, after the impact if it met a wall; false if the event loop has to take the run.
    fn meet(&mut self, i: usize, run: &mut ScalarRun<'_, Piva>) -> bool {
        let lanes = &self.lanes;
        if lanes.request[i] == 0.0 {
            return true;
        }
        lanes.get(i).put_back::<DRIVEN>(run);
        let side = if lanes.met[i] == NEAR {
            Side::Near
        } else if lanes.met[i] == FAR {
            Side::Far
        } else {
            return false;
        };
        run.meet(side);
        self.take(i, run)
    }

    /// Shows the measures of a driven run the step that its lane has done.
    fn tell(&self, i: usize, run: &mut ScalarRun<'_, Piva>) {
        let (lane, system) = (self.lanes.get(i), run.system);
        let (from, end) = (lane.origin.state(), lane.pose.state());
        let (series, drive) = (self.rows.get::<N>(i), self.rows.drive(i));
        let losses = Losses { viscous: lane.lost, pivot: lane.lost_in_pivot, work: lane.worked };
        let known = Known { losses, square: lane.square, limits: [lane.limit_x, lane.limit_a] };
        let rows = (series, drive);
        let motion = PivaFlight::flown(system, from, rows, lane.step, (lane.length, known));
        let span = Span {
            motion: &motion,
            start: DoubleDouble { value: lane.start_time, rest: lane.start_time_rest },
            length: lane.length,
            from: system.primary(&from),
            to: system.primary(&end),
            end: &end,
        };
        run.observer.span(system, &span);
    }
}

impl<const N: usize, const DRIVEN: bool, const SMALL: bool> Lockstep<Piva>
    for Steps<N, DRIVEN, SMALL>
{
    fn new(Job { system: piva, steady, .. }: &Job<Piva>, wanted: Wanted) -> Self {
        let steady = steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let tells = wanted.ledger || steady != SteadyWanted::default();
        let shared = Shared {
            tolerance: piva.accuracy.tolerance,
            longest: piva.accuracy.longest_step,
            doubt: piva.accuracy.doubt(),
            decay: wanted.decay(),
            ledger: wanted.ledger,
            pivots: piva.pendulum.pivot_damping != 0.0,
            tells: if tells { 1.0 } else { 0.0 },
            squares: steady.rms,
            extremes: steady.amplitude || steady.regime || steady.acceleration,
        };
        Self { lanes: Lanes::new(), rows: Rows::new(), shared }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, rows, shared } = self;
        step::begin::<LANES, DRIVEN, SMALL>(lanes, rows, shared);
        step::series::<LANES, N, DRIVEN, SMALL>(lanes, rows);
        step::prove::<LANES, N, DRIVEN, SMALL>(lanes, rows, shared);
        if !DRIVEN && shared.decay {
            step::arrive::<LANES, N, DRIVEN, SMALL, true>(lanes, rows, shared);
        } else {
            step::arrive::<LANES, N, DRIVEN, SMALL, false>(lanes, rows, shared);
        }
        if any(&lanes.meets) {
            step::meet::<LANES, N, SMALL>(lanes, rows);
        }
        if shared.ledger {
            step::lose::<LANES, N, DRIVEN>(lanes, rows, shared);
        }
        if DRIVEN && shared.squares {
            step::square::<LANES, N>(lanes, rows);
        }
        if DRIVEN && shared.extremes {
            step::limit::<LANES, N>(lanes, rows);
        }
        any(&lanes.requests)
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.requests[i] > 0.0
    }

    fn serve(&mut self, i: usize, run: &mut ScalarRun<'_, Piva>) -> bool {
        if DRIVEN {
            if self.shared.tells > 0.0 && self.lanes.share[i] > 0.0 {
                self.tell(i, run);
            }
            return self.meet(i, run);
        }
        if self.lanes.watch.peaked[i] > 0.0 {
            let (peak, index) = self.lanes.watch.get(i).ended_peak();
            run.observer.measures.peak(&peak, index);
            self.lanes.watch.listen(i, &run.observer.measures);
        }
        let lanes = &self.lanes;
        let passages = [
            (lanes.passed_1[i], [lanes.from_1[i], lanes.to_1[i]]),
            (lanes.passed_2[i], [lanes.from_2[i], lanes.to_2[i]]),
            (lanes.passed_3[i], [lanes.from_3[i], lanes.to_3[i]]),
        ];
        for (last, (level, h)) in run.observer.measures.settling.iter_mut().zip(passages) {
            if level != 0.0 {
                let origin = lanes.origin.get(i).state();
                let start =
                    DoubleDouble { value: lanes.start_time[i], rest: lanes.start_time_rest[i] };
                last.passed(Crossing { origin, riding: false, start, h, level });
            }
        }
        self.meet(i, run)
    }

    fn take(&mut self, i: usize, run: &mut ScalarRun<'_, Piva>) -> bool {
        let Phase::Flight { first } = run.phase else { return false };
        let reference = &run.observer.measures.reference;
        let settled = DRIVEN || (reference.settled && reference.amplitude > 0.0);
        let lane = Lane::of(run, first);
        let fits = settled
            && lane.work < lane.max_work
            && run.counts.listed() < run.limits.max_impacts as f64;
        if fits {
            self.lanes.set(i, &lane);
        }
        fits
    }

    fn put_back(&mut self, i: usize, run: &mut ScalarRun<'_, Piva>) {
        self.lanes.get(i).put_back::<DRIVEN>(run);
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
    }
}

/// True if one of these is not 0; none is negative.
#[inline(always)]
fn any<const W: usize>(flags: &[f64; W]) -> bool {
    flags.iter().fold(0.0, |sum, flag| sum + flag) > 0.0
}
