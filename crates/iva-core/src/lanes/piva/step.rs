//! A step of every lane, in parts that leave their numbers to the next.
//!
//! The same numbers in the same order as in the event loop, without branches. What a lane cannot do here
//! it leaves as it is, and requests its run; a proof that fails is tried again in the next round.

use super::Shared;
use super::lane::{FAR, Lanes, NEAR, NONE, Pose};
use super::rows::Rows;
use crate::compensated::DoubleDouble;
use crate::lanes::pick;
use crate::lanes::watch::{Passage, Stretch};
use crate::piva::PivaState;
use crate::piva::accuracy::Sizes;
use crate::piva::step::{Step, Turning};
use crate::polynomial::square_integral;
use crate::real::Real;
use crate::taylor::remainder::{ATTEMPTS, COARSER, Proof, Remainder, first_ratio};
use crate::taylor::{ORDER, Series, Swing, unrolled};

/// A proof is tried so often here at most.
const TRIES: f64 = 3.0;

/// The series.
#[inline(always)]
pub(super) fn series<const W: usize, const N: usize>(
    lanes: &mut Lanes<W>,
    rows: &mut Rows<W>,
    shared: &Shared,
) {
    for i in 0..W {
        let lane = lanes.get(i);
        let (pendulum, state) = (lane.pendulum(), lane.pose.state());
        let longest = shared.longest / f64::larger(lane.fastest, pendulum.swing(state.w.value));
        let step = f64::power_of_two(longest);
        let swing = Swing {
            x: state.primary.x.value,
            u: state.primary.v.value,
            y: state.y().value,
            w: state.w.value,
            c: state.cosine.value,
        };
        let mut series: Series<f64> =
            pendulum.series_to::<f64, { ORDER + 1 }, N>(&swing, None, step);
        series.w[1] = pick(state.released, 0.0, series.w[1]);
        series.y[2] = pick(state.released, 0.0, series.y[2]);
        rows.set::<N>(i, &series);
        lanes.step[i] = step;
        lanes.most[i] = longest / step;
    }
}

/// How much of its step each series is good for.
#[inline(always)]
pub(super) fn prove<const W: usize, const N: usize>(
    lanes: &mut Lanes<W>,
    rows: &Rows<W>,
    shared: &Shared,
) {
    for i in 0..W {
        let (lane, series) = (lanes.get(i), rows.get::<N>(i));
        let ratio = pick(lane.tries > 0.0, lane.ratio, first_ratio::<_, N>(&series));
        let pendulum = lane.pendulum();
        let proof = Proof::new::<N>(&pendulum, &series, [0.0; 2], lane.step, ratio);
        let (mut tail, mut proved) = (proof.first(), false);
        unrolled!(_attempt < ATTEMPTS => {
            let (proves, larger) = proof.tried(&tail);
            proved |= proves;
            tail = tail.map(&larger, |now, next| pick(proved, now, next));
        });
        let remainder = Remainder::proven::<N>(ratio, tail);
        let sizes = Sizes::at(lane.mass_ratio, lane.gap_size, &lane.pose.state());
        let (share, kept) = sizes.share(&remainder, lane.most, shared.tolerance);
        lanes.reach[i] = share * lane.step;
        lanes.proved[i] = pick(proved, pick(kept, 1.0, -1.0), 0.0);
        lanes.ratio[i] = pick(proved, ratio, ratio * COARSER);
    }
}

/// Goes to the end of the step, if it meets no wall, and measures on the way.
#[inline(always)]
pub(super) fn arrive<const W: usize, const N: usize>(
    lanes: &mut Lanes<W>,
    rows: &Rows<W>,
    shared: &Shared,
) {
    for i in 0..W {
        let (lane, series) = (lanes.get(i), rows.get::<N>(i));
        let (pendulum, from) = (lane.pendulum(), lane.pose.state());
        let step = Step { pendulum: &pendulum, from: &from, series: &series, length: lane.step };
        let clock = lane.clock();
        let remaining = -clock.minus(lane.stop);
        // A step towards a wall was looked at before: this time it goes there.
        let meeting = lane.meets > NONE;
        let whole = lane.reach.min(remaining).min(lane.first);
        let length = pick(meeting, lane.until, whole);
        let share = length / lane.step;
        let end = step.arrival::<N>(length, None);
        let gap = step.gap::<N>(&end, length, shared.doubt);
        let Turning { decided, turns, h: h_turn, x: x_turn } = step.turning::<N>(&end, length);

        let x = from.primary.x.value;
        let (h_turn, x_turn) = (pick(turns, h_turn, 0.0), pick(turns, x_turn, x));
        let stretch = Stretch {
            x: [x, x_turn, end.primary.x.value],
            h: [0.0, h_turn, length],
            turns,
            loss: 0.0,
        };
        // Steps across the instants that measures look at are for the loop.
        let across = |instant: f64| {
            let ahead = -clock.minus(instant);
            (ahead > 0.0) & (ahead <= length)
        };
        let looked_at =
            across(f64::TURN.value) | across(lane.watch.late_from) | across(lane.watch.later_from);
        let simple = stretch.ends(lane.watch.peak_sign).simple() & decided & !looked_at;
        let proved = lane.proved > 0.0;
        let done = proved & (gap.clear | meeting) & simple & (meeting | (length < remaining));
        let looks = proved & !meeting & (gap.near | gap.far);
        let tries = (lane.proved == 0.0) & (lane.tries + 1.0 < TRIES);

        let mut next = lane;
        (next.length, next.end_distance) = (length, end.distance.value);
        next.origin = lane.pose;
        (next.start_time, next.start_time_rest) = (lane.time, lane.time_rest);
        let arrived = Pose::new(&end);
        next.pose = arrived.if_else(done, &lane.pose);
        let later = clock.plus_parts(length, 0.0);
        next.time = pick(done, later.value, lane.time);
        next.time_rest = pick(done, later.rest, lane.time_rest);
        next.first = pick(done, f64::INFINITY, lane.first);
        next.share = pick(done, share, 0.0);
        next.work = lane.work + pick(done, 1.0, 0.0);
        next.tries = pick(tries, lane.tries + 1.0, pick(looks, lane.tries, 0.0));
        next.meets = pick(looks, pick(gap.near, NEAR, FAR), NONE);
        next.met = pick(done, lane.meets, NONE);
        next.watch = lane.watch.after(&stretch, clock, done);
        macro_rules! passage {
            ($level:expr, $passed:ident, $from:ident, $to:ident) => {
                let Passage { passes, h: [from, to], level } =
                    stretch.passage($level * lane.watch.amplitude);
                next.$passed = pick(passes & done, level, 0.0);
                next.$from = from;
                next.$to = to;
            };
        }
        passage!(0.10, passed_1, from_1, to_1);
        passage!(0.05, passed_2, from_2, to_2);
        passage!(0.02, passed_3, from_3, to_3);
        let full = next.work >= lane.max_work;
        let goes_on = ((done & !meeting) | looks | tries) & !full;
        next.request = pick(goes_on, 0.0, lane.live);
        next.requests = next.request
            + next.watch.peaked
            + next.passed_1.abs()
            + next.passed_2.abs()
            + next.passed_3.abs();
        lanes.set(i, &next);
    }
}

/// Where lanes meet the wall that they have been found to meet.
#[inline(always)]
pub(super) fn meet<const W: usize, const N: usize>(lanes: &mut Lanes<W>, rows: &Rows<W>) {
    for i in 0..W {
        let (lane, series) = (lanes.get(i), rows.get::<N>(i));
        let (pendulum, from) = (lane.pendulum(), lane.pose.state());
        let step = Step { pendulum: &pendulum, from: &from, series: &series, length: lane.step };
        let distance = DoubleDouble::new(lane.end_distance);
        let end = PivaState { distance, ..from };
        let (until, exact) = step.meeting::<N>(&end, lane.length, lane.meets == FAR);
        let lost = (lane.meets > NONE) & !exact;
        lanes.until[i] = until;
        lanes.meets[i] = pick(lost, NONE, lane.meets);
        lanes.request[i] = pick(lost, lane.live, lane.request);
        lanes.requests[i] = pick(lost, lane.live, lane.requests);
    }
}

/// What dampers take in a step that is done: the primary's and, if they have one, those of the pivots.
#[inline(always)]
pub(super) fn lose<const W: usize, const N: usize>(
    lanes: &mut Lanes<W>,
    rows: &Rows<W>,
    pivots: bool,
) {
    for i in 0..W {
        let lane = lanes.get(i);
        let loss = 2.0
            * lane.damping_ratio
            * square_integral::<_, N>(&rows.get::<N>(i).u, lane.share)
            * lane.step;
        let sum = DoubleDouble { value: lane.viscous, rest: lane.viscous_rest }.plus(loss);
        let done = lane.share > 0.0;
        lanes.viscous[i] = pick(done, sum.value, lane.viscous);
        lanes.viscous_rest[i] = pick(done, sum.rest, lane.viscous_rest);
    }
    if !pivots {
        return;
    }
    for i in 0..W {
        let lane = lanes.get(i);
        let inertia = lane.mass_ratio * lane.inertia_ratio * (lane.lever * lane.lever);
        let loss = inertia
            * lane.pivot_damping
            * square_integral::<_, N>(&rows.get::<N>(i).w, lane.share)
            * lane.step;
        let sum = DoubleDouble { value: lane.pivot, rest: lane.pivot_rest }.plus(loss);
        let done = lane.share > 0.0;
        lanes.pivot[i] = pick(done, sum.value, lane.pivot);
        lanes.pivot_rest[i] = pick(done, sum.rest, lane.pivot_rest);
    }
}
