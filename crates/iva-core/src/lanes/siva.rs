//! Lanes for the fast flights of free masses in free decay; their primary structures have one damping ratio.

mod driven;
mod flying;
mod lane;
mod look;
mod step;

use super::{Job, LANES, Lockstep, Observers, ScalarRun};
use crate::host::Host;
use crate::measures::{Wanted, is_one_period};
use crate::oscillator::Oscillator;
use crate::simulate::STOPS;
use crate::siva::Siva;
use crate::system::System;
pub(super) use driven::DrivenFastFlights;

use flying::STOP;
use lane::{Lane, Lanes};

/// Eight lanes on one primary structure, with or without viscous losses and measures of the displacement.
#[derive(Debug)]
pub(super) struct FastFlights<const LEDGER: bool, const DECAY: bool> {
    lanes: Lanes<LANES>,
    /// The structure without absorber. Held by value, so that the compiler knows that it does not overlap the
    /// arrays.
    free: Oscillator,
}

impl<const LEDGER: bool, const DECAY: bool> Lockstep<Siva> for FastFlights<LEDGER, DECAY> {
    type Observer = Observers<Siva>;

    fn new(Job { system: siva, .. }: &Job<Siva>, _wanted: Wanted) -> Self {
        Self { lanes: Lanes::new(), free: *siva.host.free() }
    }

    fn join(leader: &Siva, siva: &Siva) {
        siva.host.share(&leader.host);
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        evaluate::<LANES, LEDGER, DECAY>(&mut self.lanes, &self.free)
    }

    fn requests(&self, i: usize) -> bool {
        let lanes = &self.lanes;
        lanes.flying.request[i] + lanes.flying.stopped[i] + lanes.decay.watch.peaked[i] > 0.0
    }

    fn serve(&mut self, i: usize, run: &mut ScalarRun<'_, Siva>) -> bool {
        let lanes = &mut self.lanes;
        if lanes.decay.watch.peaked[i] > 0.0 {
            let (peak, index) = lanes.decay.watch.get(i).ended_peak();
            run.observer.0.peak(&peak, index);
            lanes.decay.watch.listen(i, &run.observer.0);
        }
        if lanes.flying.stopped[i] == STOP {
            let mut lane = lanes.get(i);
            if pass_stop(run, &mut lane, &self.free) {
                lanes.set(i, &lane);
                return true;
            }
        }
        let goes_on = lanes.flying.request[i] + lanes.flying.stopped[i] == 0.0;
        if !goes_on {
            lanes.get(i).put_back(run);
        }
        goes_on
    }

    fn take(&mut self, i: usize, run: &mut ScalarRun<'_, Siva>) -> bool {
        let reference = &run.observer.0.reference;
        let settled = !DECAY || reference.settled && reference.amplitude > 0.0;
        let lane = Lane::of(run, self.free.reach).filter(|_| settled);
        if let Some(lane) = &lane {
            self.lanes.set(i, lane);
        }
        lane.is_some()
    }

    fn put_back(&mut self, i: usize, run: &mut ScalarRun<'_, Siva>) {
        self.lanes.get(i).put_back(run);
    }

    fn idle(&mut self, i: usize) {
        self.lanes.set(i, &Lane::idle());
    }
}

/// One evaluation of each lane; true if a lane needs its run.
#[inline(always)]
fn evaluate<const W: usize, const LEDGER: bool, const DECAY: bool>(
    lanes: &mut Lanes<W>,
    free: &Oscillator,
) -> bool {
    for i in 0..W {
        let lane = step::step::<LEDGER, DECAY>(free, &lanes.get(i));
        lanes.set(i, &lane);
    }
    let mut requests = 0.0;
    for i in 0..W {
        requests += lanes.flying.request[i] + lanes.flying.stopped[i] + lanes.decay.watch.peaked[i];
    }
    requests > 0.0
}

/// Handles a stop within the run; false: the run goes back to the event loop.
fn pass_stop(run: &mut ScalarRun<'_, Siva>, lane: &mut Lane, free: &Oscillator) -> bool {
    let flying = &mut lane.flying;
    if is_one_period(flying.stop) {
        run.observer.0.one_period(run.system.energy(&flying.state(())));
    }
    run.pass_stop();
    if run.stopped == STOPS || flying.counts.full() {
        return false;
    }
    flying.stop = run.stop();
    let remaining = -flying.clock().minus(flying.stop);
    flying.length = free.reach.min(remaining).min(flying.first);
    flying.h = flying.length;
    flying.stopped = 0.0;
    lane.decay.watch.peaked = 0.0;
    remaining > 0.0
}
