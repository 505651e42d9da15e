//! A step of every lane, in parts that pass numbers on in the lanes.
//!
//! The arithmetic is that of the event loop, without branches. A lane that cannot make the step keeps its
//! state and requests its run.

use super::Shared;
use super::any;
use super::lane::{FAR, Lane, Lanes, NEAR, NONE, Pose};
use super::rows::Rows;
use super::watch::{Passage, Stretch};
use crate::arrays::{Laned, Lanes as _};
use crate::compensated::DoubleDouble;
use crate::flight::{Arc, Losses};
use crate::lanes::pick;
use crate::piva::PivaState;
use crate::piva::accuracy::Sizes;
use crate::piva::integrals::{self, Integrands};
use crate::piva::step::{Step, Turning};
use crate::real::Real;
use crate::settling::LEVELS;
use crate::taylor::{ORDER, Remainder, Series, Swing, unrolled};

/// Sets the length of the step and computes the force over it.
#[inline(always)]
pub(super) fn begin<const W: usize, const DRIVEN: bool, const SMALL: bool>(
    lanes: &mut Lanes<W>,
    rows: &mut Rows<W>,
    shared: &Shared,
) {
    for i in 0..W {
        let lane = lanes.get(i);
        let swing = lane.pendulum::<SMALL>().swing(lane.pose.w);
        let longest = shared.longest / f64::larger(lane.fastest, swing);
        let step = f64::power_of_two(longest);
        lanes.step[i] = step;
        lanes.most[i] = longest / step;
    }
    if DRIVEN {
        for i in 0..W {
            let lane = lanes.get(i);
            rows.set_drive(i, &lane.drive(lane.step));
        }
    }
}

/// Computes the series of the step.
#[inline(always)]
pub(super) fn series<const W: usize, const N: usize, const DRIVEN: bool, const SMALL: bool>(
    lanes: &Lanes<W>,
    rows: &mut Rows<W>,
) {
    for i in 0..W {
        let lane = lanes.get(i);
        let (pendulum, state) = (lane.pendulum::<SMALL>(), lane.pose.state());
        let swing = Swing {
            x: state.primary.x.value,
            u: state.primary.v.value,
            y: state.y().value,
            w: state.w.value,
            c: state.cosine.value,
        };
        let mut series: Series<f64> = if DRIVEN {
            pendulum.series_to::<_, { ORDER + 1 }, N>(&swing, Some(&rows.drive(i)), lane.step)
        } else {
            pendulum.series_to::<_, { ORDER + 1 }, N>(&swing, None, lane.step)
        };
        series.w[1] = pick(state.released, 0.0, series.w[1]);
        series.y[2] = pick(state.released, 0.0, series.y[2]);
        rows.set::<N>(i, &series);
    }
}

/// Proves up to which time of the step each series keeps to the tolerance.
#[inline(always)]
pub(super) fn prove<const W: usize, const N: usize, const DRIVEN: bool, const SMALL: bool>(
    lanes: &mut Lanes<W>,
    rows: &Rows<W>,
    shared: &Shared,
) {
    for i in 0..W {
        let (lane, series) = (lanes.get(i), rows.get::<N>(i));
        let (pendulum, most) = (lane.pendulum::<SMALL>(), lane.most);
        let driven = if DRIVEN { lane.left_out::<N>(lane.step * most) } else { [0.0; 2] };
        let remainder =
            Remainder::new::<N>(&pendulum, lane.fastest, &series, driven, (lane.step, most));
        let size = if DRIVEN { rows.drive(i).size() } else { 0.0 };
        let sizes = Sizes::at(lane.mass_ratio, lane.gap_size, &lane.pose.state()).with(size);
        let (share, kept) = sizes.share(&remainder, shared.tolerance);
        lanes.reach[i] = share * lane.step;
        lanes.proved[i] = pick(kept, 1.0, 0.0);
    }
}

/// Goes to the end of the step, or to a contact found before; takes the measures of a decay that is `WATCHED`.
#[inline(always)]
pub(super) fn arrive<
    const W: usize,
    const N: usize,
    const DRIVEN: bool,
    const SMALL: bool,
    const WATCHED: bool,
>(
    lanes: &mut Lanes<W>,
    rows: &Rows<W>,
    shared: &Shared,
) {
    for i in 0..W {
        let (lane, series) = (lanes.get(i), rows.get::<N>(i));
        let (pendulum, from) = (lane.pendulum::<SMALL>(), lane.pose.state());
        let step = Step { pendulum: &pendulum, from: &from, series: &series, length: lane.step };
        let clock = lane.clock();
        let remaining = -clock.minus(lane.stop);
        // The contact of a step towards a wall was found in the round before.
        let meeting = lane.meets > NONE;
        let whole = lane.reach.min(remaining).min(lane.first);
        let length = pick(meeting, lane.until, whole);
        let share = length / lane.step;
        let drive = if DRIVEN { Some(lane.beginning()) } else { None };
        let end = step.arrival::<N>(length, drive.as_ref());
        let gap = step.gap::<N>(&end, length, shared.doubt);
        let (simple, stretch) = if WATCHED {
            looked_at::<N>(&lane, &step, &end, length)
        } else {
            // The energy after a period is read of every decay.
            (DRIVEN | !lane.passes(f64::TURN.value, length), Stretch::NONE)
        };
        let proved = lane.proved > 0.0;
        let done = proved & (gap.clear | meeting) & simple & (meeting | (length < remaining));
        let looks = proved & !meeting & (gap.near | gap.far);

        let mut next = lane;
        (next.length, next.end_distance) = (length, end.distance.value);
        next.origin = lane.pose;
        (next.start_time, next.start_time_rest) = (lane.time, lane.time_rest);
        let arrived = Pose::new(&end);
        next.pose = Laned::pick(done, &arrived, &lane.pose);
        let later = clock.plus_parts(length, 0.0);
        next.time = pick(done, later.value, lane.time);
        next.time_rest = pick(done, later.rest, lane.time_rest);
        next.first = pick(done, f64::INFINITY, lane.first);
        next.share = pick(done, share, 0.0);
        next.work = lane.work + pick(done, 1.0, 0.0);
        next.meets = pick(looks, pick(gap.near, NEAR, FAR), NONE);
        next.met = pick(done, lane.meets, NONE);
        let full = next.work >= lane.max_work;
        let goes_on = ((done & !meeting) | looks) & !full;
        next.request = pick(goes_on, 0.0, lane.live);
        if DRIVEN {
            next.requests = next.request + pick(done, shared.tells, 0.0);
        } else if WATCHED {
            watch(&mut next, &stretch, clock, done);
        } else {
            next.requests = next.request;
        }
        lanes.set(i, &next);
    }
}

/// The turning point of x in a stretch of a decay, and whether the stretch is simple enough for the measures.
#[inline(always)]
fn looked_at<const N: usize>(
    lane: &Lane,
    step: &Step<'_>,
    end: &PivaState,
    length: f64,
) -> (bool, Stretch) {
    let Turning { decided, turns, h: h_turn, x: x_turn } = step.turning::<N>(end, length);
    let x = step.from.primary.x.value;
    let (h_turn, x_turn) = (pick(turns, h_turn, 0.0), pick(turns, x_turn, x));
    let stretch =
        Stretch { x: [x, x_turn, end.primary.x.value], h: [0.0, h_turn, length], turns, loss: 0.0 };
    // Steps across instants at which measures are taken are for the event loop.
    let looked_at = lane.passes(f64::TURN.value, length)
        | lane.passes(lane.watch.late_from, length)
        | lane.passes(lane.watch.later_from, length);
    (stretch.ends(lane.watch.peak_sign).simple() & decided & !looked_at, stretch)
}

/// Adds a stretch that begins at an instant to the measures of a decay, if it is `done`.
#[inline(always)]
fn watch(next: &mut Lane, stretch: &Stretch, clock: DoubleDouble, done: bool) {
    let before = next.watch;
    next.watch = before.after(stretch, clock, done);
    macro_rules! passage {
        ($level:expr, $passed:ident, $from:ident, $to:ident) => {
            let Passage { passes, h: [from, to], level } =
                stretch.passage($level * before.amplitude);
            next.$passed = pick(passes & done, level, 0.0);
            next.$from = from;
            next.$to = to;
        };
    }
    passage!(LEVELS[0], passed_1, from_1, to_1);
    passage!(LEVELS[1], passed_2, from_2, to_2);
    passage!(LEVELS[2], passed_3, from_3, to_3);
    next.requests = next.request
        + next.watch.peaked
        + next.passed_1.abs()
        + next.passed_2.abs()
        + next.passed_3.abs();
}

/// Finds the time of contact of the lanes that meet a wall.
#[inline(always)]
pub(super) fn meet<const W: usize, const N: usize, const SMALL: bool>(
    lanes: &mut Lanes<W>,
    rows: &Rows<W>,
) {
    for i in 0..W {
        let (lane, series) = (lanes.get(i), rows.get::<N>(i));
        let (pendulum, from) = (lane.pendulum::<SMALL>(), lane.pose.state());
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

/// Losses in the dampers and work of the force over a step that is done.
#[inline(always)]
pub(super) fn lose<const W: usize, const N: usize, const DRIVEN: bool>(
    lanes: &mut Lanes<W>,
    rows: &Rows<W>,
    shared: &Shared,
) {
    let (pivots, base) = (shared.pivots, DRIVEN && any(&lanes.moves_base));
    for i in 0..W {
        let (lane, series) = (lanes.get(i), rows.get::<N>(i));
        let Series { u, y, w, .. } = &series;
        let (pendulum, t, step) = (lane.pendulum::<false>(), lane.share, lane.step);
        let free = Integrands { u, y, w, drive: None, pivots, base };
        let Losses { viscous, pivot, work } = if DRIVEN {
            Integrands { drive: Some(&rows.drive(i)), ..free }.taken::<N>(&pendulum, t, step)
        } else {
            free.taken::<N>(&pendulum, t, step)
        };
        (lanes.lost[i], lanes.lost_in_pivot[i], lanes.worked[i]) = (viscous, pivot, work);
    }
    if DRIVEN {
        return;
    }
    for i in 0..W {
        let lane = lanes.get(i);
        let done = lane.share > 0.0;
        let viscous = DoubleDouble { value: lane.viscous, rest: lane.viscous_rest }.plus(lane.lost);
        let pivot =
            DoubleDouble { value: lane.pivot, rest: lane.pivot_rest }.plus(lane.lost_in_pivot);
        lanes.viscous[i] = pick(done, viscous.value, lane.viscous);
        lanes.viscous_rest[i] = pick(done, viscous.rest, lane.viscous_rest);
        lanes.pivot[i] = pick(done, pivot.value, lane.pivot);
        lanes.pivot_rest[i] = pick(done, pivot.rest, lane.pivot_rest);
    }
}

/// ∫x² over a step that is done.
#[inline(always)]
pub(super) fn square<const W: usize, const N: usize>(lanes: &mut Lanes<W>, rows: &Rows<W>) {
    for i in 0..W {
        let (lane, series) = (lanes.get(i), rows.get::<N>(i));
        lanes.square[i] = integrals::square::<f64, N>(&series.x, [0.0, lane.share], lane.step);
    }
}

/// Bounds on |x| and |ẍ + a_g| in a step that is done.
#[inline(always)]
pub(super) fn limit<const W: usize, const N: usize>(lanes: &mut Lanes<W>, rows: &Rows<W>) {
    let [x, a] = rows.primary();
    limits::<W, N>(x, &lanes.share, &mut lanes.limit_x);
    // The series of the acceleration has no coefficient of the order N.
    match N {
        10 => limits::<W, 9>(a, &lanes.share, &mut lanes.limit_a),
        16 => limits::<W, 15>(a, &lanes.share, &mut lanes.limit_a),
        18 => limits::<W, 17>(a, &lanes.share, &mut lanes.limit_a),
        _ => limits::<W, 19>(a, &lanes.share, &mut lanes.limit_a),
    }
}

/// Bounds on the absolute values of polynomials of order N on shares of a step.
#[inline(always)]
fn limits<const W: usize, const N: usize>(
    row: &[[f64; W]; ORDER + 1],
    share: &[f64; W],
    limits: &mut [f64; W],
) {
    for i in 0..W {
        let t = share[i];
        let [mut value, mut rate, mut half, mut size, mut sixth] = [0.0_f64; 5];
        unrolled!(j < N + 1 => {
            let k = N - j;
            let coefficient = row[k][i];
            half = half.mul_add(t, rate);
            rate = rate.mul_add(t, value);
            value = value.mul_add(t, coefficient);
            size = size.mul_add(t, coefficient.abs());
            if k > 5 {
                let falling = k * (k - 1) * (k - 2) * (k - 3) * (k - 4) * (k - 5);
                sixth = sixth.mul_add(t, coefficient.abs() * (falling as f64));
            }
        });
        let begin = [row[0][i], row[1][i], row[2][i] * 2.0];
        let arc = Arc::new(begin, [value, rate, half * 2.0], sixth, t).doubted(size);
        limits[i] = arc.limit();
    }
}
