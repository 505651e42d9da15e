//! One round of a lane after its trial: the decision whether the lane can go on by itself, and the impact, the
//! clock and the next trial.

use super::lane::Lane;
use crate::arrays::arrays;
use crate::lanes::counts::Hit;
use crate::lanes::pick;
use crate::siva::trial::{FreeMass, Landing, Sight, TRIES};
use crate::system::Clock;

/// Below this value of u/(A (1 − e)), half the duration of the chatter that remains, the event loop may sum
/// the tail, so the rebound is left to it. (The estimated error of the sum is at least 4 times the cube of
/// this value.)
const LOW: f64 = 1e-4;

arrays! {
    /// The results of one round of a lane.
    Round,
    /// [`Round`] of many runs: every field an array over the lanes.
    Rounds:
    /// [`Sight`]: 1 if no wall is met; 1 if a wall is met; 1 if that is the far wall; the end of the trial, or the
    /// estimated time of the contact.
    free, meets, far, h,
    /// 1 if a stretch is completed; 1 if it ends with an impact; the low part of its length; 1 if the run ends
    /// with it.
    passed, hit, later, whole,
    /// ẋ, the rate of the distance at its end, before an impact, and the sign of the wall; the rate and the pressure after the impact.
    v, rate, side, rebound, pressure,
    /// The time at which the wall is looked for again (0: it is not).
    again,
}

impl Round {
    /// What is proved about a trial.
    #[inline(always)]
    pub fn of(sight: &Sight) -> Self {
        Self {
            free: pick(sight.free, 1.0, 0.0),
            meets: pick(sight.meets, 1.0, 0.0),
            far: pick(sight.far, 1.0, 0.0),
            h: sight.h,
            ..Self::default()
        }
    }

    /// What is proved about a trial.
    #[inline(always)]
    pub fn sight(&self) -> Sight {
        let Self { free, meets, far, h, .. } = *self;
        Sight { free: free > 0.0, meets: meets > 0.0, far: far > 0.0, h }
    }
}

/// Decides about a trial that has landed; the state at its end, after an impact. Low rebounds, and impacts at the
/// end of the run, are left to the event loop.
#[inline(always)]
pub(super) fn decide<M: FreeMass<Real = f64>>(
    mass: &M,
    lane: &Lane,
    sight: &Sight,
    landing: &Landing<M::State>,
) -> (Round, M::State) {
    let Landing { hit, h, later, end, again } = landing;
    let law = lane.law();
    let after = mass.struck(end, *hit, &law);
    let ([v, side], [_, rate, _]) = (mass.beside(end), mass.curve(end));
    let [_, rebound, bend] = mass.curve(&after);
    let pressure = -bend;
    let low = ((pressure > 0.0) & (rebound < pressure * (LOW * (1.0 - law.restitution))))
        | (-rate <= lane.floor)
        | (rebound <= 0.0);
    let before = lane.clock().plus_parts(*h, *later).minus(lane.stop) < 0.0;
    let simple = *hit & !low & before;
    let round = Round {
        passed: pick(simple | sight.free, 1.0, 0.0),
        hit: pick(simple, 1.0, 0.0),
        later: *later,
        whole: pick(sight.free & (lane.length == lane.remaining()), 1.0, 0.0),
        v,
        rate,
        side,
        rebound,
        pressure,
        again: *again,
        ..Round::of(sight)
    };
    (round, after)
}

/// Applies impact and clock, and chooses the next trial. `longest` limits its length, `first` that after a rebound
/// from a pressing wall.
#[inline(always)]
pub(super) fn commit(lane: &Lane, round: &Round, clock: Clock, [longest, first]: [f64; 2]) -> Lane {
    let (passed, hit) = (round.passed > 0.0, round.hit > 0.0);
    let Round { v, rate, side, again, far, .. } = *round;
    let impact = Hit { time: clock.value, v, side, approach: -rate };
    let mut next = *lane;
    next.counts = lane.counts.after(passed, hit, &impact);
    (next.time, next.time_rest) =
        (pick(passed, clock.value, lane.time), pick(passed, clock.rest, lane.time_rest));

    let rebounds = hit & (round.pressure > 0.0);
    let first = pick(rebounds, first, f64::INFINITY);
    let tried = lane.trial().next(again, far > 0.0);
    let remaining = -clock.minus(lane.stop);
    next.first = pick(passed, first, lane.first);
    next.length = pick(passed, longest.min(remaining).min(first), tried.length);
    next.again = pick(passed, 0.0, again);
    next.again_far = far;
    next.tries = pick(passed, 0.0, lane.tries + 1.0);
    let stuck = (round.meets > 0.0) & (again == 0.0);
    next.request = pick(!passed & (stuck | (next.tries > TRIES as f64)), 1.0, 0.0);
    next.stopped = pick(passed & (round.whole > 0.0), 1.0, 0.0);
    next.full = pick(passed & next.counts.full(), 1.0, 0.0);
    next
}
