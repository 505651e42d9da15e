//! One evaluation of a flight, and the decisions that follow from it.
//!
//! The operations and their order are those of the event loop, without branches. Where a lane cannot decide,
//! it keeps its state and requests its run.

use super::Struck;
use super::flying::{FAR, FULL, Flying, NEAR, SEARCH, STOP};
use crate::compensated::DoubleDouble;
use crate::force::{Push, Pushes};
use crate::host::{HostState, Moment, Structure};
use crate::lanes::counts::Hit;
use crate::lanes::pick;
use crate::oscillator::Primary;
use crate::quintic::root;
use crate::simulate::wall::REBOUND_LOOK;
use crate::siva::fast_flight::{LOOKS, Quintic, at_wall, to_wall};
use crate::siva::motion::arrived;
use crate::siva::{Law, SivaState, collided};

/// Below this value of u/(A (1 − e)), half the duration of the chatter that remains, the event loop may sum
/// the tail, so the rebound is left to it. (The estimated error of the sum is at least 4 times the cube of
/// this value.)
const LOW: f64 = 1e-4;

/// A type of which a lane can select one of two values without a branch.
pub(super) trait Pick {
    /// `yes` if `which`, else `no`.
    fn pick(which: bool, yes: &Self, no: &Self) -> Self;
}

impl Pick for () {
    #[inline(always)]
    fn pick(_which: bool, _yes: &Self, _no: &Self) {}
}

impl Pick for DoubleDouble {
    #[inline(always)]
    fn pick(which: bool, yes: &Self, no: &Self) -> Self {
        Self { value: pick(which, yes.value, no.value), rest: pick(which, yes.rest, no.rest) }
    }
}

impl Pick for Push {
    #[inline(always)]
    fn pick(which: bool, yes: &Self, no: &Self) -> Self {
        Self {
            value: DoubleDouble::pick(which, &yes.value, &no.value),
            rate: DoubleDouble::pick(which, &yes.rate, &no.rate),
            second: DoubleDouble::pick(which, &yes.second, &no.second),
            third: pick(which, yes.third, no.third),
        }
    }
}

impl Pick for Moment {
    #[inline(always)]
    fn pick(which: bool, yes: &Self, no: &Self) -> Self {
        Self {
            time: DoubleDouble::pick(which, &yes.time, &no.time),
            kicks: no.kicks,
            pushes: Pushes {
                primary: Push::pick(which, &yes.pushes.primary, &no.pushes.primary),
                base: Push::pick(which, &yes.pushes.base, &no.pushes.base),
            },
        }
    }
}

impl<P: Pick> Pick for SivaState<P> {
    #[inline(always)]
    fn pick(which: bool, yes: &Self, no: &Self) -> Self {
        Self {
            host: HostState {
                primary: Primary {
                    x: DoubleDouble::pick(which, &yes.host.primary.x, &no.host.primary.x),
                    v: DoubleDouble::pick(which, &yes.host.primary.v, &no.host.primary.v),
                },
                acceleration: DoubleDouble::pick(
                    which,
                    &yes.host.acceleration,
                    &no.host.acceleration,
                ),
                phase: P::pick(which, &yes.host.phase, &no.host.phase),
            },
            side: pick(which, yes.side, no.side),
            distance: DoubleDouble::pick(which, &yes.distance, &no.distance),
            rate: DoubleDouble::pick(which, &yes.rate, &no.rate),
        }
    }
}

/// The results of one evaluation.
pub(super) struct Look<P> {
    pub from: SivaState<P>,
    /// The state at the end of the completed span: in contact with the wall, if `hit`.
    pub end: SivaState<P>,
    /// Length of the completed span.
    pub length: f64,
    /// The state after the impact, if `hit`.
    after: SivaState<P>,
    /// The state at the wall, if `hit`.
    touching: SivaState<P>,
    approach: f64,
    pressure: f64,
    hit: bool,
    clock: DoubleDouble,
    remaining: f64,
    /// True if a span is completed.
    pub passed: bool,
    meets: bool,
    meets_far: bool,
    guess: f64,
    next_look: f64,
    looks_again: bool,
}

/// Evaluates a flight.
#[inline(always)]
pub(super) fn look<S: Structure<Real = f64, Phase: Pick>>(
    free: &S,
    course: &S::Course,
    lane: &Flying,
    from: SivaState<S::Phase>,
) -> Look<S::Phase> {
    let near = arrived(free, course, &from, lane.h);
    let search = lane.aim == SEARCH;
    let far = lane.aim == FAR;

    // The end of a whole stretch: it is proved free, or to have one contact, whose time is estimated.
    let whole = Quintic::new(free, &from, &near, lane.clearance, lane.h);
    let proof = whole.proof();
    let meets_far = proof.meets[1];
    let meets = search & !proof.free & (proof.meets[0] | meets_far);

    // Close to a wall: the contact, the impact, and whether the event loop has to handle what follows.
    let (later, close) = to_wall(free, &near, lane.clearance, far, lane.h);
    let touching = at_wall(free, &near, far, later);
    let share = DoubleDouble { value: lane.share, rest: lane.share_rest };
    let after = collided(free, &touching, &Law { restitution: lane.restitution, share });
    let approach = -touching.rate.value;
    let pressure = -(after.side * after.host.acceleration.value);
    let pressed = pressure > 0.0;
    let leaves = after.rate.value > 0.0;
    let low = (pressed & (after.rate.value < pressure * LOW * (1.0 - lane.restitution)))
        | (approach <= lane.floor);
    let hit = !search & close & leaves & !low;
    let next_look = lane.h + later;
    let looks_again = !search
        & !close
        & (next_look > 0.0)
        & (next_look <= lane.length)
        & (lane.looks < LOOKS as f64 - 1.0);

    // The completed span.
    let later = pick(hit, later, 0.0);
    let length = lane.h + later;
    let end = SivaState::pick(hit, &touching, &near);
    // Without a contact the quintic is one whose root is found at once.
    let (meeting, none) = (whole.meeting(meets_far), [1.0, -1.0, 0.0, 0.0, 0.0, 0.0]);
    let part = root(&std::array::from_fn(|i| pick(meets, meeting[i], none[i])));
    let clock = lane.clock().plus_parts(lane.h, later);
    let remaining = -clock.minus(lane.stop);
    // An impact at the end of the run is left to the event loop.
    let passed = ((search & proof.free) | hit) & (!hit | (remaining > 0.0));
    Look {
        from,
        end,
        length,
        after,
        touching,
        approach,
        pressure,
        hit,
        clock,
        remaining,
        passed,
        meets,
        meets_far,
        guess: lane.h * part,
        next_look,
        looks_again,
    }
}

impl<P: Pick> Look<P> {
    /// The state from which the flight goes on.
    #[inline(always)]
    pub fn next_state(&self) -> SivaState<P> {
        let end = SivaState::pick(self.hit, &self.after, &self.end);
        SivaState::pick(self.passed, &end, &self.from)
    }

    /// The flight after this evaluation.
    #[inline(always)]
    pub fn next(&self, lane: &Flying, reach: f64) -> Flying {
        let done = self.passed;
        let hit = self.hit & done;
        let good_guess = (self.guess > 0.0) & (self.guess <= lane.h);
        let mut next = *lane;
        next.request = pick(done | (self.meets & good_guess) | self.looks_again, 0.0, 1.0);
        next.put_state(&self.next_state());
        let remaining_before = -lane.clock().minus(lane.stop);
        let whole = !hit & (lane.h == remaining_before);
        let DoubleDouble { value, rest } = self.clock;
        (next.time, next.time_rest) =
            (pick(done, value, lane.time), pick(done, rest, lane.time_rest));
        let (v, side) = (self.touching.host.primary.v.value, self.touching.side);
        let impact = Hit { time: next.time, v, side, approach: self.approach };
        next.counts = lane.counts.after(done, hit, &impact);

        // The next evaluation.
        let rebounds = hit & (self.pressure > 0.0);
        let ahead = REBOUND_LOOK * self.after.rate.value / self.pressure;
        let first = pick(rebounds, ahead, f64::INFINITY);
        let length = reach.min(self.remaining).min(first);
        let looking = pick(self.meets, self.guess, self.next_look);
        let aim = pick(self.meets, pick(self.meets_far, FAR, NEAR), lane.aim);
        next.first = pick(done, first, lane.first);
        next.length = pick(done, length, lane.length);
        next.h = pick(done, length, looking);
        next.aim = pick(done, SEARCH, aim);
        next.looks = pick(done | self.meets, 0.0, lane.looks + 1.0);
        next.stopped = pick(done & whole, STOP, pick(done & next.counts.full(), FULL, 0.0));
        next
    }

    /// The impact at the end of the completed span, for the log of a decay.
    #[inline(always)]
    pub fn struck(&self) -> Struck {
        let hit = pick(self.hit & self.passed, 1.0, 0.0);
        Struck { hit, v_before: self.touching.host.primary.v.value }
    }

    /// The approach speed of the impact at the end of the completed span; 0: none.
    #[inline(always)]
    pub fn approach_speed(&self) -> f64 {
        pick(self.hit & self.passed, self.approach, 0.0)
    }
}
