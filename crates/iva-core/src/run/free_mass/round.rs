//! One round of a lane after its trial: the decision whether the lane can go on by itself, and the impact, the
//! clock and the next trial.

use super::lane::Lane;
use crate::absorber::Clock;
use crate::absorber::chatter::may_end;
use crate::absorber::plain::State;
use crate::absorber::siva::trial::{FreeMass, Landing, Sight, TRIES, Trial, land};
use crate::engine::counts::Counted;
use crate::number::arrays::{Laned, arrays};
use crate::number::real::pick;

arrays! {
    /// The results of one round of a lane.
    Round, Rounds:
    /// The low part of the length of the stretch.
    later,
    /// ẋ, the rate of the distance at its end, before an impact, and the sign of the wall; the pressure after the
    /// impact, and the longest first trial if that is positive.
    v, rate, side, pressure, first,
    /// The time at which the wall is looked for again (0: it is not).
    again;
    /// What is proved about the trial.
    sight: Sight,
    /// True if a stretch is completed; if it ends with an impact; if the run ends with it.
    passed: bool, hit: bool, whole: bool,
}

/// The end of a trial and the decision about it; the state there, after an impact. Low rebounds, and impacts at the
/// end of the run, are left to the event loop.
#[inline(always)]
pub(super) fn decide<M: FreeMass<Real = f64>>(
    mass: &M,
    lane: &Lane,
    from: &M::State,
    sight: &Sight,
) -> (Round, M::State) {
    let size = [lane.clearance, lane.over_clearance];
    let Landing { hit, h, later, end, again } = land(mass, from, sight, lane.trial.length, size);
    let State { v, side, rate, .. } = M::in_doubles(&end);
    let law = lane.law(side);
    let after = mass.struck(&end, hit, &law);
    let [_, rebound, bend] = mass.curve(&after);
    let pressure = -bend;
    let low = may_end(rebound, pressure, law.restitution) | (-rate <= lane.progress.floor);
    let before = lane.progress.clock.plus_parts(h, later).minus(lane.progress.stop) < 0.0;
    let simple = hit & !low & before;
    let round = Round {
        sight: *sight,
        passed: simple | sight.free,
        hit: simple,
        later,
        whole: sight.free & (lane.trial.length == lane.progress.remaining()),
        v,
        rate,
        side,
        pressure,
        first: M::rebound(rebound, pressure, lane.over_clearance),
        again,
    };
    (round, after)
}

/// Applies impact and clock, and chooses the next trial. `longest` limits its length.
#[inline(always)]
pub(super) fn commit(lane: &Lane, round: &Round, clock: Clock, longest: f64) -> Lane {
    let Round { passed, hit, v, rate, side, again, sight, .. } = *round;
    let approach = -rate;
    let impact = Counted {
        time: clock.value,
        side,
        approach,
        energy_loss: lane.law(side).lost(approach),
        effective: v * (v + side * approach) < 0.0,
        low: false,
    };
    let first = pick(hit & (round.pressure > 0.0), round.first, f64::INFINITY);
    let progress = lane.progress.moved(passed, clock, first).struck(hit, &impact);
    let trial = Trial::new(longest.min(progress.ahead()));
    let tries = pick(passed, 0.0, lane.tries + 1.0);
    let stuck = sight.meets & (again == 0.0);
    let next = Lane {
        progress,
        trial: Laned::pick(passed, &trial, &lane.trial.next(again, sight.far)),
        tries,
        request: !passed & (stuck | (tries > TRIES as f64)),
        stopped: passed & round.whole,
        ..*lane
    };
    Lane { full: passed & next.progress.is_full(), ..next }
}
