//! Free decays: lanes compute motions only and log where the motions of the structure begin ([`crate::measures::log`]),
//! as the event loop does where it goes on. Measures are computed from the log ([`crate::measures`]).

use super::free_mass::{FreeMasses, Tier};
use super::side_by_side::{Job, Listing, Lockstep, ScalarRun, SideBySide};
use crate::absorber::siva::{Siva, SivaState};
use crate::host::{Host, Phase};
use crate::measures::log::Log;
use crate::measures::{Wanted, keeps};

/// Lanes of free decays, and the log of the run of each lane.
#[derive(Debug)]
pub(super) struct Decays<T: Tier, const W: usize> {
    masses: FreeMasses<T, W>,
    logs: Vec<Log>,
    wanted: Wanted,
    /// False if no motion of any lane is to be logged any more.
    logging: bool,
}

impl<T: Tier, const W: usize> Decays<T, W> {
    /// Exchanges the log of a lane for that of its run.
    fn swap_logs<S: SideBySide>(&mut self, lane: usize, run: &mut ScalarRun<'_, S>) {
        if let Some(decay) = &mut run.observer.measures.decay {
            std::mem::swap(&mut self.logs[lane], &mut decay.log);
        }
    }
}

impl<H: Host<Real = f64>, T: Tier<System = Siva<H>>, const W: usize> Lockstep<Siva<H>>
    for Decays<T, W>
where
    Siva<H>: SideBySide<State = SivaState<Phase<H>>>,
{
    const WIDTH: usize = W;

    fn new(job: &Job<Siva<H>>, wanted: Wanted, _listing: &Listing) -> Self {
        let logs = (0..W).map(|_| Log::default()).collect();
        let masses = FreeMasses::new(&job.system);
        Self { masses, logs, wanted, logging: true }
    }

    fn join(leader: &Siva<H>, siva: &Siva<H>) {
        siva.host.share(&leader.host);
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        let Self { masses, logs, wanted, logging } = self;
        masses.attempt();
        let mut requests = masses.advance();
        if !(*logging && masses.hits()) {
            return requests;
        }
        *logging = masses.times().iter().any(|time| keeps(*wanted, *time));
        for (lane, log) in logs.iter_mut().enumerate() {
            if let Some(entry) = masses.motion(lane).filter(|entry| keeps(*wanted, entry.time)) {
                log.push(entry);
                requests |= log.is_full();
            }
        }
        requests
    }

    fn requests(&self, lane: usize) -> bool {
        self.masses.requests(lane) || self.logs[lane].is_full()
    }

    fn serve(&mut self, lane: usize, run: &mut ScalarRun<'_, Siva<H>>) -> bool {
        // The lane keeps its run, so that the motion does not depend on what is logged.
        if self.logs[lane].is_full() {
            self.swap_logs(lane, run);
            run.observer.measures.make_log_room();
            self.swap_logs(lane, run);
        }
        if self.masses.requests(lane) {
            self.put_back(lane, run);
            return false;
        }
        true
    }

    fn take(&mut self, lane: usize, run: &mut ScalarRun<'_, Siva<H>>) -> bool {
        // A run whose measures need its stretches is left to the event loop.
        let logs = run.observer.measures.decay.is_some() || !keeps(self.wanted, 0.0);
        let takes = !run.ended && logs && self.masses.take(lane, run, None);
        if takes {
            self.masses.listen(lane, run);
            let (system, clock, state) = (run.system, run.progress.clock, run.tally.state);
            run.observer.measures.begins(system, clock, &state, false);
            self.logging = true;
            self.swap_logs(lane, run);
        }
        takes
    }

    fn put_back(&mut self, lane: usize, run: &mut ScalarRun<'_, Siva<H>>) {
        self.masses.tell(lane, run);
        self.masses.put_back(lane, run);
        self.swap_logs(lane, run);
        if let Some(decay) = &mut run.observer.measures.decay {
            decay.v_before = run.tally.state.host.primary.v.value;
        }
    }

    fn idle(&mut self, lane: usize) {
        self.masses.idle(lane);
    }
}
