//! Runs under one harmonic force: lanes compute motions only and log their flights, as the event loop does where
//! it goes on. Measures are computed when a log is full or its run has ended ([`crate::measures::forced`]).

use super::{Job, Lockstep, ScalarRun};
use crate::host::DrivenHost;
use crate::measures::Wanted;
use crate::measures::forced::Forced;
use crate::plain::State;
use crate::siva::Siva;
use crate::system::Clock;

/// Flights of free masses in lanes, under one harmonic force each, on the structure or on its base.
pub(super) trait Flights: Sized {
    /// Number of lanes.
    const WIDTH: usize;
    /// Idle lanes for absorbers like this one.
    fn new(siva: &Siva<DrivenHost>) -> Self;
    /// Advances each lane by one evaluation, and hands out the flights that it completes, if they are wanted:
    /// the lane, the clock at the begin and the length, instant and approach speed of the impact at the end (0:
    /// none), and the states at both ends. True if a lane needs its run.
    fn evaluate(
        &mut self,
        wanted: bool,
        take: impl FnMut(usize, Clock, f64, [f64; 2], [&State; 2]),
    ) -> bool;
    /// True if this lane needs its run.
    fn requests(&self, lane: usize) -> bool;
    /// Loads a run into a lane; false if the run is not at a state from which the lane can go on.
    fn take(&mut self, lane: usize, run: &Driven<'_>) -> bool;
    /// Writes the variables of a lane back into its run.
    fn put_back(&self, lane: usize, run: &mut Driven<'_>);
    /// Makes a lane idle.
    fn idle(&mut self, lane: usize);
}

/// The run of a lane.
pub(super) type Driven<'a> = ScalarRun<'a, Siva<DrivenHost>>;

/// Lanes of driven runs, and the log of the run of each lane.
#[derive(Debug)]
pub(super) struct ForcedRuns<F> {
    flights: F,
    logs: Vec<Option<Box<Forced>>>,
    /// True if measures need the flights.
    logged: bool,
}

impl<F: Flights> Lockstep<Siva<DrivenHost>> for ForcedRuns<F> {
    const WIDTH: usize = F::WIDTH;

    fn new(job: &Job<Siva<DrivenHost>>, wanted: Wanted) -> Self {
        let steady = job.steady.map(|(steady, _)| steady).unwrap_or_default();
        let logs = (0..F::WIDTH).map(|_| None).collect();
        Self { flights: F::new(&job.system), logs, logged: wanted.ledger || steady.any() }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { flights, logs, logged } = self;
        let mut full = false;
        let requests = flights.evaluate(
            *logged,
            #[inline(always)]
            |lane, clock, length, impact, ends| {
                if let Some(log) = &mut logs[lane] {
                    log.push(clock, length, impact, ends);
                    full |= log.is_full();
                }
            },
        );
        requests | full
    }

    fn requests(&self, lane: usize) -> bool {
        let full = self.logs[lane].as_ref().is_some_and(|log| log.is_full());
        full || self.flights.requests(lane)
    }

    fn serve(&mut self, lane: usize, run: &mut Driven<'_>) -> bool {
        if self.flights.requests(lane) {
            self.put_back(lane, run);
            return false;
        }
        run.observer.forced = self.logs[lane].take();
        run.observer.take_log();
        self.logs[lane] = run.observer.forced.take();
        true
    }

    fn take(&mut self, lane: usize, run: &mut Driven<'_>) -> bool {
        // A force too fast for the log is left to the event loop.
        let fits = !run.ended && (!self.logged || run.observer.forced.is_some());
        let takes = fits && self.flights.take(lane, run);
        if takes {
            self.logs[lane] = run.observer.forced.take();
        }
        takes
    }

    fn put_back(&mut self, lane: usize, run: &mut Driven<'_>) {
        self.flights.put_back(lane, run);
        run.observer.forced = self.logs[lane].take();
    }

    fn idle(&mut self, lane: usize) {
        self.flights.idle(lane);
        self.logs[lane] = None;
    }
}
