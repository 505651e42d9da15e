//! Runs of many absorbers of one kind, side by side in the lanes of vector instructions: free decays, and
//! runs under one harmonic force or harmonic base motion.
//!
//! A single run is bound by latency: each number of a stretch of motion depends on the one before. Here
//! [`LANES`] runs advance in lockstep, one per lane, and every operation is done for all of them by vector
//! instructions. Three things make that possible:
//!
//! * **A stretch has no branches.** The trials of a free mass (`lanes/free_mass.rs`) and the steps of a
//!   pendulum (`lanes/piva.rs`) are written for one lane and one number type. The compiler turns a loop over
//!   arrays of lanes into vector code for AVX-512, AVX2 or the baseline, chosen at run time. Every lane
//!   computes all cases and selects its own.
//! * **What is not simple goes to the event loop.** Each lane belongs to a run of the event loop. Where a
//!   stretch is not decided without a search, at a low rebound, at a stick episode and at the end, the lane
//!   writes its variables back to the run, the event loop goes on, and the lane takes over again afterwards.
//! * **The same operations in the same order.** A stretch is computed by the same functions as in the event
//!   loop. So a run has the same bits in a lane and in the event loop, on every machine, and whatever runs in
//!   other lanes.
//!
//! A lane whose run has ended is given the next one.
//!
//! In the fast tier the lanes of free masses hold plain doubles. Their results do not depend on the other lanes
//! either, but differ from those of the event loop in the last bits.

mod decays;
mod forced;
pub(crate) mod free_mass;
mod logged;
pub(crate) mod piva;
mod running;

use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::Invalid;
use crate::host::{Alone, DrivenHost, UndrivenHost};
use crate::measures::forced::Forced;
use crate::measures::{MeasureValues, Wanted};
use crate::observe::Events;
use crate::peaks::Peak;
use crate::piva::Piva;
use crate::plain::{BASE, FORCE};
use crate::propagation::{Differentiable, Errors, Tangent};
use crate::real::pick;
use crate::simulate::{Instant, Limits, Run, Tally};
use crate::siva::Siva;
use crate::steady::{Steady, SteadyValues, SteadyWanted, Strobe, Window};
use crate::summary::Summary;
use crate::system::System;
use decays::Decays;
use forced::ForcedRuns;
pub(crate) use free_mass::Loaded;
pub(crate) use logged::Logged;

use free_mass::{ExactDecays, ExactDriven, FastDecays, FastDriven};
use running::Running;

/// Number of runs side by side.
pub const LANES: usize = 8;
/// Number of free masses side by side, where their rounds are in stages: enough to hide the latency of operations
/// on a processor with wide vectors.
pub(crate) const WIDE: usize = 16;
/// Groups of fewer runs than this go one by one.
const WORTHWHILE: usize = 3;
/// A run to be made.
#[derive(Debug, Clone)]
pub struct Job<S: SideBySide> {
    /// The absorber on its primary structure.
    pub system: S,
    /// The state at the begin.
    pub start: S::Start,
    /// The instant at which the run begins, in 1/ωn.
    pub begin: f64,
    /// The length of the run, and its limits.
    pub limits: Limits,
    /// The measures of the steady state that are wanted, and the window that they are taken in.
    pub steady: Option<(SteadyWanted, Window)>,
    /// The accuracy tier of the run.
    pub tier: Tier,
}

/// The accuracy tier of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Tier {
    /// Full accuracy: states in double-double where that matters.
    #[default]
    Exact,
    /// Less accurate by some rounding units: free masses in plain doubles (`lanes/free_mass.rs`), pendulums
    /// with steps of a larger tolerance.
    Fast,
}

impl Tier {
    /// The name in the tables.
    pub fn name(self) -> &'static str {
        match self {
            Tier::Exact => "exact",
            Tier::Fast => "fast",
        }
    }
}

/// The result of a run: how it ended, its measures, and those of its steady state if they were asked for.
pub type Ended<S> = (Tally<<S as System>::State>, MeasureValues, Option<SteadyValues>);

/// An absorber whose runs can go side by side. By default they go one by one.
pub trait SideBySide: Differentiable + Sized {
    /// The key of a job: jobs with equal keys form a group whose lanes run side by side. `None`: the job is
    /// run by the event loop.
    fn common(_job: &Job<Self>) -> Option<[f64; 2]> {
        None
    }

    /// A number by which the jobs of a group are sorted, so that jobs that can share tables follow each
    /// other.
    fn shared(_job: &Job<Self>) -> f64 {
        0.0
    }

    /// The tier by which a job is run: the exact one where the absorber has no faster one.
    fn tier(_job: &Job<Self>) -> Tier {
        Tier::Exact
    }

    /// Runs a group of jobs with equal keys.
    fn run(group: Group<'_, Self>) {
        group.one_by_one();
    }

    /// [`run`] and [`run_listed`] for this absorber. The absorbers of this crate implement it with the same body,
    /// so that it is compiled once and here, where the compiler sees all that it calls.
    ///
    /// # Errors
    /// As [`run`].
    fn run_jobs(
        jobs: &[Job<Self>],
        wanted: (Wanted, Listing),
        cancel: Option<&AtomicBool>,
        take: TakeListed<'_, Self>,
    ) -> Result<(), Invalid> {
        grouped(jobs, wanted, cancel, take)
    }
}

/// What is wanted of a run beside its measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Listing {
    /// Its impacts and stick episodes.
    pub events: bool,
    /// The estimated errors of its impacts.
    pub errors: bool,
    /// The peaks of its displacement.
    pub envelope: bool,
}

/// What was wanted of a run beside its measures.
#[derive(Debug, Clone, Default)]
pub struct Listed {
    /// Its impacts and stick episodes.
    pub events: Option<Events>,
    /// The estimated errors of its impacts.
    pub errors: Option<Box<Errors>>,
    /// The peaks of its displacement.
    pub envelope: Option<Vec<Peak>>,
    /// All strobes of its steady state, if those were wanted.
    pub strobes: Option<Vec<Strobe>>,
}

/// The receiver of results: the index of a job, and its result.
pub type Take<'a, S> = &'a mut dyn FnMut(usize, &Ended<S>);

/// The receiver of results with what is listed of the run.
pub type TakeListed<'a, S> = &'a mut dyn FnMut(usize, &Ended<S>, Listed);

/// [`SideBySide::run_jobs`] compiled in this crate.
macro_rules! run_jobs {
    () => {
        fn run_jobs(
            jobs: &[Job<Self>],
            wanted: (Wanted, Listing),
            cancel: Option<&AtomicBool>,
            take: TakeListed<'_, Self>,
        ) -> Result<(), Invalid> {
            grouped(jobs, wanted, cancel, take)
        }
    };
}

/// Runs code with the kind of lanes for pendulums like this one.
macro_rules! with_steps {
    ($piva:expr, $lanes:ident => $body:expr) => {{
        use $crate::lanes::piva::Steps;
        use $crate::taylor::{ORDER, with_order};
        let piva: &$crate::piva::Piva = $piva;
        let (order, driven) = (piva.accuracy.order, !piva.force().is_none());
        // At small angles the order is always the highest.
        match (driven, piva.pendulum.small_angles) {
            (false, false) => with_order!(order, N => {
                type $lanes = Steps<N, false, false>;
                $body
            }),
            (true, false) => with_order!(order, N => {
                type $lanes = Steps<N, true, false>;
                $body
            }),
            (false, true) => {
                type $lanes = Steps<ORDER, false, true>;
                $body
            }
            (true, true) => {
                type $lanes = Steps<ORDER, true, true>;
                $body
            }
        }
    }};
}
pub(crate) use with_steps;

/// True if a run is a free decay that lanes can make: they compute no measures but log the motion.
fn decays(job: &Job<Siva>) -> bool {
    job.system.sinusoidal().is_some() && job.steady.is_none()
}

impl SideBySide for Siva {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let tier = if Self::tier(job) == Tier::Fast { 1.0 } else { 0.0 };
        decays(job).then(|| [job.system.damping_ratio(), tier])
    }

    fn tier(job: &Job<Self>) -> Tier {
        if decays(job) { job.tier } else { Tier::Exact }
    }

    run_jobs!();

    fn run(group: Group<'_, Self>) {
        match group.tier() {
            Tier::Fast => group.run::<Decays<FastDecays, WIDE>>(),
            Tier::Exact => group.run::<Decays<ExactDecays, WIDE>>(),
        }
    }
}

impl SideBySide for Alone<UndrivenHost> {
    run_jobs!();
}

impl SideBySide for Alone<DrivenHost> {
    run_jobs!();
}

impl SideBySide for Siva<DrivenHost> {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let force = job.system.force()?;
        let wanted = job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let base = if force.moves_base() { 1.0 } else { 0.0 };
        let tier = if job.tier == Tier::Fast { 2.0 } else { 0.0 };
        let level = job.system.gravity() == 0.0;
        (level && force.is_single()).then(|| [f64::from(wanted.bits()), base + tier])
    }

    fn shared(job: &Job<Self>) -> f64 {
        let harmonic = job.system.force().and_then(|force| force.harmonics().first());
        harmonic.map_or(0.0, |harmonic| harmonic.frequency)
    }

    fn tier(job: &Job<Self>) -> Tier {
        if Self::common(job).is_some() { job.tier } else { Tier::Exact }
    }

    run_jobs!();

    fn run(group: Group<'_, Self>) {
        if group.tier() == Tier::Fast {
            if group.leader().moves_base() {
                group.run::<ForcedRuns<FastDriven<BASE, WIDE>, WIDE>>();
            } else {
                group.run::<ForcedRuns<FastDriven<FORCE, WIDE>, WIDE>>();
            }
        } else if group.leader().moves_base() {
            group.run::<ForcedRuns<ExactDriven<true, LANES>, LANES>>();
        } else {
            group.run::<ForcedRuns<ExactDriven<false, LANES>, LANES>>();
        }
    }
}

impl SideBySide for Piva {
    fn common(job: &Job<Self>) -> Option<[f64; 2]> {
        let (Piva { pendulum, accuracy, .. }, force) = (&job.system, job.system.force());
        let damped = if pendulum.pivot_damping == 0.0 { 0.0 } else { 1.0 };
        let wanted = job.steady.map_or_else(SteadyWanted::default, |(wanted, _)| wanted);
        let driven = if force.is_none() { 0.0 } else { 2.0 + 2.0 * f64::from(wanted.bits()) };
        // Lanes record no strobes.
        let fits = match force.is_none() {
            true => job.steady.is_none(),
            false => force.is_single() && !wanted.strobes,
        };
        let small = if pendulum.small_angles { 1000.0 } else { 0.0 };
        fits.then_some([accuracy.tolerance, small + driven + damped])
    }

    fn tier(job: &Job<Self>) -> Tier {
        job.tier
    }

    run_jobs!();

    fn run(group: Group<'_, Self>) {
        with_steps!(group.leader(), L => group.run::<L>());
    }
}

/// A set of lanes in which trajectories go from cycle to cycle ([`crate::orbit`]). A lane takes a run over, and can repeat
/// it from another state.
pub(crate) trait Cycling<S: System<Real = f64>>: Sized {
    /// Number of lanes.
    const WIDTH: usize;
    /// Idle lanes for absorbers like this one.
    fn cycling(leader: &S) -> Self;
    /// Advances each lane by one evaluation; true if a lane needs something of its run.
    fn evaluate(&mut self) -> bool;
    /// True if this lane does.
    fn requests(&self, i: usize) -> bool;
    /// True if it has come to the end of its run and needs nothing else.
    fn is_at_end(&self, i: usize) -> bool;
    /// Its state, for who needs no derivatives of the force; the number of impacts of its run so far.
    fn shown(&self, i: usize, system: &S) -> S::State;
    fn impacts(&self, i: usize) -> u64;
    /// Keeps the impacts of a lane from now on, and hands those so far to a derivative.
    fn listen(&mut self, i: usize);
    fn follow(&mut self, i: usize, system: &S, tangent: &mut Tangent);
    /// Loads a run into a lane; false if the event loop has to go on with it.
    fn take_cycle<O>(&mut self, i: usize, run: &Run<'_, S, O>, forced: Option<&Forced>) -> bool;
    /// Writes the variables of a lane back into its run.
    fn put_back_cycle<O>(&mut self, i: usize, run: &mut Run<'_, S, O>);
    /// Lets a lane make its run once more from another state; false if that is left to the event loop.
    fn repeat(&mut self, i: usize, from: &Loaded<'_, S>) -> bool;
    /// Makes a lane idle.
    fn rest(&mut self, i: usize);
}

/// A set of lanes in which runs of one kind of absorber advance in lockstep.
pub(crate) trait Lockstep<S: SideBySide>: Sized {
    /// Number of lanes.
    const WIDTH: usize = LANES;
    /// A set of idle lanes for absorbers like that of a job, and what is wanted of the runs.
    fn new(job: &Job<S>, wanted: Wanted, listing: Listing) -> Self;
    /// Makes an absorber share the tables of the first one of its group.
    fn join(_leader: &S, _system: &S) {}
    /// Advances each lane by one evaluation; true if a lane needs its run.
    fn evaluate(&mut self) -> bool;
    /// True if this lane needs something of its run.
    fn requests(&self, lane: usize) -> bool;
    /// Serves the request of a lane; false: its variables are back in its run, and the event loop has to go
    /// on.
    fn serve(&mut self, lane: usize, run: &mut ScalarRun<'_, S>) -> bool;
    /// Loads a run into a lane; false if the run is not at a state from which the lane can go on.
    fn take(&mut self, lane: usize, run: &mut ScalarRun<'_, S>) -> bool;
    /// Writes the variables of a lane back into its run.
    fn put_back(&mut self, lane: usize, run: &mut ScalarRun<'_, S>);
    /// Makes a lane idle.
    fn idle(&mut self, lane: usize);
}

/// The run of a lane in the event loop, which goes on where the lane cannot.
pub(crate) type ScalarRun<'a, S> = Run<'a, S, Watch<S>>;

/// The observer of such a run.
pub(crate) type Watch<S> = Box<Summary<S, (Option<Events>, Option<Box<Errors>>)>>;

/// A run and its index among the jobs.
type IndexedRun<'a, S> = (usize, ScalarRun<'a, S>);

/// Makes runs and hands out each result with the index of its job, in the order in which they end. In the
/// exact tier every result is bit for bit that of [`simulate`](crate::simulate::simulate) with the same
/// measures. Once cancelled, runs that have begun are handed out as they are, the others not at all.
///
/// # Errors
/// The first [`Invalid`] start or limits, before anything runs.
pub fn run<S: SideBySide>(
    jobs: &[Job<S>],
    wanted: Wanted,
    cancel: Option<&AtomicBool>,
    take: Take<'_, S>,
) -> Result<(), Invalid> {
    let nothing = Listing::default();
    S::run_jobs(jobs, (wanted, nothing), cancel, &mut |index, ended, _| take(index, ended))
}

/// As [`run`], and hands out more of each run. The errors are those of the tier of the run.
///
/// # Errors
/// As [`run`].
pub fn run_listed<S: SideBySide>(
    jobs: &[Job<S>],
    wanted: (Wanted, Listing),
    cancel: Option<&AtomicBool>,
    take: TakeListed<'_, S>,
) -> Result<(), Invalid> {
    S::run_jobs(jobs, wanted, cancel, take)
}

fn grouped<S: SideBySide>(
    jobs: &[Job<S>],
    (wanted, listing): (Wanted, Listing),
    cancel: Option<&AtomicBool>,
    take: TakeListed<'_, S>,
) -> Result<(), Invalid> {
    let wanted = Wanted { envelope: listing.envelope, ..wanted };
    for Job { system, start, limits, .. } in jobs {
        system.check_start(start)?;
        limits.check()?;
    }
    // The peaks of a run under a lasting force are found in the event loop.
    let lists = |system: &S| !(listing.envelope && system.is_driven());
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

pub(crate) fn is_set(cancel: Option<&AtomicBool>) -> bool {
    cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
}

/// A group of jobs with equal keys.
pub struct Group<'a, S: SideBySide> {
    jobs: &'a [Job<S>],
    /// The indices of its jobs.
    order: &'a [usize],
    /// The position in `order` of the first job that has not begun.
    next: usize,
    wanted: Wanted,
    listing: Listing,
    cancel: Option<&'a AtomicBool>,
    take: TakeListed<'a, S>,
}

impl<'a, S: SideBySide> Group<'a, S> {
    /// The run of a job, begun.
    fn begun(&self, index: usize, spare: Option<Watch<S>>) -> ScalarRun<'a, S> {
        let job = &self.jobs[index];
        let Job { system, start, begin, limits, steady, .. } = job;
        let Listing { events, errors, .. } = self.listing;
        // In the fast tier states of free masses are plain doubles; those of pendulums are as in the exact tier.
        let plain = S::LINEAR && S::tier(job) == Tier::Fast;
        let estimate = || if plain { Errors::in_doubles() } else { Errors::default() };
        let listed = (events.then(Events::default), errors.then(|| Box::new(estimate())));
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
    fn hand_out(&mut self, index: usize, tally: Tally<S::State>, summary: &mut Watch<S>) {
        let steady = summary.steady_values().copied();
        let (events, errors) = std::mem::take(&mut summary.beside);
        let envelope = summary.measures.take_envelope();
        let strobes = summary.steady().and_then(Steady::all_strobes);
        let listed = Listed { events, errors, envelope, strobes };
        (self.take)(index, &(tally, *summary.values(), steady), listed);
    }

    fn one_by_one(mut self) {
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
    fn leader(&self) -> &S {
        &self.jobs[self.order[0]].system
    }

    fn tier(&self) -> Tier {
        S::tier(&self.jobs[self.order[0]])
    }

    pub(crate) fn run<L: Lockstep<S>>(self) {
        Running::new(self).run::<L>();
    }
}
