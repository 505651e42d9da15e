//! Groups of runs whose lanes share what they need.

use std::sync::atomic::AtomicBool;

use super::running::Running;
use super::side_by_side::{
    Job, Listed, Listing, Lockstep, ScalarRun, SideBySide, TakeListed, Tier, Watch, is_set,
};
use crate::engine::observe::Events;
use crate::engine::simulate::{Instant, Run, Tally};
use crate::error::Invalid;
use crate::host::Excitation;
use crate::measures::Wanted;
use crate::measures::extremes::Extremes;
use crate::measures::pass::Passes;
use crate::measures::propagation::{Errors, Way as _};
use crate::measures::steady::Steady;
use crate::measures::summary::Summary;

/// Groups of fewer runs than this go one by one.
const WORTHWHILE: usize = 3;

/// Sorts jobs into groups and runs them.
pub(super) fn grouped<S: SideBySide>(
    jobs: &[Job<S>],
    (wanted, listing): (Wanted, &Listing),
    cancel: Option<&AtomicBool>,
    take: TakeListed<'_, S>,
) -> Result<(), Invalid> {
    let wanted = Wanted { envelope: listing.envelope, ..wanted };
    for Job { system, start, limits, .. } in jobs {
        system.check_start(start)?;
        limits.check()?;
    }
    // The peaks of a run under a lasting force are found in the event loop.
    let lists = |system: &S| !(listing.envelope && system.excitation().is_driven());
    let common = |index: &usize| {
        let job = &jobs[*index];
        S::common(job).filter(|_| lists(&job.system))
    };
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    // Jobs for the event loop come first, with the key −∞.
    let key = |index: &usize| common(index).unwrap_or([-f64::INFINITY; 2]);
    order.sort_by(|x, y| {
        let ([a, b], [c, d]) = (key(x), key(y));
        let shared = |index: usize| S::shared(&jobs[index]);
        a.total_cmp(&c).then(b.total_cmp(&d)).then(shared(*x).total_cmp(&shared(*y)))
    });
    for same in order.chunk_by(|a, b| key(a) == key(b)) {
        let group = Group { jobs, order: same, next: 0, wanted, listing, cancel, take };
        // A group of the fast tier goes in lanes even if it has one run: so a result does not depend on the
        // other jobs.
        let few = same.len() < WORTHWHILE && group.tier() == Tier::Exact;
        if few || common(&same[0]).is_none() {
            group.one_by_one();
        } else {
            S::run(group);
        }
    }
    Ok(())
}

/// A group of jobs with equal keys.
pub struct Group<'a, S: SideBySide> {
    pub(super) jobs: &'a [Job<S>],
    /// The indices of its jobs.
    pub(super) order: &'a [usize],
    /// The position in `order` of the first job that has not begun.
    pub(super) next: usize,
    pub(super) wanted: Wanted,
    pub(super) listing: &'a Listing,
    pub(super) cancel: Option<&'a AtomicBool>,
    pub(super) take: TakeListed<'a, S>,
}

impl<'a, S: SideBySide> Group<'a, S> {
    /// The run of a job, begun.
    pub(super) fn begun(&self, index: usize, spare: Option<Watch<S>>) -> ScalarRun<'a, S> {
        let job = &self.jobs[index];
        let Job { system, start, begin, limits, steady, .. } = job;
        let Listing { events, errors, extremes, passes, .. } = self.listing;
        // In the fast tier states of free masses are plain doubles; those of pendulums are as in the exact tier.
        let plain = !S::Way::looks_within(system) && S::tier(job) == Tier::Fast;
        let estimate = || if plain { Errors::in_doubles() } else { Errors::default() };
        let from = steady.map_or(*begin, |(_, window)| window.from);
        let passes = Passes::new(from, passes.iter().map(|make| make()).collect());
        let listed = (
            (events.then(Events::default), errors.then(|| Box::new(estimate()))),
            (extremes.then(|| Extremes::new(from)), passes),
        );
        let observer = match spare {
            Some(mut spare) => {
                spare.again(self.wanted, *steady, listed);
                spare
            }
            None => Box::new(Summary::with(self.wanted, *steady, listed)),
        };
        let start = Instant::at(system, start, *begin);
        let mut run = Run::new(system, &start, limits, self.cancel, observer);
        run.begin();
        run
    }

    /// Hands out the result of a run.
    pub(super) fn hand_out(
        &mut self,
        index: usize,
        tally: Tally<S::State>,
        summary: &mut Watch<S>,
    ) {
        let steady = summary.steady_values().copied();
        let ((events, errors), (extremes, passes)) = std::mem::take(&mut summary.beside);
        let envelope = summary.measures.take_envelope();
        let strobes = summary.steady().and_then(Steady::all_strobes);
        let extremes = extremes.map(|it| it.values().to_vec()).unwrap_or_default();
        let absorbers = std::mem::take(&mut summary.absorbers);
        let passes = passes.values().collect();
        let listed = Listed { events, errors, envelope, strobes, extremes, passes, absorbers };
        (self.take)(index, &(tally, *summary.values(), steady), listed);
    }

    pub(super) fn one_by_one(mut self) {
        for index in self.order {
            if is_set(self.cancel) {
                break;
            }
            let mut run = self.begun(*index, None);
            while run.step() {}
            let tally = run.finish();
            self.hand_out(*index, tally, &mut run.observer);
        }
    }

    /// The absorber of the first run.
    pub(super) fn leader(&self) -> &S {
        &self.jobs[self.order[0]].system
    }

    pub(super) fn tier(&self) -> Tier {
        S::tier(&self.jobs[self.order[0]])
    }

    /// True if anything but counts of impacts is computed of its runs.
    pub(super) fn is_watched(&self) -> bool {
        let steady = self.jobs[self.order[0]].steady.is_some();
        steady || self.wanted != Wanted::NONE || !self.listing.is_empty()
    }

    pub(crate) fn run<L: Lockstep<S>>(self) {
        Running::new(self).run::<L>();
    }
}
