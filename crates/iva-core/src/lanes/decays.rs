//! Free decays: lanes compute motions only and log where the motions of the structure begin ([`crate::log`]),
//! as the event loop does where it goes on. Measures are computed from the log ([`crate::measures`]).

use super::{Job, Lockstep, ScalarRun};
use crate::host::Host;
use crate::log::{Entry, Log};
use crate::measures::{Wanted, keeps};
use crate::siva::Siva;

/// Flights of free masses in lanes, on one structure without drive.
pub(super) trait Flights: Sized {
    /// Number of lanes.
    const WIDTH: usize;
    /// Idle lanes for absorbers on the structure of this one.
    fn new(siva: &Siva) -> Self;
    /// Advances each lane by one evaluation; true if a lane needs its run.
    fn evaluate(&mut self) -> bool;
    /// The clock of each lane.
    fn times(&self) -> &[f64];
    /// True if this evaluation has found an impact in any lane.
    fn hits(&self) -> bool;
    /// The begin of the motion after the impact that this evaluation of a lane has found, if it has.
    fn motion(&self, lane: usize) -> Option<Entry>;
    /// True if this lane needs its run.
    fn requests(&self, lane: usize) -> bool;
    /// Loads a run into a lane; false if the run is not at a state from which the lane can go on.
    fn take(&mut self, lane: usize, run: &Decaying<'_>) -> bool;
    /// Writes the variables of a lane back into its run; returns ẋ there.
    fn put_back(&self, lane: usize, run: &mut Decaying<'_>) -> f64;
    /// Makes a lane idle.
    fn idle(&mut self, lane: usize);
}

/// The run of a lane.
pub(super) type Decaying<'a> = ScalarRun<'a, Siva>;

/// Lanes of free decays, and the log of the run of each lane.
#[derive(Debug)]
pub(super) struct Decays<F> {
    flights: F,
    logs: Vec<Log>,
    wanted: Wanted,
    /// False if no motion of any lane is to be logged any more.
    logging: bool,
}

impl<F: Flights> Decays<F> {
    /// Exchanges the log of a lane for that of its run.
    fn swap_logs(&mut self, lane: usize, run: &mut Decaying<'_>) {
        if let Some(decay) = &mut run.observer.measures.decay {
            std::mem::swap(&mut self.logs[lane], &mut decay.log);
        }
    }
}

impl<F: Flights> Lockstep<Siva> for Decays<F> {
    const WIDTH: usize = F::WIDTH;

    fn new(job: &Job<Siva>, wanted: Wanted) -> Self {
        let logs = (0..F::WIDTH).map(|_| Log::default()).collect();
        Self { flights: F::new(&job.system), logs, wanted, logging: true }
    }

    fn join(leader: &Siva, siva: &Siva) {
        siva.host.share(&leader.host);
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { flights, logs, wanted, logging } = self;
        let mut requests = flights.evaluate();
        if !(*logging && flights.hits()) {
            return requests;
        }
        *logging = flights.times().iter().any(|time| keeps(*wanted, *time));
        for (lane, log) in logs.iter_mut().enumerate() {
            if let Some(entry) = flights.motion(lane).filter(|entry| keeps(*wanted, entry.time)) {
                log.push(entry);
                requests |= log.is_full();
            }
        }
        requests
    }

    fn requests(&self, lane: usize) -> bool {
        self.flights.requests(lane) || self.logs[lane].is_full()
    }

    fn serve(&mut self, lane: usize, run: &mut Decaying<'_>) -> bool {
        // The lane keeps its run, so that the motion does not depend on what is logged.
        if self.logs[lane].is_full() {
            self.swap_logs(lane, run);
            run.observer.measures.make_room();
            self.swap_logs(lane, run);
        }
        if self.flights.requests(lane) {
            self.put_back(lane, run);
            return false;
        }
        true
    }

    fn take(&mut self, lane: usize, run: &mut Decaying<'_>) -> bool {
        let takes = !run.ended && self.flights.take(lane, run);
        if takes {
            let (system, clock, state) = (run.system, run.clock, run.tally.state);
            run.observer.measures.begins(system, clock, &state, false);
            self.logging = true;
            self.swap_logs(lane, run);
        }
        takes
    }

    fn put_back(&mut self, lane: usize, run: &mut Decaying<'_>) {
        let v = self.flights.put_back(lane, run);
        self.swap_logs(lane, run);
        if let Some(decay) = &mut run.observer.measures.decay {
            decay.v_before = v;
        }
    }

    fn idle(&mut self, lane: usize) {
        self.flights.idle(lane);
    }
}
