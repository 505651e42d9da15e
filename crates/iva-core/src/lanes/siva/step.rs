//! One evaluation of a lane, and what follows from it.
//!
//! The same numbers in the same order as in the event loop and in [`Measures`](crate::measures::Measures),
//! without branches. What a lane cannot do here it leaves as it is, and asks for care.

use super::lane::{FAR, FULL, Lane, NEAR, SEARCH, STOP};
use crate::compensated::Sum;
use crate::lanes::pick;
use crate::lanes::watch::{Passage, Stretch};
use crate::oscillator::Oscillator;
use crate::quintic::root;
use crate::real::Real;
use crate::simulate::wall::REBOUND_LOOK;
use crate::siva::SivaState;
use crate::siva::collided;
use crate::siva::motion::arrived;
use crate::siva::stride::{LOOKS, Quintic, at_wall, to_wall, turn, turning};

/// A rebound this low against what presses, u/(A (1 − e)), may be one whose tail is summed: that is for
/// the loop. (The estimated error of the sum is at least 4 times the cube of it.)
const LOW: f64 = 1e-4;

#[inline(always)]
fn pick_sum(which: bool, yes: Sum, no: Sum) -> Sum {
    Sum { value: pick(which, yes.value, no.value), rest: pick(which, yes.rest, no.rest) }
}

#[inline(always)]
fn pick_state(which: bool, yes: &SivaState, no: &SivaState) -> SivaState {
    SivaState {
        primary: crate::oscillator::Primary {
            x: pick_sum(which, yes.primary.x, no.primary.x),
            v: pick_sum(which, yes.primary.v, no.primary.v),
        },
        acceleration: pick_sum(which, yes.acceleration, no.acceleration),
        side: pick(which, yes.side, no.side),
        distance: pick_sum(which, yes.distance, no.distance),
        rate: pick_sum(which, yes.rate, no.rate),
    }
}

/// The lane after one evaluation.
#[inline(always)]
pub(super) fn step<const LEDGER: bool>(free: &Oscillator, lane: &Lane) -> Lane {
    let from = lane.state();
    let near = arrived(free, &from, lane.h);
    let search = lane.aim == SEARCH;
    let far = lane.aim == FAR;

    // A stretch as a whole: is it free, or where is its only contact?
    let quintic = Quintic::new(free, &from, &near, lane.clearance, lane.h);
    let proof = quintic.proof();
    let meets_far = proof.meets[1];
    let meets = search & !proof.free & (proof.meets[0] | meets_far);

    // Close to a wall: the contact, the impact, and whether the loop has to see to what follows.
    let (later, close) = to_wall(free, &near, lane.clearance, far, lane.h);
    let touching = at_wall(free, &near, far, later);
    let share = Sum { value: lane.share, rest: lane.share_rest };
    let after = collided(free, &touching, share, lane.restitution);
    let approach = -touching.rate.value;
    let pressure = -(after.side * after.acceleration.value);
    let pressed = pressure > 0.0;
    let leaves = after.rate.value > 0.0;
    let low = (pressed & (after.rate.value < LOW * pressure * (1.0 - lane.restitution)))
        | (approach <= lane.floor);
    let hit = !search & close & leaves & !low;
    let next_look = lane.h + later;
    let looks_again = !search
        & !close
        & (next_look > 0.0)
        & (next_look <= lane.length)
        & (lane.looks < LOOKS as Real - 1.0);

    // The span that is behind then.
    let later = pick(hit, later, 0.0);
    let length = lane.h + later;
    let end = pick_state(hit, &touching, &near);
    // Where the wall is met, or else where x turns round: never both at once.
    let (meeting, turn) = (quintic.meeting(meets_far), turn(free, &from, &end, length));
    let part = root(&std::array::from_fn(|i| pick(meets, meeting[i], turn[i])));
    let guess = lane.h * part;
    let good_guess = (guess > 0.0) & (guess <= lane.h);
    let span = Span::of::<LEDGER>(free, lane, &from, &end, [length, length * part]);
    let passed = (search & proof.free) | hit;
    let clock = lane.clock().plus_parts(lane.h, later);
    let remaining = -clock.minus(lane.stop);
    // An impact at the very instant of a stop is for the loop.
    let done = passed & span.simple & (!hit | (remaining > 0.0));
    let hit = hit & done;

    let mut next = *lane;
    next.care = pick(done | (meets & good_guess) | looks_again, 0.0, 1.0);
    next.put_state(&pick_state(done, &pick_state(hit, &after, &near), &from));
    let remaining_before = -lane.clock().minus(lane.stop);
    let whole = !hit & (lane.h == remaining_before);
    (next.time, next.time_rest) =
        (pick(done, clock.value, lane.time), pick(done, clock.rest, lane.time_rest));
    next.work = lane.work + pick(done, 1.0, 0.0);
    strike(&mut next, lane, hit, &touching, approach);
    span.measure(&mut next, lane, done);

    // What comes next.
    let first = pick(hit & pressed, REBOUND_LOOK * after.rate.value / pressure, Real::INFINITY);
    let length = free.reach.min(remaining).min(first);
    let looking = pick(meets, guess, next_look);
    let aim = pick(meets, pick(meets_far, FAR, NEAR), lane.aim);
    next.first = pick(done, first, lane.first);
    next.length = pick(done, length, lane.length);
    next.h = pick(done, length, looking);
    next.aim = pick(done, SEARCH, aim);
    next.looks = pick(done | meets, 0.0, lane.looks + 1.0);
    next.stopped = pick(done & whole, STOP, pick(done & next.full(), FULL, 0.0));
    next
}

/// Counts an impact.
#[inline(always)]
fn strike(next: &mut Lane, lane: &Lane, hit: bool, touching: &SivaState, approach: Real) {
    let loss = lane.loss_factor * (approach * approach);
    let losses = Sum { value: lane.losses, rest: lane.losses_rest }.plus(loss);
    next.losses = pick(hit, losses.value, lane.losses);
    next.losses_rest = pick(hit, losses.rest, lane.losses_rest);
    let v = touching.primary.v.value;
    let absorber = v + touching.side * approach;
    next.impacts = lane.impacts + pick(hit, 1.0, 0.0);
    next.effective = lane.effective + pick(hit & (v * absorber < 0.0), 1.0, 0.0);
    let fresh = hit & (lane.streak_side != touching.side);
    next.streak_side = pick(hit, touching.side, lane.streak_side);
    next.streak_start = pick(fresh, next.time, lane.streak_start);
    next.streak_listed = pick(fresh, lane.impacts, lane.streak_listed);
    next.streak_loss = pick(fresh, 0.0, lane.streak_loss) + pick(hit, loss, 0.0);
}

/// A stretch of motion with where it begins.
struct Span {
    origin: [Real; 3],
    stretch: Stretch,
    simple: bool,
}

impl Span {
    #[inline(always)]
    fn of<const LEDGER: bool>(
        free: &Oscillator,
        lane: &Lane,
        from: &SivaState,
        end: &SivaState,
        [length, turn]: [Real; 2],
    ) -> Self {
        let (x, v) = (from.primary.x.value, from.primary.v.value);
        let turns = v * end.primary.v.value < 0.0;
        let (h_turn, x_turn, exact) = turning(free, from, turn, length);
        let (h_turn, x_turn) = (pick(turns, h_turn, 0.0), pick(turns, x_turn, x));
        let loss = if LEDGER { free.viscous_loss_series(x, v, length) } else { 0.0 };
        let (x_end, h) = (end.primary.x.value, [0.0, h_turn, length]);
        let stretch = Stretch { x: [x, x_turn, x_end], h, turns, loss };
        let simple = (exact | !turns) & stretch.ends(lane.watch.peak_sign).simple();
        Self { origin: [x, v, from.acceleration.value], stretch, simple }
    }

    /// Takes the span into the measures, if it is `done`.
    #[inline(always)]
    fn measure(&self, next: &mut Lane, lane: &Lane, done: bool) {
        next.watch = lane.watch.after(&self.stretch, lane.clock(), done);
        macro_rules! passage {
            ($share:expr, $level:ident, $x:ident, $v:ident, $a:ident, $time:ident, $rest:ident, $from:ident, $to:ident) => {
                let Passage { passes, h: [from, to], level } =
                    self.stretch.passage($share * lane.watch.amplitude);
                let passes = passes & done;
                next.$level = pick(passes, level, lane.$level);
                next.$x = pick(passes, self.origin[0], lane.$x);
                next.$v = pick(passes, self.origin[1], lane.$v);
                next.$a = pick(passes, self.origin[2], lane.$a);
                next.$time = pick(passes, lane.time, lane.$time);
                next.$rest = pick(passes, lane.time_rest, lane.$rest);
                next.$from = pick(passes, from, lane.$from);
                next.$to = pick(passes, to, lane.$to);
            };
        }
        passage!(0.10, level_1, x_1, v_1, a_1, time_1, time_rest_1, from_1, to_1);
        passage!(0.05, level_2, x_2, v_2, a_2, time_2, time_rest_2, from_2, to_2);
        passage!(0.02, level_3, x_3, v_3, a_3, time_3, time_rest_3, from_3, to_3);
    }
}
