//! A group of runs in its lanes: a lane whose run has ended is given the next run.

use std::iter::repeat_with;

use super::side_by_side::{Group, IndexedRun, Lockstep, SideBySide, Watch, is_set};
use crate::engine::simulate::Tally;
use crate::number::vectors::in_vectors;

/// Number of evaluations between two checks of the cancel flag.
const CANCEL_EVERY: u64 = 1024;

/// A group whose runs are being made.
pub(super) struct Running<'a, S: SideBySide> {
    group: Group<'a, S>,
    /// The run of each lane, and its index.
    runs: Vec<Option<IndexedRun<'a, S>>>,
    /// Number of lanes with a run.
    live: usize,
    /// The observer of the run that ended last, whose memory the next run can use.
    spare: Option<Watch<S>>,
}

impl<'a, S: SideBySide> Running<'a, S> {
    /// A group that has not begun.
    pub fn new(group: Group<'a, S>) -> Self {
        Self { group, runs: Vec::new(), live: 0, spare: None }
    }

    /// Makes its runs.
    pub fn run<L: Lockstep<S>>(mut self) {
        self.runs = repeat_with(|| None).take(L::WIDTH).collect();
        in_vectors(
            #[inline(always)]
            || {
                // This closure is the function that is vectorised. With the lanes as its local variables, the
                // compiler aligns its stack to the arrays, and so the registers that it spills.
                let group = &self.group;
                let mut lanes = L::new(&group.jobs[group.order[0]], group.wanted, group.listing);
                for i in 0..L::WIDTH {
                    self.refill(&mut lanes, i);
                }
                while self.live > 0 {
                    for _ in 0..CANCEL_EVERY {
                        if lanes.evaluate() {
                            self.serve(&mut lanes);
                            if self.live == 0 {
                                break;
                            }
                        }
                    }
                    if is_set(self.group.cancel) {
                        self.cancel(&mut lanes);
                    }
                }
            },
        );
    }

    /// Serves the requests of the lanes.
    #[inline(never)]
    fn serve<L: Lockstep<S>>(&mut self, lanes: &mut L) {
        for i in 0..L::WIDTH {
            let Some((_, run)) = &mut self.runs[i] else { continue };
            if lanes.requests(i) && !lanes.serve(i, run) {
                self.go_on(lanes, i);
            }
        }
    }

    /// Lets the event loop go on with a run until the lane can take it, or the run ends.
    fn go_on<L: Lockstep<S>>(&mut self, lanes: &mut L, i: usize) {
        let Some((_, run)) = &mut self.runs[i] else { return };
        while run.step() {
            if lanes.take(i, run) {
                return;
            }
        }
        let tally = run.finish();
        self.leave(i, tally);
        self.refill(lanes, i);
    }

    /// Hands out the result of a lane's run, which has ended.
    fn leave(&mut self, i: usize, tally: Tally<S::State>) {
        if let Some((index, mut run)) = self.runs[i].take() {
            self.group.hand_out(index, tally, &mut run.observer);
            self.spare = Some(run.observer);
            self.live -= 1;
        }
    }

    /// Gives a lane the next run, if there is one.
    #[inline(never)]
    fn refill<L: Lockstep<S>>(&mut self, lanes: &mut L, i: usize) {
        let group = &mut self.group;
        let index = match group.order.get(group.next) {
            Some(index) if !is_set(group.cancel) => *index,
            _ => return lanes.idle(i),
        };
        group.next += 1;
        L::join(group.leader(), &group.jobs[index].system);
        let mut run = group.begun(index, self.spare.take());
        let taken = !run.ended && lanes.take(i, &mut run);
        self.runs[i] = Some((index, run));
        self.live += 1;
        if !taken {
            self.go_on(lanes, i);
        }
    }

    /// Ends every run where it is; runs that have not begun are not made.
    fn cancel<L: Lockstep<S>>(&mut self, lanes: &mut L) {
        self.group.next = self.group.order.len();
        for i in 0..L::WIDTH {
            if let Some((_, run)) = &mut self.runs[i] {
                lanes.put_back(i, run);
                let tally = run.cancelled();
                self.leave(i, tally);
                lanes.idle(i);
            }
        }
    }
}
