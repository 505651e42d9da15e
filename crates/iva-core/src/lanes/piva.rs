//! Steps of pendulums at large angles, side by side; they have one tolerance.
//!
//! A lane goes through steps of flight that meet no wall, or one in the simplest way: then it goes there in
//! the next round, and its run applies the impact. Everything else (a hard search, a ride, a step across the instants that
//! measures look at) is for the event loop.

mod lane;
mod rows;
mod step;

use super::{Job, LANES, Lockstep, Observers, ScalarRun};
use crate::compensated::DoubleDouble;
use crate::flight::Side;
use crate::measures::Wanted;
use crate::piva::Piva;
use crate::settling::Crossing;
use crate::simulate::Phase;
use lane::{FAR, Lane, Lanes, NEAR};
use rows::Rows;

/// Eight lanes whose series have the order N.
#[derive(Debug)]
pub(super) struct Steps<const N: usize> {
    lanes: Lanes<LANES>,
    rows: Rows<LANES>,
    shared: Shared,
}

/// What all lanes have in common.
#[derive(Debug, Clone, Copy)]
struct Shared {
    /// What a step may leave out.
    tolerance: f64,
    /// How long it may be, over the fastest time scale.
    longest: f64,
    /// What y may be off, relative to the clearance.
    doubt: f64,
    /// True if losses are asked for.
    ledger: bool,
    /// True if pivots are damped.
    pivots: bool,
}

impl<const N: usize> Lockstep<Piva> for Steps<N> {
    type Observer = Observers<Piva>;

    fn new(Job { system: piva, .. }: &Job<Piva>, wanted: Wanted) -> Self {
        let shared = Shared {
            tolerance: piva.accuracy.tolerance,
            longest: piva.accuracy.longest_step,
            doubt: piva.accuracy.doubt(),
            ledger: wanted.ledger,
            pivots: piva.pendulum.pivot_damping != 0.0,
        };
        Self { lanes: Lanes::new(), rows: Rows::new(), shared }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { lanes, rows, shared } = self;
        step::series::<LANES, N>(lanes, rows, shared);
        step::prove::<LANES, N>(lanes, rows, shared);
        step::arrive::<LANES, N>(lanes, rows, shared);
        if any(&lanes.meets) {
            step::meet::<LANES, N>(lanes, rows);
        }
        if shared.ledger {
            step::lose::<LANES, N>(lanes, rows, shared.pivots);
        }
        any(&lanes.requests)
    }

    fn requests(&self, i: usize) -> bool {
        self.lanes.requests[i] > 0.0
    }

    fn serve(&mut self, i: usize, run: &mut ScalarRun<'_, Piva>) -> bool {
        if self.lanes.watch.peaked[i] > 0.0 {
            let (peak, index) = self.lanes.watch.get(i).ended_peak();
            run.observer.0.peak(&peak, index);
            self.lanes.watch.listen(i, &run.observer.0);
        }
        let lanes = &self.lanes;
        let passages = [
            (lanes.passed_1[i], [lanes.from_1[i], lanes.to_1[i]]),
            (lanes.passed_2[i], [lanes.from_2[i], lanes.to_2[i]]),
            (lanes.passed_3[i], [lanes.from_3[i], lanes.to_3[i]]),
        ];
        for (last, (level, h)) in run.observer.0.settling.iter_mut().zip(passages) {
            if level != 0.0 {
                let origin = lanes.origin.get(i).state();
                let start =
                    DoubleDouble { value: lanes.start_time[i], rest: lanes.start_time_rest[i] };
                last.passed(Crossing { origin, riding: false, start, h, level });
            }
        }
        if lanes.request[i] == 0.0 {
            return true;
        }
        lanes.get(i).put_back(run);
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

    fn take(&mut self, i: usize, run: &mut ScalarRun<'_, Piva>) -> bool {
        let Phase::Flight { first } = run.phase else { return false };
        let settled = run.observer.0.reference.settled && run.observer.0.reference.amplitude > 0.0;
        let lane = Lane::of(run, first);
        let fits = settled && lane.work < lane.max_work && run.listed() < run.limits.max_impacts;
        if fits {
            self.lanes.set(i, &lane);
        }
        fits
    }

    fn put_back(&mut self, i: usize, run: &mut ScalarRun<'_, Piva>) {
        self.lanes.get(i).put_back(run);
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
    }
}

/// True if one of these is not 0; none is negative.
#[inline(always)]
fn any(flags: &[f64; LANES]) -> bool {
    flags.iter().fold(0.0, |sum, flag| sum + flag) > 0.0
}
