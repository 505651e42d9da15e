//! Runs under one harmonic force: lanes compute motions only and log their flights, as the event loop does where
//! it goes on. Measures are computed when a log is full or its run has ended ([`crate::measures::forced`]).

use super::free_mass::{FreeMasses, Tier};
use super::side_by_side::{Job, Listing, Lockstep, ScalarRun};
use crate::absorber::siva::Siva;
use crate::host::DrivenHost;
use crate::measures::Wanted;
use crate::measures::forced::Forced;

/// The run of a lane.
pub(super) type Driven<'a> = ScalarRun<'a, Siva<DrivenHost>>;

/// Lanes of driven runs, and the log of the run of each lane.
#[derive(Debug)]
pub(super) struct ForcedRuns<T: Tier, const W: usize> {
    masses: FreeMasses<T, W>,
    logs: Vec<Option<Box<Forced>>>,
    /// True if measures need the flights.
    logged: bool,
}

impl<T: Tier<System = Siva<DrivenHost>>, const W: usize> Lockstep<Siva<DrivenHost>>
    for ForcedRuns<T, W>
{
    const WIDTH: usize = W;

    fn new(job: &Job<Siva<DrivenHost>>, wanted: Wanted, _listing: &Listing) -> Self {
        let steady = job.steady.map(|(steady, _)| steady).unwrap_or_default();
        let logs = (0..W).map(|_| None).collect();
        let masses = FreeMasses::new(&job.system);
        Self { masses, logs, logged: wanted.ledger || steady.any() }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { masses, logs, logged } = self;
        masses.attempt();
        let mut full = false;
        for (lane, log) in logs.iter_mut().enumerate().filter(|_| *logged) {
            if let (Some(log), Some((clock, length, impact, ends))) = (log, masses.flight(lane)) {
                log.push(clock, length, impact, [&ends[0], &ends[1]]);
                full |= log.is_full();
            }
        }
        masses.advance() | full
    }

    fn requests(&self, lane: usize) -> bool {
        let full = self.logs[lane].as_ref().is_some_and(|log| log.is_full());
        full || self.masses.requests(lane)
    }

    fn serve(&mut self, lane: usize, run: &mut Driven<'_>) -> bool {
        if self.masses.requests(lane) {
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
        let takes = fits && self.masses.take(lane, run, run.observer.forced.as_deref());
        if takes {
            self.masses.listen(lane, run);
            self.logs[lane] = run.observer.forced.take();
        }
        takes
    }

    fn put_back(&mut self, lane: usize, run: &mut Driven<'_>) {
        self.masses.tell(lane, run);
        self.masses.put_back(lane, run);
        run.observer.forced = self.logs[lane].take();
    }

    fn idle(&mut self, lane: usize) {
        self.masses.idle(lane);
        self.logs[lane] = None;
    }
}
