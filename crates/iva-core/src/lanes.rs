//! Free decays of many single-mass absorbers, side by side.
//!
//! One run spends its time waiting: each number of a stride needs the one before. Here [`LANES`] runs go
//! in step, each in its lane, and every operation is done for all of them by the vector instructions of
//! the machine. Three things make that possible:
//!
//! * **A stride has no branches.** [`step`] is the code of one lane, written for one number; a loop over
//!   arrays of numbers becomes vector code by itself, for AVX-512, AVX2 or the baseline, whichever the
//!   machine has. Lanes are at different places of their runs: one searches a stretch as a whole,
//!   another evaluates close to a contact. Each does all, and picks what it needs.
//! * **What is not simple goes to the event loop.** Each lane is at home in a
//!   [`Run`](crate::simulate::Run). A stretch that is no stride, a low rebound, a
//!   stick, the end: the numbers are put back there, the loop does its work, and the lane goes on.
//! * **The same operations in the same order.** The parts of a stride are the functions that the
//!   event loop uses as well. So a run has the same bits here, there, on every machine, and whatever runs
//!   beside it.
//!
//! A lane whose run has ended is given the next one.

mod lane;
mod step;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::Invalid;
use crate::measures::{MeasureValues, Measures, Wanted};
use crate::oscillator::Oscillator;
use crate::real::{TURN, dispatched};
use crate::simulate::{Limits, Phase, Run, STOPS, Tally, simulate};
use crate::siva::{Siva, SivaState};
use crate::system::{Start, System};
use lane::{Lane, Lanes, STOP};

/// Runs side by side.
pub const LANES: usize = 8;
/// Fewer runs than this go one by one.
const WORTHWHILE: usize = 3;
/// Evaluations between two looks whether to stop.
const CANCEL_EVERY: u64 = 1024;

/// A free decay to run.
#[derive(Debug, Clone)]
pub struct Decay {
    /// The absorber on its primary.
    pub siva: Siva,
    /// The state at time zero.
    pub start: Start,
    /// How long, and where to stop.
    pub limits: Limits,
}

/// What came of it.
pub type Decayed = (Tally<SivaState>, MeasureValues);

/// Runs free decays and hands each out with its index, in the order in which they end. Every one is what
/// [`simulate`] with [`Measures`] gives, bit for bit. Once cancelled, those begun come back as they are, the
/// others not.
///
/// # Errors
/// The first [`Invalid`] start or limits, before anything runs.
pub fn decays(
    scenes: &[Decay],
    wanted: Wanted,
    cancel: Option<&AtomicBool>,
    take: &mut dyn FnMut(usize, &Decayed),
) -> Result<(), Invalid> {
    for Decay { siva, start, limits } in scenes {
        siva.check_start(start)?;
        limits.check()?;
    }
    // The lanes of a group have one primary in common.
    let damping = |index: &usize| scenes[*index].siva.damping_ratio();
    let mut order: Vec<usize> = (0..scenes.len()).collect();
    order.sort_by(|a, b| damping(a).total_cmp(&damping(b)));
    for same in order.chunk_by(|a, b| damping(a) == damping(b)) {
        if same.len() < WORTHWHILE {
            one_by_one(scenes, same, wanted, cancel, take)?;
        } else {
            Group::new(scenes, same, wanted, cancel, take).run();
        }
    }
    Ok(())
}

fn one_by_one(
    scenes: &[Decay],
    order: &[usize],
    wanted: Wanted,
    cancel: Option<&AtomicBool>,
    take: &mut dyn FnMut(usize, &Decayed),
) -> Result<(), Invalid> {
    for index in order {
        if is_set(cancel) {
            break;
        }
        let Decay { siva, start, limits } = &scenes[*index];
        let mut measures = Measures::<Siva>::new(wanted);
        let tally = simulate(siva, start, limits, cancel, &mut measures)?;
        take(*index, &(tally, *measures.values()));
    }
    Ok(())
}

fn is_set(cancel: Option<&AtomicBool>) -> bool {
    cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
}

/// Runs whose primaries have the same damping ratio.
struct Group<'a> {
    scenes: &'a [Decay],
    /// Which of them.
    order: &'a [usize],
    /// The first of these not begun.
    next: usize,
    wanted: Wanted,
    cancel: Option<&'a AtomicBool>,
    free: Arc<Oscillator>,
    homes: [Option<Home<'a>>; LANES],
    /// Lanes at work.
    live: usize,
    take: &'a mut dyn FnMut(usize, &Decayed),
}

/// Where the run of a lane is at home.
struct Home<'a> {
    index: usize,
    run: Run<'a, Siva, Measures<Siva>>,
}

/// One evaluation of each lane; true if one calls for the loop.
#[inline(always)]
fn evaluate<const W: usize>(lanes: &mut Lanes<W>, free: &Oscillator) -> bool {
    for i in 0..W {
        let lane = step::step(free, &lanes.get(i));
        lanes.set(i, &lane);
    }
    let mut calls = 0.0;
    for i in 0..W {
        calls += lanes.care[i] + lanes.stopped[i] + lanes.peaked[i];
    }
    calls > 0.0
}

impl<'a> Group<'a> {
    fn new(
        scenes: &'a [Decay],
        order: &'a [usize],
        wanted: Wanted,
        cancel: Option<&'a AtomicBool>,
        take: &'a mut dyn FnMut(usize, &Decayed),
    ) -> Self {
        let free = Arc::clone(scenes[order[0]].siva.shared());
        let homes = [const { None }; LANES];
        Self { scenes, order, next: 0, wanted, cancel, free, homes, live: 0, take }
    }

    fn run(&mut self) {
        let mut lanes = Lanes::<LANES>::new();
        for i in 0..LANES {
            self.refill(&mut lanes, i);
        }
        let free = Arc::clone(&self.free);
        dispatched(
            #[inline(always)]
            || {
                while self.live > 0 {
                    for _ in 0..CANCEL_EVERY {
                        if evaluate(&mut lanes, &free) {
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
    fn attend(&mut self, lanes: &mut Lanes<LANES>) {
        for i in 0..LANES {
            let Some(home) = &mut self.homes[i] else { continue };
            if lanes.peaked[i] > 0.0 {
                let (peak, index) = lanes.get(i).ended_peak();
                home.run.observer.peak(&peak, index);
            }
            if lanes.stopped[i] == STOP {
                let mut lane = lanes.get(i);
                if home.pass_stop(&mut lane, &self.free) {
                    lanes.set(i, &lane);
                    continue;
                }
            }
            if lanes.care[i] + lanes.stopped[i] > 0.0 {
                lanes.get(i).put_back(&mut home.run);
                self.go_on(lanes, i);
            }
        }
    }

    /// Lets the event loop go on until the lane can, or the run ends.
    fn go_on(&mut self, lanes: &mut Lanes<LANES>, i: usize) {
        let Some(home) = &mut self.homes[i] else { return };
        let mut goes_on = home.run.step();
        loop {
            if !goes_on {
                let tally = home.run.finish();
                (self.take)(home.index, &(tally, *home.run.observer.values()));
                self.homes[i] = None;
                self.live -= 1;
                return self.refill(lanes, i);
            }
            if let Some(lane) = home.lane(&self.free) {
                return lanes.set(i, &lane);
            }
            goes_on = home.run.step();
        }
    }

    /// Gives a lane the next run, if there is one of the same primary.
    fn refill(&mut self, lanes: &mut Lanes<LANES>, i: usize) {
        let index = match self.order.get(self.next) {
            Some(index) if !is_set(self.cancel) => *index,
            _ => return lanes.set(i, &Lane::idle()),
        };
        let Decay { siva, start, limits } = &self.scenes[index];
        self.next += 1;
        siva.free.get_or_init(|| Arc::clone(&self.free));
        let measures = Measures::<Siva>::new(self.wanted);
        let mut run = Run::new(siva, start, limits, self.cancel, measures);
        run.begin();
        self.homes[i] = Some(Home { index, run });
        self.live += 1;
        self.go_on(lanes, i);
    }

    /// Ends every run where it is; those not begun stay so.
    fn cancel(&mut self, lanes: &mut Lanes<LANES>) {
        self.next = self.order.len();
        for i in 0..LANES {
            if let Some(home) = &mut self.homes[i] {
                lanes.get(i).put_back(&mut home.run);
                let tally = home.run.cancelled();
                (self.take)(home.index, &(tally, *home.run.observer.values()));
                self.homes[i] = None;
                self.live -= 1;
                lanes.set(i, &Lane::idle());
            }
        }
    }
}

impl Home<'_> {
    /// The lane of the run, if it is where strides can go on.
    fn lane(&self, free: &Oscillator) -> Option<Lane> {
        let run = &self.run;
        let Phase::Flight { first } = run.phase else { return None };
        let settled = run.observer.reference.settled && run.observer.reference.amplitude > 0.0;
        let low = run.streak.as_ref().is_some_and(|streak| streak.low > 0);
        let ahead = -run.clock.minus(run.stop());
        let lane = Lane::of(run, first, free.reach);
        (settled && !low && ahead > 0.0 && !lane.full()).then_some(lane)
    }

    /// Goes on after a stop within the run; false: something else has ended it.
    fn pass_stop(&mut self, lane: &mut Lane, free: &Oscillator) -> bool {
        let run = &mut self.run;
        if lane.stop == TURN[0] {
            run.observer.one_period(run.system.energy(&lane.state()));
        }
        run.pass_stop();
        if run.stopped == STOPS || lane.full() {
            return false;
        }
        lane.stop = run.stop();
        let remaining = -lane.clock().minus(lane.stop);
        lane.length = free.reach.min(remaining).min(lane.first);
        lane.h = lane.length;
        lane.stopped = 0.0;
        lane.peaked = 0.0;
        remaining > 0.0
    }
}
