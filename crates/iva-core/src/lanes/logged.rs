//! Free masses whose lanes log every flight: their runs go through the flights again, from the states at their
//! begins, and notify their observers of them. So whatever is computed of a run alone is computed of a lane.

use super::free_mass::{FreeMasses, Stretch, Tier};
use super::{Job, Listing, Lockstep, ScalarRun};
use crate::absorber::system::System;
use crate::engine::observe::{Contact, Observer, Span};
use crate::measures::Wanted;

/// Number of flights after which the run of a lane takes them, so that a long run needs no more memory.
const FULL: usize = 256;

/// Lanes of free masses, and the flights of each lane that its run has not taken.
#[derive(Debug)]
pub(crate) struct Logged<T: Tier, const W: usize> {
    masses: FreeMasses<T, W>,
    logs: Vec<Vec<Stretch<T::State>>>,
    /// True if an observer needs the flights.
    logged: bool,
}

impl<T: Tier, const W: usize> Logged<T, W> {
    /// Notifies the observer of a run of the flights of its lane.
    fn tell(&mut self, lane: usize, run: &mut ScalarRun<'_, T::System>) {
        let system = run.system;
        for stretch in self.logs[lane].drain(..) {
            let Stretch { clock, h, later, hit, .. } = stretch;
            let [from, end] = self.masses.ends(lane, &stretch, system);
            let motion = system.flight(&from);
            let span = Span {
                motion: &motion,
                start: clock,
                length: h + later,
                from: system.primary(&from),
                to: system.primary(&end),
                end: &end,
            };
            run.observer.span(system, &span);
            if hit {
                let time = clock.plus_parts(h, later).value;
                let (after, impact) = system.impact(&end, time);
                let contact = Contact { time, states: [&end, &after], summed: false };
                run.observer.contact(system, &contact);
                run.observer.impact(system, &impact);
            }
        }
    }

    fn is_full(&self, lane: usize) -> bool {
        self.logs[lane].len() >= FULL
    }
}

impl<T: Tier, const W: usize> Lockstep<T::System> for Logged<T, W> {
    const WIDTH: usize = W;

    fn new(job: &Job<T::System>, wanted: Wanted, _listing: Listing) -> Self {
        let logs = (0..W).map(|_| Vec::with_capacity(FULL)).collect();
        let logged = wanted != Wanted::NONE || job.steady.is_some();
        Self { masses: FreeMasses::new(&job.system), logs, logged }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        self.masses.attempt();
        let mut full = false;
        for (lane, log) in self.logs.iter_mut().enumerate().filter(|_| self.logged) {
            if let Some(stretch) = self.masses.stretch(lane) {
                log.push(stretch);
                full |= log.len() >= FULL;
            }
        }
        self.masses.advance() | full
    }

    fn requests(&self, lane: usize) -> bool {
        self.masses.requests(lane) || self.is_full(lane)
    }

    fn serve(&mut self, lane: usize, run: &mut ScalarRun<'_, T::System>) -> bool {
        if self.masses.requests(lane) {
            self.put_back(lane, run);
            return false;
        }
        self.tell(lane, run);
        true
    }

    fn take(&mut self, lane: usize, run: &mut ScalarRun<'_, T::System>) -> bool {
        let (events, errors) = &run.observer.beside;
        self.logged |= events.is_some() || errors.is_some();
        !run.ended && self.masses.take(lane, run, None)
    }

    fn put_back(&mut self, lane: usize, run: &mut ScalarRun<'_, T::System>) {
        self.tell(lane, run);
        self.masses.put_back(lane, run);
    }

    fn idle(&mut self, lane: usize) {
        self.masses.idle(lane);
        self.logs[lane].clear();
    }
}
