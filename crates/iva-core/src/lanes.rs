//! Runs of many absorbers of one kind, side by side: free decays, and free masses under one harmonic force or on a base
//! that it moves.
//!
//! One run spends its time waiting: each number of a stretch of motion needs the one before. Here [`LANES`]
//! runs go in step, each in its lane, and every operation is done for all of them by the vector
//! instructions of the machine. Three things make that possible:
//!
//! * **A stretch has no branches.** The fast flights of a free mass (`lanes/siva.rs`) and the steps of a pendulum
//!   (`lanes/piva.rs`) are the code of one lane, written for one number; a loop over
//!   arrays of numbers becomes vector code by itself, for AVX-512, AVX2 or the baseline, whichever the
//!   machine has. Each lane does all that any may need, and picks.
//! * **What is not simple goes to the event loop.** Each lane belongs to a
//!   run of the event loop. What is not decided at a glance, a low rebound, a stick, the end: the numbers
//!   are put back there, the loop does its work, and the lane goes on.
//! * **The same operations in the same order.** The parts of a stretch are the functions that the
//!   event loop uses as well. So a run has the same bits here, there, on every machine, and whatever runs
//!   beside it.
//!
//! A lane whose run has ended is given the next one.
//!
//! Free masses have lanes of a second kind, in plain doubles: the fast tier (`lanes/doubles.rs`). Their runs are the same
//! whatever runs beside them, but not those of the event loop to the last bit.

mod arrays;
mod counts;
mod decay;
mod doubles;
mod piva;
mod running;
mod siva;
mod watch;

use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::Invalid;
use crate::host::{Alone, DrivenHost, Host};
use crate::measures::{MeasureValues, Measures, Wanted};
use crate::observe::Observer;
use crate::piva::Piva;
use crate::simulate::{Instant, Limits, Run, Tally};
use crate::siva::Siva;
use crate::steady::{Steady, SteadyValues, SteadyWanted, Window};
use crate::system::System;
use crate::taylor::{ORDER, with_order};
use running::Running;

/// Runs side by side.
pub const LANES: usize = 8;
/// Fewer runs than this go one by one.
const WORTHWHILE: usize = 3;
/// A run to do.
#[derive(Debug, Clone)]
pub struct Job<S: SideBySide> {
    /// The absorber on its primary.
    pub system: S,
    /// The state at the begin.
    pub start: S::Start,
    /// The instant of that.
    pub begin: f64,
    /// How long, and where to stop.
    pub limits: Limits,
    /// What is measured of its steady state, if anything, and where.
    pub steady: Option<(SteadyWanted, Window)>,
    /// How accurate it is to be.
    pub tier: Tier,
}

/// How accurate a run is to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Tier {
    /// As accurate as doubles can tell.
    #[default]
    Exact,
    /// Less accurate by some rounding units: free masses in plain doubles (`lanes/doubles.rs`), pendulums in steps that
    /// leave out what their tolerance says.
    Fast,
}

impl Tier {
    /// The word in the tables.
    pub fn name(self) -> &'static str {
        match self {
            Tier::Exact => "exact",
            Tier::Fast => "fast",
        }
    }
}

/// What watches a run.
type Observers<S> = (Measures<S>, Option<Steady>);

/// How a run ended, its measures, and those of its steady state if they were asked for.
pub type Ended<S> = (Tally<<S as System>::State>, MeasureValues, Option<SteadyValues>);

/// An absorber whose runs can go side by side; as it stands here, they go one by one.
pub trait SideBySide: System<Real = f64> + Sized {
    /// What all lanes of a group have in common; `None`: this run is for the event loop, as those are that begin later
    /// than at time zero.
    fn common(_job: &Job<Self>) -> Option<[f64; 2]> {
        None
    }

    /// What runs of a group have in common in part: those that share it go after each other.
    fn shared(_job: &Job<Self>) -> f64 {
        0.0
    }

    /// The tier that a run is made by; where there is none faster, by the exact one.
    fn tier(_job: &Job<Self>) -> Tier {
        Tier::Exact
    }

    /// Runs a group of those that have something in common.
    fn run(group: Group<'_, Self>) {
        group.one_by_one();
    }
}

/// The tier of a free mass.
fn tier_of_free_mass<S: SideBySide>(job: &Job<S>) -> Tier {
    if S::common(job).is_some() { job.tier } else { Tier::Exact }
}

impl SideBySide for Siva {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let tier = if job.tier == Tier::Fast { 1.0 } else { 0.0 };
        let fits = job.steady.is_none() && job.begin == 0.0;
        (fits && job.system.common_law().is_some()).then(|| [job.system.damping_ratio(), tier])
    }

    fn tier(job: &Job<Self>) -> Tier {
        tier_of_free_mass(job)
    }

    fn run(group: Group<'_, Self>) {
        if group.tier() == Tier::Fast {
            return group.run::<doubles::Doubles<{ doubles::FREE }>>();
        }
        match (group.wanted.ledger, group.wanted.decay()) {
            (true, true) => group.run::<siva::FastFlights<true, true>>(),
            (false, true) => group.run::<siva::FastFlights<false, true>>(),
            (true, false) => group.run::<siva::FastFlights<true, false>>(),
            (false, false) => group.run::<siva::FastFlights<false, false>>(),
        }
    }
}

impl<H: Host<Real = f64>> SideBySide for Alone<H> {}

impl SideBySide for Siva<DrivenHost> {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let force = job.system.force()?;
        let wanted = job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let base = if force.moves_base() { 1.0 } else { 0.0 };
        // No strobes come out of lanes.
        let tier = if job.tier == Tier::Fast { 2.0 } else { 0.0 };
        let level = job.system.gravity() == 0.0 && job.system.common_law().is_some();
        (level && force.is_single() && !wanted.strobes && job.begin == 0.0)
            .then(|| [f64::from(wanted.bits()), base + tier])
    }

    fn shared(job: &Job<Self>) -> f64 {
        let harmonic = job.system.force().and_then(|force| force.harmonics().first());
        harmonic.map_or(0.0, |harmonic| harmonic.frequency)
    }

    fn tier(job: &Job<Self>) -> Tier {
        tier_of_free_mass(job)
    }

    fn run(group: Group<'_, Self>) {
        if group.tier() == Tier::Fast {
            if group.leader().moves_base() {
                group.run::<doubles::Doubles<{ doubles::BASE }>>();
            } else {
                group.run::<doubles::Doubles<{ doubles::FORCE }>>();
            }
        } else if group.leader().moves_base() {
            group.run::<siva::DrivenFastFlights<true>>();
        } else {
            group.run::<siva::DrivenFastFlights<false>>();
        }
    }
}

impl SideBySide for Piva {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let (Piva { pendulum, accuracy, .. }, force) = (&job.system, job.system.force());
        let damped = if pendulum.pivot_damping == 0.0 { 0.0 } else { 1.0 };
        let wanted = job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let driven = if force.is_none() { 0.0 } else { 2.0 + 2.0 * f64::from(wanted.bits()) };
        // No strobes come out of lanes.
        let fits = match force.is_none() {
            true => job.steady.is_none(),
            false => force.is_single() && !wanted.strobes,
        };
        let small = if pendulum.small_angles { 1000.0 } else { 0.0 };
        (fits && job.begin == 0.0 && job.system.has_common_law())
            .then_some([accuracy.tolerance, small + driven + damped])
    }

    fn tier(job: &Job<Self>) -> Tier {
        job.tier
    }

    fn run(group: Group<'_, Self>) {
        let Piva { pendulum, accuracy, .. } = group.leader();
        let (order, driven) = (accuracy.order, !group.leader().force().is_none());
        match (driven, pendulum.small_angles) {
            (false, false) => with_order!(order, N => group.run::<piva::Steps<N, false, false>>()),
            (true, false) => with_order!(order, N => group.run::<piva::Steps<N, true, false>>()),
            // At small angles the order is always the highest.
            (false, true) => group.run::<piva::Steps<ORDER, false, true>>(),
            (true, true) => group.run::<piva::Steps<ORDER, true, true>>(),
        }
    }
}

/// Lanes in which runs of one kind of absorber go in step.
trait Lockstep<S: SideBySide>: Sized {
    /// How many.
    const WIDTH: usize = LANES;
    /// What watches the run of a lane.
    type Observer: Watching<S>;
    /// Idle lanes for absorbers like that of a run, and the measures wanted.
    fn new(job: &Job<S>, wanted: Wanted) -> Self;
    /// Makes an absorber share the tables of the first of its group.
    fn join(_leader: &S, _system: &S) {}
    /// Goes one evaluation on in each lane; true if one needs its run.
    fn evaluate(&mut self) -> bool;
    /// True if this lane requests something of its run.
    fn requests(&self, lane: usize) -> bool;
    /// Serves what a lane has requested; false: its numbers are back in its run, and the event loop has to
    /// go on.
    fn serve(&mut self, lane: usize, run: &mut ScalarRun<'_, S, Self::Observer>) -> bool;
    /// Takes over a run, if it is where the lane can go on.
    fn take(&mut self, lane: usize, run: &mut ScalarRun<'_, S, Self::Observer>) -> bool;
    /// Puts the numbers of a lane back into its run.
    fn put_back(&mut self, lane: usize, run: &mut ScalarRun<'_, S, Self::Observer>);
    /// Leaves a lane without a run.
    fn idle(&mut self, lane: usize);
}

/// The run of a lane, which the event loop goes on with where the lane cannot.
type ScalarRun<'a, S, O = Observers<S>> = Run<'a, S, O>;

/// A run and its index among the jobs.
type IndexedRun<'a, S, O> = (usize, ScalarRun<'a, S, O>);

/// What watches a run and has its measures in the end.
trait Watching<S: SideBySide>: Observer<S> + Sized {
    /// For a run of which something is wanted; it may take over the memory of one that has ended.
    fn new(job: &Job<S>, wanted: Wanted, spare: Option<Self>) -> Self;
    /// What was measured.
    fn values(&self) -> (MeasureValues, Option<SteadyValues>);
}

impl<S: SideBySide> Watching<S> for Observers<S> {
    fn new(job: &Job<S>, wanted: Wanted, _spare: Option<Self>) -> Self {
        let steady = job.steady.map(|(wanted, window)| Steady::new(window, wanted));
        (Measures::new(wanted), steady)
    }

    fn values(&self) -> (MeasureValues, Option<SteadyValues>) {
        let (measures, steady) = self;
        (*measures.values(), steady.as_ref().map(|it| *it.values()))
    }
}

/// Does runs and hands each out with its index, in the order in which they end. Every one is what
/// [`simulate`](crate::simulate::simulate) with the same measures gives, bit for bit. Once cancelled, those begun come back as they are, the
/// others not.
///
/// # Errors
/// The first [`Invalid`] start or limits, before anything runs.
pub fn run<S: SideBySide>(
    jobs: &[Job<S>],
    wanted: Wanted,
    cancel: Option<&AtomicBool>,
    take: &mut dyn FnMut(usize, &Ended<S>),
) -> Result<(), Invalid> {
    for Job { system, start, limits, .. } in jobs {
        system.check_start(start)?;
        limits.check()?;
    }
    let common = |index: &usize| S::common(&jobs[*index]);
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    // What the loop runs comes first, as −∞.
    let key = |index: &usize| common(index).unwrap_or([-f64::INFINITY; 2]);
    order.sort_by(|x, y| {
        let ([a, b], [c, d]) = (key(x), key(y));
        let shared = |index: usize| S::shared(&jobs[index]);
        a.total_cmp(&c).then(b.total_cmp(&d)).then(shared(*x).total_cmp(&shared(*y)))
    });
    for same in order.chunk_by(|a, b| key(a) == key(b)) {
        let group = Group { jobs, order: same, next: 0, wanted, cancel, take };
        // A run of the fast tier goes in lanes even if it is alone: so it is the same whatever runs beside it.
        let few = same.len() < WORTHWHILE && group.tier() == Tier::Exact;
        if few || common(&same[0]).is_none() {
            group.one_by_one();
        } else {
            S::run(group);
        }
    }
    Ok(())
}

fn is_set(cancel: Option<&AtomicBool>) -> bool {
    cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
}

#[inline(always)]
fn pick(which: bool, yes: f64, no: f64) -> f64 {
    if which { yes } else { no }
}

/// Runs that have something in common.
pub struct Group<'a, S: SideBySide> {
    jobs: &'a [Job<S>],
    /// Which of them.
    order: &'a [usize],
    /// The first of these not begun.
    next: usize,
    wanted: Wanted,
    cancel: Option<&'a AtomicBool>,
    take: &'a mut dyn FnMut(usize, &Ended<S>),
}

impl<'a, S: SideBySide> Group<'a, S> {
    /// A run that has begun.
    fn begun<O: Watching<S>>(&self, index: usize, spare: Option<O>) -> ScalarRun<'a, S, O> {
        let job = &self.jobs[index];
        let Job { system, start, begin, limits, .. } = job;
        let observer = O::new(job, self.wanted, spare);
        let start = Instant::at(system, start, *begin);
        let mut run = Run::new(system, &start, limits, self.cancel, observer);
        run.begin();
        run
    }

    /// Hands out what a run came to.
    fn hand_out(&mut self, index: usize, tally: Tally<S::State>, observer: &impl Watching<S>) {
        let (measures, steady) = observer.values();
        (self.take)(index, &(tally, measures, steady));
    }

    fn one_by_one(mut self) {
        for index in self.order {
            if is_set(self.cancel) {
                break;
            }
            let mut run = self.begun::<Observers<S>>(*index, None);
            while run.step() {}
            let tally = run.finish();
            self.hand_out(*index, tally, &run.observer);
        }
    }

    /// The absorber of the first run.
    fn leader(&self) -> &S {
        &self.jobs[self.order[0]].system
    }

    fn tier(&self) -> Tier {
        self.jobs[self.order[0]].tier
    }

    fn run<L: Lockstep<S>>(self) {
        Running::<S, L>::new(self).run();
    }
}
