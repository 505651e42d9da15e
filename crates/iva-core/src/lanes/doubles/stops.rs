//! The stops of a lane: instants that a measure looks at, which no stretch may cross.

use super::{Doubles, Watched};
use crate::flight::GapPoint;
use crate::steady::Steady;
use crate::system::{Clock, Point, System};

/// Relative distance at or below which two instants count as the same.
const SAME: f64 = 4.0 * f64::EPSILON;

/// True if an instant is not later than the clock, apart from rounding.
pub(super) fn is_due(instant: f64, clock: Clock) -> bool {
    -clock.minus(instant) <= SAME * instant.abs()
}

/// True if the window of the steady state has begun.
pub(super) fn counts(run: &Watched<'_>, clock: Clock) -> bool {
    let begin = run.observer.1.as_ref().map(Steady::begin);
    begin.is_some_and(|begin| is_due(begin, clock))
}

impl<const DRIVE: u8> Doubles<DRIVE> {
    /// The next instant that no stretch may cross.
    pub(super) fn next_stop(&self, run: &Watched<'_>, clock: Clock) -> f64 {
        let duration = run.limits.duration;
        let mut stop = duration;
        let mut consider = |instant: f64| {
            if instant < stop && !is_due(instant, clock) {
                stop = instant;
            }
        };
        if let Some(steady) = &run.observer.1 {
            consider(steady.begin());
            steady.next_strobe().into_iter().for_each(|instant| consider(instant.value));
        }
        stop
    }

    /// Handles the measures that are due at a stop; false: the run goes back to the event loop.
    pub(super) fn pass_stop(&mut self, i: usize, run: &mut Watched<'_>) -> bool {
        let (stop, clock) = (self.lanes.stop[i], self.lanes.clock(i));
        let ends = stop == run.limits.duration;
        if run.observer.1.is_some() {
            self.tell(i, run);
            let at = self.lanes.state.get(i);
            if let Some(steady) = &mut run.observer.1 {
                // At the end of the run a strobe counts even if rounding puts it later.
                let due = |instant: Clock| ends || is_due(instant.value, clock);
                while steady.next_strobe().is_some_and(due) {
                    let y = run.system.offset() + at.side * (run.system.clearance() - at.distance);
                    let gap = GapPoint { y, w: -at.side * at.rate };
                    steady.strobe_at(Point { x: at.x, v: at.v }, gap);
                }
            }
            self.totals.counts[i] = if counts(run, clock) { 1.0 } else { 0.0 };
        }
        if ends {
            run.reach_end();
            return false;
        }
        let next = self.next_stop(run, clock);
        let remaining = -clock.minus(next);
        let lanes = &mut self.lanes;
        lanes.stop[i] = next;
        lanes.length[i] = lanes.structure.longest[i].min(remaining).min(lanes.first[i]);
        lanes.stopped[i] = 0.0;
        remaining > 0.0
    }
}
