//! Coasting: motion of a free mass that is too far inside its gap to meet a wall.
//!
//! Without drive |x| never exceeds the radius |Z| of the structure's motion, and a free mass in uniform motion
//! meets no wall while its displacement is within d − |Z|. So for a number of [`Steps`] no wall has to be searched
//! for.

use super::SivaState;
use crate::absorber::plain::State;
use crate::host::HostState;
use crate::host::oscillator::Primary;
use crate::host::steps::{MOST, Responses, Steps};
use crate::number::compensated::DoubleDouble;
use crate::number::real::{Real, pick};

/// Factors on the coasted time and on |Z|: margins for the rounding to single precision.
const SAFE: f64 = 1.0 - 1e-6;
const ABOVE: f64 = 1.0 + 1e-6;
/// Added to the speed over the clearance, so that it is not 0.
const SLOWEST: f64 = 1e-30;
/// 1.5 · 2⁵²: a number of moderate size added to it is rounded to an integer.
const TO_INTEGER: f64 = 6_755_399_441_055_744.0;

/// The number of steps from a state in which certainly no wall is met, at most those that the time `remaining` has.
/// `over` is 1/clearance, in units of which single precision will do.
#[inline(always)]
pub(crate) fn count<R: Real>(steps: &Steps<R>, at: &State, [over, remaining]: [f64; 2]) -> f64 {
    let State { x, v, distance, rate, side, .. } = *at;
    let (displaced, turned) = (x * over, steps.turned(x, v) * over);
    let radius = turned.mul_add(turned, displaced * displaced) as f32;
    let window = f64::from(radius.sqrt()).mul_add(-ABOVE, 1.0);
    let place = side.mul_add(distance.mul_add(-over, 1.0), displaced);
    let speed = side.mul_add(-rate, v) * over;
    let way = window - pick(speed < 0.0, -place, place);
    let time = f64::about(way, speed.abs() + SLOWEST).min(remaining);
    let count = (time * (SAFE * steps.over_length)).min(MOST as f64);
    let count = pick(place.abs() < window, count, 0.0);
    ((count - 0.5) + TO_INTEGER) - TO_INTEGER
}

/// The state after a number of steps with these responses.
#[inline(always)]
pub(crate) fn after<P: Copy, R: Real>(
    steps: &Steps<R>,
    from: &SivaState<P, R>,
    count: f64,
    responses: Responses<R>,
) -> SivaState<P, R> {
    let SivaState { host: HostState { primary, phase, .. }, side, distance, rate } = *from;
    let (to, acceleration) = steps.after(&primary, responses);
    let [distance, rate] = drifted([&primary, &to], side, [distance, rate], steps.time(count));
    SivaState { host: HostState { primary: to, acceleration, phase }, side, distance, rate }
}

/// Distance and rate of a free mass, measured from the wall of this sign, after a time in which the structure has come from
/// one place to another.
#[inline(always)]
pub(crate) fn drifted<R: Real>(
    [from, to]: [&Primary<R>; 2],
    side: R,
    [distance, rate]: [DoubleDouble<R>; 2],
    time: DoubleDouble<R>,
) -> [DoubleDouble<R>; 2] {
    let seen =
        |sum: DoubleDouble<R>| DoubleDouble { value: side * sum.value, rest: side * sum.rest };
    // The velocity of the absorber.
    let absorber = from.v - seen(rate);
    let moved = (to.x - from.x) - absorber.product(time);
    [distance + seen(moved), seen(to.v - absorber)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::absorber::siva::Siva;
    use crate::absorber::siva::motion::arrived;
    use crate::absorber::{Absorber, Start};
    use crate::host::Host;

    /// The fractional parts of multiples of an irrational number.
    fn spread(i: u32, k: u32) -> f64 {
        (f64::from(i) * f64::from(2 * k + 3).sqrt()).fract()
    }

    /// A free mass on a structure without drive, and a state in the gap, of which the structure moves by 0.3 at
    /// most.
    fn planted(i: u32) -> (Siva, SivaState) {
        let u = |k| spread(i, k);
        let damping_ratio = [0.0, 0.0085, 0.3, 0.8][(4.0 * u(0)) as usize];
        let siva = Siva::new(0.1, 0.5, 1.0, damping_ratio).unwrap();
        let start = Start {
            displacement: 0.2 * u(1),
            velocity: 0.2 * u(2),
            gap_displacement: 1.8 * u(3) - 0.9,
            gap_velocity: (2.0 * u(4) - 1.0) * 10f64.powf(-3.0 * u(5)),
        };
        let state = siva.begin(&start);
        (siva, state)
    }

    /// The motion by the power series, step by step: the reference is independent of the matrices.
    #[test]
    fn steps_are_those_of_the_series_and_meet_no_wall() {
        let (mut coasting, mut stopped) = (0, 0);
        for i in 1..2000 {
            let (siva, from) = planted(i);
            let all = Steps::new(siva.host.free());
            let length = all.time(1.0).value;
            let remaining = 12.0 * spread(i, 6);
            let steps = count(&all, &from.in_doubles(), [1.0, remaining]);
            assert!(length * steps <= remaining);
            let mut at = from;
            for k in 1..=steps as usize {
                for part in 1..=8 {
                    let h = length * f64::from(part) / 8.0;
                    let there = arrived(siva.host.free(), &(), &at, h);
                    let inside = 0.0 < there.distance.value && there.distance.minus(2.0) < 0.0;
                    assert!(inside, "{i}: {there:?}");
                }
                at = arrived(siva.host.free(), &(), &at, length);
                let responses = all.responses(k);
                let jump = after(&all, &from, k as f64, responses);
                let off = |a: DoubleDouble, b: DoubleDouble| (a - b).value.abs();
                let worst = off(jump.host.primary.x, at.host.primary.x)
                    .max(off(jump.host.primary.v, at.host.primary.v))
                    .max(off(jump.host.acceleration, at.host.acceleration))
                    .max(off(jump.distance, at.distance))
                    .max(off(jump.rate, at.rate));
                assert!(worst < 3e-17 * k as f64, "{i} {k}: {worst:e}");
            }
            coasting += u32::from(steps > 0.0);
            stopped += u32::from(steps < (remaining / length).floor());
        }
        assert!(coasting > 500 && stopped > 500, "{coasting} {stopped}");
    }
}
