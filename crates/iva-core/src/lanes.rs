//! Runs of many absorbers of one kind, side by side: free decays, and free masses under one harmonic force.
//!
//! One run spends its time waiting: each number of a stretch of motion needs the one before. Here [`LANES`]
//! runs go in step, each in its lane, and every operation is done for all of them by the vector
//! instructions of the machine. Three things make that possible:
//!
//! * **A stretch has no branches.** The strides of a free mass (`lanes/siva.rs`) and the steps of a pendulum
//!   (`lanes/piva.rs`) are the code of one lane, written for one number; a loop over
//!   arrays of numbers becomes vector code by itself, for AVX-512, AVX2 or the baseline, whichever the
//!   machine has. Each lane does all that any may need, and picks.
//! * **What is not simple goes to the event loop.** Each lane is at home in a
//!   run of the event loop. What is not decided at a glance, a low rebound, a stick, the end: the numbers
//!   are put back there, the loop does its work, and the lane goes on.
//! * **The same operations in the same order.** The parts of a stretch are the functions that the
//!   event loop uses as well. So a run has the same bits here, there, on every machine, and whatever runs
//!   beside it.
//!
//! A lane whose run has ended is given the next one.

mod arrays;
mod piva;
mod siva;
mod watch;

use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::Invalid;
use crate::host::DrivenHost;
use crate::measures::{MeasureValues, Measures, Wanted};
use crate::observe::Observer;
use crate::piva::Piva;
use crate::real::Real;
use crate::simulate::{Limits, Run, Tally, simulate};
use crate::siva::Siva;
use crate::steady::{Steady, SteadyValues, SteadyWanted, Window};
use crate::system::System;
use crate::taylor::with_order;

/// Runs side by side.
pub const LANES: usize = 8;
/// Fewer runs than this go one by one.
const WORTHWHILE: usize = 3;
/// Evaluations between two looks whether to stop.
const CANCEL_EVERY: u64 = 1024;

/// A run to do.
#[derive(Debug, Clone)]
pub struct Job<S: SideBySide> {
    /// The absorber on its primary.
    pub system: S,
    /// The state at time zero.
    pub start: S::Start,
    /// How long, and where to stop.
    pub limits: Limits,
    /// What is measured, beside what a decay is measured by.
    pub also: S::Also,
}

/// What came of it.
pub type Ended<S> = (Tally<<S as System>::State>, <S as SideBySide>::Values);

/// An absorber whose runs can go side by side.
pub trait SideBySide: System<Real = f64> + Sized {
    /// What its runs are measured by.
    type Watch: Observer<Self>;
    /// What that comes to.
    type Values: Clone + std::fmt::Debug;
    /// What is measured beside the measures of a decay.
    type Also: Copy + std::fmt::Debug;

    /// Measures a run.
    fn watch(wanted: Wanted, also: Self::Also) -> Self::Watch;
    /// What was measured.
    fn values(watch: &Self::Watch) -> Self::Values;
    /// What all lanes of a group have in common; `None`: this one is for the event loop.
    fn common(&self) -> Option<[f64; 2]>;
    /// Runs a group.
    fn run(group: Group<'_, Self>);
}

impl SideBySide for Siva {
    type Watch = Measures<Self>;
    type Values = MeasureValues;
    type Also = ();

    fn watch(wanted: Wanted, _also: ()) -> Measures<Self> {
        Measures::new(wanted)
    }

    fn values(watch: &Measures<Self>) -> MeasureValues {
        *watch.values()
    }

    fn common(&self) -> Option<[f64; 2]> {
        Some([self.damping_ratio(), 0.0])
    }

    fn run(group: Group<'_, Self>) {
        if group.wanted.ledger {
            group.run::<siva::Strides<true>>();
        } else {
            group.run::<siva::Strides<false>>();
        }
    }
}

impl SideBySide for Siva<DrivenHost> {
    type Watch = (Measures<Self>, Steady);
    type Values = (MeasureValues, SteadyValues);
    type Also = (SteadyWanted, Window);

    fn watch(wanted: Wanted, (steady, window): Self::Also) -> Self::Watch {
        (Measures::new(wanted), Steady::new(window, steady))
    }

    fn values((measures, steady): &Self::Watch) -> Self::Values {
        (*measures.values(), *steady.values())
    }

    fn common(&self) -> Option<[f64; 2]> {
        let force = self.force().filter(|force| force.is_single() && !force.moves_base());
        force.map(|_| [0.0; 2])
    }

    fn run(group: Group<'_, Self>) {
        group.run::<siva::DrivenStrides>();
    }
}

impl SideBySide for Piva {
    type Watch = Measures<Self>;
    type Values = MeasureValues;
    type Also = ();

    fn watch(wanted: Wanted, _also: ()) -> Measures<Self> {
        Measures::new(wanted)
    }

    fn values(watch: &Measures<Self>) -> MeasureValues {
        *watch.values()
    }

    fn common(&self) -> Option<[f64; 2]> {
        let alone = self.pendulum.small_angles || !self.force().is_none();
        let damped = if self.pendulum.pivot_damping == 0.0 { 0.0 } else { 1.0 };
        (!alone).then_some([self.accuracy.tolerance, damped])
    }

    fn run(group: Group<'_, Self>) {
        with_order!(group.leader().accuracy.order, N => group.run::<piva::Steps<N>>());
    }
}

/// Lanes in which runs of one kind of absorber go in step.
trait Lockstep<S: SideBySide>: Sized {
    /// Idle lanes for absorbers like that of a run, and the measures wanted.
    fn new(job: &Job<S>, wanted: Wanted) -> Self;
    /// Gives an absorber what those of the other lanes have as well.
    fn join(&self, _system: &S) {}
    /// Goes one evaluation on in each lane; true if one calls for its run.
    fn evaluate(&mut self) -> bool;
    /// True if this lane has called.
    fn calls(&self, lane: usize) -> bool;
    /// Does what a lane has called for; false: its numbers are back in its run, and the event loop has to
    /// go on.
    fn attend(&mut self, lane: usize, run: &mut Home<'_, S>) -> bool;
    /// Takes over a run, if it is where the lane can go on.
    fn take(&mut self, lane: usize, run: &Home<'_, S>) -> bool;
    /// Puts the numbers of a lane back into its run.
    fn put_back(&self, lane: usize, run: &mut Home<'_, S>);
    /// Leaves a lane without a run.
    fn idle(&mut self, lane: usize);
}

/// A run that a lane is at home in.
type Home<'a, S> = Run<'a, S, <S as SideBySide>::Watch>;

/// Does runs and hands each out with its index, in the order in which they end. Every one is what
/// [`simulate`] with [`SideBySide::Watch`] gives, bit for bit. Once cancelled, those begun come back as they are, the
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
    let common = |index: &usize| jobs[*index].system.common();
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    // What the loop runs comes first, as −∞.
    let key = |index: &usize| common(index).unwrap_or([-f64::INFINITY; 2]);
    order.sort_by(|a, b| {
        let ([a, b], [c, d]) = (key(a), key(b));
        a.total_cmp(&c).then(b.total_cmp(&d))
    });
    for same in order.chunk_by(|a, b| key(a) == key(b)) {
        if same.len() < WORTHWHILE || common(&same[0]).is_none() {
            one_by_one(jobs, same, wanted, cancel, take)?;
        } else {
            let homes = [const { None }; LANES];
            S::run(Group { jobs, order: same, next: 0, wanted, cancel, homes, live: 0, take });
        }
    }
    Ok(())
}

fn one_by_one<S: SideBySide>(
    jobs: &[Job<S>],
    order: &[usize],
    wanted: Wanted,
    cancel: Option<&AtomicBool>,
    take: &mut dyn FnMut(usize, &Ended<S>),
) -> Result<(), Invalid> {
    for index in order {
        if is_set(cancel) {
            break;
        }
        let Job { system, start, limits, also } = &jobs[*index];
        let mut watch = S::watch(wanted, *also);
        let tally = simulate(system, start, limits, cancel, &mut watch)?;
        take(*index, &(tally, S::values(&watch)));
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
    /// The run of each lane, and its index.
    homes: [Option<(usize, Home<'a, S>)>; LANES],
    /// Lanes at work.
    live: usize,
    take: &'a mut dyn FnMut(usize, &Ended<S>),
}

impl<S: SideBySide> Group<'_, S> {
    /// The absorber of the first run.
    fn leader(&self) -> &S {
        &self.jobs[self.order[0]].system
    }

    fn run<L: Lockstep<S>>(mut self) {
        f64::dispatched(
            #[inline(always)]
            || {
                // In the very function that is vectorised: so the compiler aligns its stack to the
                // arrays, and with it what it has no registers for.
                let mut lanes = L::new(&self.jobs[self.order[0]], self.wanted);
                for i in 0..LANES {
                    self.refill(&mut lanes, i);
                }
                while self.live > 0 {
                    for _ in 0..CANCEL_EVERY {
                        if lanes.evaluate() {
                            self.attend(&mut lanes);
                            if self.live == 0 {
                                break;
                            }
                        }
                    }
                    if is_set(self.cancel) {
                        self.cancel(&mut lanes);
                    }
                }
            },
        );
    }

    /// Does what lanes have called for.
    #[inline(never)]
    fn attend<L: Lockstep<S>>(&mut self, lanes: &mut L) {
        for i in 0..LANES {
            let Some((_, home)) = &mut self.homes[i] else { continue };
            if lanes.calls(i) && !lanes.attend(i, home) {
                self.go_on(lanes, i);
            }
        }
    }

    /// Lets the event loop go on until the lane can, or the run ends.
    fn go_on<L: Lockstep<S>>(&mut self, lanes: &mut L, i: usize) {
        let Some((index, home)) = &mut self.homes[i] else { return };
        while home.step() {
            if lanes.take(i, home) {
                return;
            }
        }
        let tally = home.finish();
        (self.take)(*index, &(tally, S::values(&home.observer)));
        self.homes[i] = None;
        self.live -= 1;
        self.refill(lanes, i);
    }

    /// Gives a lane the next run, if there is one.
    #[inline(never)]
    fn refill<L: Lockstep<S>>(&mut self, lanes: &mut L, i: usize) {
        let index = match self.order.get(self.next) {
            Some(index) if !is_set(self.cancel) => *index,
            _ => return lanes.idle(i),
        };
        let Job { system, start, limits, also } = &self.jobs[index];
        self.next += 1;
        lanes.join(system);
        let watch = S::watch(self.wanted, *also);
        let mut run = Run::new(system, start, limits, self.cancel, watch);
        run.begin();
        self.homes[i] = Some((index, run));
        self.live += 1;
        self.go_on(lanes, i);
    }

    /// Ends every run where it is; those not begun stay so.
    fn cancel<L: Lockstep<S>>(&mut self, lanes: &mut L) {
        self.next = self.order.len();
        for i in 0..LANES {
            if let Some((index, home)) = &mut self.homes[i] {
                lanes.put_back(i, home);
                let tally = home.cancelled();
                (self.take)(*index, &(tally, S::values(&home.observer)));
                self.homes[i] = None;
                self.live -= 1;
                lanes.idle(i);
            }
        }
    }
}
