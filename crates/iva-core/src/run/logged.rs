//! Free masses whose lanes log every flight: their runs go through the flights again, from the states at their
//! begins, and notify their observers of them. So whatever is computed of a run alone is computed of a lane.

use super::free_mass::{FreeMasses, Tier};
use super::side_by_side::{Job, Listing, Lockstep, ScalarRun};
use crate::measures::Wanted;

/// Lanes of free masses whose observers see every flight.
#[derive(Debug)]
pub(crate) struct Logged<T: Tier, const W: usize> {
    masses: FreeMasses<T, W>,
    /// True if an observer needs the flights.
    seen: bool,
}

impl<T: Tier, const W: usize> Lockstep<T::System> for Logged<T, W> {
    const WIDTH: usize = W;

    fn new(job: &Job<T::System>, wanted: Wanted, listing: &Listing) -> Self {
        let seen = wanted != Wanted::NONE || job.steady.is_some() || !listing.is_empty();
        Self { masses: FreeMasses::new(&job.system), seen }
    }

    #[inline(always)]
    fn evaluate(&mut self) -> bool {
        self.masses.attempt();
        self.masses.advance()
    }

    fn requests(&self, lane: usize) -> bool {
        self.masses.requests(lane)
    }

    fn serve(&mut self, lane: usize, run: &mut ScalarRun<'_, T::System>) -> bool {
        self.put_back(lane, run);
        false
    }

    fn take(&mut self, lane: usize, run: &mut ScalarRun<'_, T::System>) -> bool {
        let takes = !run.ended && self.masses.take(lane, run, None);
        if takes && self.seen {
            self.masses.keep(lane);
        }
        takes
    }

    fn put_back(&mut self, lane: usize, run: &mut ScalarRun<'_, T::System>) {
        self.masses.show(lane, run.system, &mut run.observer);
        self.masses.put_back(lane, run);
    }

    fn idle(&mut self, lane: usize) {
        self.masses.idle(lane);
    }
}
