//! Runs of many absorbers of one kind, side by side in the lanes of vector instructions: free decays, and
//! runs under one harmonic force or harmonic base motion.
//!
//! A single run is bound by latency: each number of a stretch of motion depends on the one before. Here
//! [`LANES`] runs advance in lockstep, one per lane, and every operation is done for all of them by vector
//! instructions. Three things make that possible:
//!
//! * **A stretch has no branches.** The trials of a free mass (`run/free_mass.rs`) and the steps of a
//!   pendulum (`run/piva.rs`) are written for one lane and one number type. The compiler turns a loop over
//!   arrays of lanes into vector code, for AVX-512 where the machine has it (`number/vectors.rs`). Every lane
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

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::absorber::OnStructure;
use crate::engine::observe::Events;
use crate::engine::simulate::{Limits, OfAbsorber, Run, Tally};
use crate::error::Invalid;
use crate::measures::extremes::{ExtremeValues, Extremes};
use crate::measures::pass::{Pass, Passes};
use crate::measures::peaks::Peak;
use crate::measures::propagation::{Errors, Estimated};
use crate::measures::steady::{SteadyValues, SteadyWanted, Strobe, Window};
use crate::measures::summary::Summary;
use crate::measures::{MeasureValues, Wanted};
use crate::run::group::grouped;

pub(crate) use crate::run::cycling::Cycling;
pub(crate) use crate::run::free_mass::Loaded;
pub use crate::run::group::Group;
pub(crate) use crate::run::kinds::with_steps;
pub(crate) use crate::run::logged::Logged;

/// Number of runs side by side.
pub const LANES: usize = 8;
/// Number of free masses side by side in free decay and in the fast tier: enough to hide the latency of operations
/// on a processor with wide vectors.
pub(crate) const WIDE: usize = 16;

/// A run to be made.
#[derive(Debug, Clone)]
pub struct Job<S: SideBySide> {
    /// The absorber on its primary structure.
    pub system: S,
    /// The state at the begin.
    pub start: S::Start,
    /// The instant at which the run begins, in 1/ωn.
    pub begin: f64,
    /// The limits of the run; `limits.duration` is the instant at which it ends, not its length.
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
    /// Less accurate by some rounding units: free masses in plain doubles (`run/free_mass.rs`), pendulums
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
pub type Ended<S> = (Tally<<S as OnStructure>::State>, MeasureValues, Option<SteadyValues>);

/// An absorber whose runs can go side by side. By default they go one by one.
pub trait SideBySide: Estimated + Sized {
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
        wanted: (Wanted, &Listing),
        cancel: Option<&AtomicBool>,
        take: TakeListed<'_, Self>,
    ) -> Result<(), Invalid> {
        grouped(jobs, wanted, cancel, take)
    }
}

/// Makes a pass over a run.
pub type NewPass = fn() -> Box<dyn Pass<f64>>;

/// What is wanted of a run beside its measures.
#[derive(Debug, Clone, Default)]
pub struct Listing {
    /// Its impacts and stick episodes.
    pub events: bool,
    /// The estimated errors of its impacts.
    pub errors: bool,
    /// The peaks of its displacement.
    pub envelope: bool,
    /// Its extremes: in the window of the steady state, if there is one.
    pub extremes: bool,
    /// Passes over it, in the same window.
    pub passes: Vec<NewPass>,
}

impl Listing {
    /// True if nothing is wanted.
    pub fn is_empty(&self) -> bool {
        let Self { events, errors, envelope, .. } = *self;
        !(events || errors || envelope || self.looks())
    }

    /// True if observers look within its flights.
    pub(crate) fn looks(&self) -> bool {
        self.extremes || !self.passes.is_empty()
    }
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
    /// Its extremes for each absorber; none where they were not wanted, or the run does not define them.
    pub extremes: Vec<ExtremeValues>,
    /// The values of the passes; `None` where the run does not define them.
    pub passes: Vec<Option<f64>>,
    /// What it has come to for each of several absorbers.
    pub absorbers: Vec<OfAbsorber>,
}

/// The receiver of results: the index of a job, and its result.
pub type Take<'a, S> = &'a mut dyn FnMut(usize, &Ended<S>);

/// The receiver of results with what is listed of the run.
pub type TakeListed<'a, S> = &'a mut dyn FnMut(usize, &Ended<S>, Listed);

/// A set of lanes in which runs of one kind of absorber advance in lockstep.
pub(crate) trait Lockstep<S: SideBySide>: Sized {
    /// Number of lanes.
    const WIDTH: usize = LANES;
    /// A set of idle lanes for absorbers like that of a job, and what is wanted of the runs.
    fn new(job: &Job<S>, wanted: Wanted, listing: &Listing) -> Self;
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

/// The observer of the run of a lane: its measures, and beside them what is listed of it.
pub(crate) type Watch<S> = Box<Summary<S, (Told, Looks)>>;

/// The lists of events and of estimated errors, if they are asked for.
pub(crate) type Told = (Option<Events>, Option<Box<Errors>>);

/// The extremes, if they are asked for, and the passes: they look within the flights of a run.
pub(crate) type Looks = (Option<Extremes>, Passes<f64>);

/// A run and its index among the jobs.
pub(super) type IndexedRun<'a, S> = (usize, ScalarRun<'a, S>);

/// Makes runs and hands out each result with the index of its job, in the order in which they end. In the
/// exact tier every result is bit for bit that of [`simulate`](crate::engine::simulate::simulate) with the same
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
    S::run_jobs(jobs, (wanted, &nothing), cancel, &mut |index, ended, _| take(index, ended))
}

/// As [`run`], and hands out more of each run. The errors are those of the tier of the run.
///
/// # Errors
/// As [`run`].
pub fn run_listed<S: SideBySide>(
    jobs: &[Job<S>],
    wanted: (Wanted, &Listing),
    cancel: Option<&AtomicBool>,
    take: TakeListed<'_, S>,
) -> Result<(), Invalid> {
    S::run_jobs(jobs, wanted, cancel, take)
}

/// Counts one more of what is done, for who watches.
pub(crate) fn one_more(done: Option<&AtomicU64>) {
    if let Some(done) = done {
        done.fetch_add(1, Ordering::Relaxed);
    }
}

pub(crate) fn is_set(cancel: Option<&AtomicBool>) -> bool {
    cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
}
