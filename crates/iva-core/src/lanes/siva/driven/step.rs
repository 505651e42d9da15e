//! One evaluation of a driven flight, and what is measured along it.
//!
//! The same numbers in the same order as in [`Steady`](crate::steady::Steady), without branches.

use super::integrals::Integrals;
use super::lane::Lanes;
use crate::compensated::DoubleDouble;
use crate::flight::Arc;
use crate::host::Structure;
use crate::host::turning::Turned;
use crate::lanes::pick;
use crate::lanes::siva::look::look;

/// A strobe this close to the end of a span, over the time, is for the loop.
const NEARBY: f64 = 1e-12;

/// One evaluation of each lane.
#[inline(always)]
pub(super) fn steps<const W: usize, const EXTREMES: bool>(
    lanes: &mut Lanes<W>,
    integrals: &mut Integrals<W>,
) {
    for i in 0..W {
        let lane = lanes.get(i);
        let free = lane.structure();
        let from = lane.state(&free);
        let course = free.course(&from.host);
        let flying = &lane.flying;
        let look = look(&free, &course, flying, from, |_, _, _| [1.0, -1.0, 0.0, 0.0, 0.0, 0.0]);
        let (length, end) = (look.length, &look.end.host);

        // What counts.
        let clock = flying.clock();
        let ahead = -clock.minus(lane.from);
        let counts = ahead <= 0.0;
        let strobe = DoubleDouble { value: lane.strobe, rest: lane.strobe_rest };
        let strobed = (strobe - clock).value <= length + NEARBY * (clock.value + length);
        let mut simple = (counts | (ahead >= length)) & !strobed;
        let (mut largest, mut acceleration) = (lane.largest, lane.acceleration);
        if EXTREMES {
            let arcs = free.known(&look.from.host, end);
            let turned = free.displacement_turned(&look.from.host, &course, end, length);
            let (x, decided) = largest_of(&arcs.displacement, largest, length, turned);
            let turned = free.acceleration_turned(&look.from.host, &course, end, length);
            let (a, known) = largest_of(&arcs.acceleration, acceleration, length, turned);
            simple &= !counts | (decided & known);
            (largest, acceleration) = (x, a);
        }
        let done = look.passed & simple;
        let counts = done & counts;

        let mut next = lane;
        let state = look.next_state(done);
        (next.instant, next.instant_rest) =
            (state.host.phase.time.value, state.host.phase.time.rest);
        next.flying = look.next(flying, lane.reach, done);
        next.largest = pick(counts, largest, lane.largest);
        next.acceleration = pick(counts, acceleration, lane.acceleration);
        let listed = done & look.hit & (next.flying.time >= lane.from);
        next.counted = lane.counted + pick(listed, 1.0, 0.0);
        integrals.take(i, &free, &look.from.host, &course, [length, lane.step]);
        integrals.done[i] = pick(done, 1.0, 0.0);
        integrals.counts[i] = pick(counts, 1.0, 0.0);
        lanes.set(i, &next);
    }
}

/// The largest size of a function, or `least` if that is larger, and whether that is decided.
#[inline(always)]
fn largest_of(arc: &Arc, least: f64, length: f64, turned: Turned) -> (f64, bool) {
    let below = arc.is_below(least, length);
    let monotone = arc.is_monotone(length);
    let [a, b] = arc.values;
    let ends = least.max(a.abs()).max(b.abs());
    let turns = ends.max(turned.value.abs());
    let largest = pick(below, least, pick(monotone, ends, turns));
    (largest, below | monotone | turned.once)
}
