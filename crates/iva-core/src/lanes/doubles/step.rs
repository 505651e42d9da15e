//! One round of all lanes, in stages: each stage is a loop over the lanes that writes its results to arrays.
//!
//! 1. [`reach`]: the state at the end of the trial stretch, and what the quintic through both ends proves
//!    ([`crate::siva::fast_flight`]): no contact, or one contact with one wall, with an estimate of its time.
//! 2. [`land`]: the state at the estimate, the contact by its Taylor series, and the decision on the stretch.
//! 3. [`commit`]: the impact, the clock, and the next trial.
//!
//! A single loop would have some 600 instructions, more than a processor can reorder.

use super::lane::{Lane, Lanes};
use crate::arrays::arrays;
use crate::lanes::counts::Hit;
use crate::lanes::pick;
use crate::plain::responses::Tables;
use crate::plain::{FREE, State, States};
use crate::quintic::root_by;
use crate::simulate::wall::REBOUND_LOOK;
use crate::siva::fast_flight::Quintic;

/// Below this value of u/(A (1 − e)), half the duration of the chatter that remains, the event loop may sum
/// the tail, so the rebound is left to it. (The estimated error of the sum is at least 4 times the cube of
/// this value.)
const LOW: f64 = 1e-4;
/// Largest number of times that a trial is halved or a wall looked for again.
const TRIES: f64 = 4.0;
/// Largest relative change of the rate between the estimate of the contact and the contact.
const STRAIGHT: f64 = 0.05;

arrays! {
    /// The results of one round of a lane.
    Round,
    /// [`Round`] of many runs: every field an array over the lanes.
    Rounds:
    /// 1 if no wall is met; 1 if a wall is met; 1 if that is the far wall; the estimated time of the contact.
    free, meets, far, guess,
    /// 1 if the contact is found and its impact simple; the approach speed; the pressure after the impact.
    hit, approach, pressure,
    /// 1 if a stretch is completed; its length, the low part of that, and 1 if the run ends with it.
    passed, length, later, whole;
    /// After [`reach`] the state at the end of the trial; after [`land`] that at the end of the stretch,
    /// before an impact.
    end: State, States
}

/// Stage 1: evaluates the end of each trial and decides whether it meets a wall. `reached` gives that end. A
/// trial longer than the polynomials hold for is a leap, known to meet none.
#[inline(always)]
pub(super) fn reach<const W: usize, const DRIVE: u8>(
    lanes: &Lanes<W>,
    rounds: &mut Rounds<W>,
    reached: impl Fn(&Lane, usize) -> State,
) {
    for i in 0..W {
        let lane = lanes.get(i);
        let Lane { state, structure, length, again, again_far, .. } = lane;
        let end = reached(&lane, i);
        let leaps = length > structure.longest;
        // In units of the clearance, which keeps quotients in single precision in range.
        let over = lane.over_clearance;
        let square = length * length;
        let (first, second) = (length * over, (0.5 * over) * square);
        let ends = |at: &State| {
            let [[a, ..], _] = structure.derivatives::<DRIVE>(at);
            [at.distance * over, first * at.rate, second * (at.side * a)]
        };
        let sixth = (structure.bound::<4>(&state) * over) * (square * (square * square));
        let whole = Quintic::of([ends(&state), ends(&end)], sixth, 1.0);
        let proof = whole.proof();
        let meets_far = proof.meets[1];
        let part = root_by(&whole.meeting(meets_far), about);
        let looks = (again > 0.0) & !leaps;
        let free = (proof.free & !looks) | leaps;
        let meets =
            !leaps & !proof.free & (proof.meets[0] | meets_far) & (part > 0.0) & (part <= 1.0);
        let guess = pick(meets, length * part, 0.5 * length);
        let round = Round {
            free: pick(free, 1.0, 0.0),
            meets: pick(meets | looks, 1.0, 0.0),
            far: pick(looks, again_far, pick(meets_far, 1.0, 0.0)),
            guess: pick(looks, again, guess),
            end,
            ..Round::default()
        };
        rounds.set(i, &round);
    }
}

/// A quotient in single precision (seven digits), at a third of the time of one in double precision.
#[inline(always)]
pub(super) fn about(a: f64, b: f64) -> f64 {
    f64::from(a as f32 / b as f32)
}

/// Stage 2: finds the contact, where a wall is met, and decides on the stretch.
#[inline(always)]
pub(super) fn land<const W: usize, const DRIVE: u8>(
    lanes: &Lanes<W>,
    tables: &Tables<W>,
    rounds: &mut Rounds<W>,
) {
    for i in 0..W {
        let lane = lanes.get(i);
        let Lane { state, structure, clearance, .. } = lane;
        let round = rounds.get(i);
        let (meets, far, guess) = (round.meets > 0.0, round.far > 0.0, round.guess);
        let near = state.after::<DRIVE>(&structure, &tables.of(i), guess);
        let [[a, jerk, snap, ..], _] = structure.derivatives::<DRIVE>(&near);
        let left = near.distance - pick(far, clearance + clearance, 0.0);
        let rate = near.rate;
        let [bend, jerk, snap] = [near.side * a, near.side * jerk, near.side * snap];
        // Solves left + rate t + ½ bend t² + … = 0 by reversion of the series and one step of Newton's
        // method, for which quotients of a few correct digits suffice.
        let over = lane.over_clearance;
        let slowness = over * about(1.0, over * rate);
        let first = -left * slowness;
        let curved = (0.5 * slowness) * (bend * first);
        let cubed = ((1.0 / 6.0) * slowness) * (jerk * (first * first));
        let t = first * (1.0 - curved.mul_add(curved.mul_add(-2.0, 1.0), cubed));
        let half = 0.5 * bend;
        let value = ((1.0 / 24.0) * snap).mul_add(t, (1.0 / 6.0) * jerk).mul_add(t, half);
        let value = value.mul_add(t, rate).mul_add(t, left);
        let slope = ((1.0 / 6.0) * snap).mul_add(t, 0.5 * jerk).mul_add(t, bend).mul_add(t, rate);
        let t = t - about(over * value, over * slope);
        // Compares the next term of the series with the rounding of rate and distance.
        let square = t * t;
        let left_out = structure.bound::<3>(&state) * (square * square) * (t.abs() * (1.0 / 120.0));
        let close = (left_out <= 0.25 * f64::EPSILON * (rate.abs() * guess))
            & ((slowness * (bend * t)).abs() <= STRAIGHT)
            & (t.abs() < 0.5 * guess)
            & (slowness != 0.0);
        let mut touching = near.shortly_after::<DRIVE>(&structure, t);
        let turn = pick(far, -1.0, 1.0);
        touching.side *= turn;
        touching.rate *= turn;
        touching.distance = 0.0;
        let approach = -touching.rate;

        // The pressure after the impact, and whether the event loop has to handle what follows.
        let mut after = touching;
        after.v += lane.share * (touching.side * approach);
        let [[a, ..], _] = structure.derivatives::<DRIVE>(&after);
        let pressure = -(after.side * a);
        let rebound = lane.restitution * approach;
        let low = ((pressure > 0.0) & (rebound < pressure * (LOW * (1.0 - lane.restitution))))
            | (approach <= lane.floor)
            | (rebound <= 0.0);
        let remaining = -(lane.clock().minus(lane.stop));
        let before = guess + t < remaining;
        let hit = meets & close & !low & before & (approach > 0.0);
        let free = round.free > 0.0;
        let looks_again = meets & !close & (guess + t > 0.0) & (guess + t <= lane.length);

        let mut next = round;
        next.hit = pick(hit, 1.0, 0.0);
        next.approach = pick(hit, approach, 0.0);
        next.pressure = pressure;
        next.passed = pick(hit | free, 1.0, 0.0);
        next.length = pick(hit, guess, lane.length);
        next.later = pick(hit, t, 0.0);
        next.whole = pick(free & (lane.length == remaining), 1.0, 0.0);
        next.end = touching.if_else(hit, &round.end);
        // The time to look for the wall again; 0: the trial is halved.
        next.guess = pick(looks_again, guess + t, 0.0);
        next.meets = pick(meets & !hit & !looks_again, 1.0, 0.0);
        rounds.set(i, &next);
    }
}

/// Stage 3: applies impact and clock, and chooses the next trial. `leap` gives the length of a motion from a
/// state that meets no wall, as far as that is known without a trial.
#[inline(always)]
pub(super) fn commit<const W: usize, const DRIVE: u8>(
    lanes: &mut Lanes<W>,
    rounds: &Rounds<W>,
    leap: impl Fn(&State, f64) -> f64,
) {
    for i in 0..W {
        let lane = lanes.get(i);
        let round = rounds.get(i);
        let (passed, hit) = (round.passed > 0.0, round.hit > 0.0);
        let clock = lane.clock().plus_parts(round.length, round.later);
        let remaining = -clock.minus(lane.stop);
        let mut after = round.end;
        if DRIVE != FREE {
            [after.force, after.quadrature] = lane.structure.force_at(clock);
        }
        let kick = lane.share * (after.side * round.approach);
        after.v += pick(hit, kick, 0.0);
        after.rate = pick(hit, lane.restitution * round.approach, after.rate);

        let mut next = lane;
        next.state = after.if_else(passed, &lane.state);
        (next.time, next.time_rest) =
            (pick(passed, clock.value, lane.time), pick(passed, clock.rest, lane.time_rest));
        let (v, side) = (round.end.v, round.end.side);
        let impact = Hit { time: next.time, v, side, approach: round.approach };
        next.counts = lane.counts.after(passed, hit, &impact);

        let rebounds = hit & (round.pressure > 0.0);
        let ahead = REBOUND_LOOK
            * about(
                lane.over_clearance * (lane.restitution * round.approach),
                lane.over_clearance * round.pressure,
            );
        let first = pick(rebounds, ahead, f64::INFINITY);
        let longest = lane.structure.longest;
        let leap = leap(&next.state, lane.clearance);
        let longest = pick((leap > longest) & !hit, leap, longest);
        let looks_again = round.guess > 0.0;
        let tried = pick(looks_again, lane.length, 0.5 * lane.length);
        next.first = pick(passed, first, lane.first);
        next.length = pick(passed, longest.min(remaining).min(first), tried);
        next.again = pick(passed, 0.0, round.guess);
        next.again_far = round.far;
        next.tries = pick(passed, 0.0, lane.tries + 1.0);
        next.request = pick(!passed & ((round.meets > 0.0) | (next.tries > TRIES)), 1.0, 0.0);
        next.stopped = pick(passed & (round.whole > 0.0), 1.0, 0.0);
        let full = next.counts.full();
        next.full = pick(passed & full, 1.0, 0.0);
        lanes.set(i, &next);
    }
}
