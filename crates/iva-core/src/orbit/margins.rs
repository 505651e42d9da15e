//! How far a chain is from the next change of its sequence of impacts: the margins of the extrema of the gap displacement
//! between impacts.

use super::chain::Flown;
use super::coordinates::Coordinates;
use crate::absorber::Wall;
use crate::segment::flight::Motion;

/// Longest distance between two instants at which the gap velocity is looked at, in 1/ωn, and the least number of them in
/// a cycle: two extrema that are closer to each other may be overlooked.
const SPACING: f64 = 0.1;
const LEAST_LOOKS: f64 = 64.0;
/// Most steps of the search for an instant without gap velocity.
const MOST_STEPS: u32 = 100;

/// An extremum of the gap displacement between two impacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extremum {
    /// The flight that it is in.
    pub flight: usize,
    /// The wall that the absorber turns back from.
    pub wall: Wall,
    /// Its instant, in 1/ωn.
    pub time: f64,
    /// Its distance from that wall; below 0 beyond the wall.
    pub margin: f64,
}

/// The instant between two at which a function vanishes that has these values there, of opposite signs (the Illinois
/// variant of the false position).
fn zero([mut a, mut b]: [f64; 2], [mut at_a, mut at_b]: [f64; 2], of: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..MOST_STEPS {
        let middle = b - at_b * ((b - a) / (at_b - at_a));
        if middle == a || middle == b || middle.is_nan() {
            return middle.max(a.min(b)).min(a.max(b));
        }
        let value = of(middle);
        if value == 0.0 {
            return middle;
        }
        if (value < 0.0) == (at_b < 0.0) {
            at_a *= 0.5;
        } else {
            (a, at_a) = (b, at_b);
        }
        (b, at_b) = (middle, value);
    }
    b
}

/// Shows each instant of a chain at which a rate vanishes: the index of the flight, the instant, the motion with the time in
/// it, and the rate shortly before. The rate at the begin of a flight is that of its first state.
fn turnings<'a, S: Coordinates>(
    system: &'a S,
    flights: &[Flown<S::State>],
    cycle: f64,
    rates: (impl Fn(&S::State) -> f64, impl Fn(&S::Flight<'a>, f64) -> f64),
    mut see: impl FnMut((usize, f64), (&S::Flight<'a>, f64), f64),
) {
    let spacing = SPACING.min(cycle / LEAST_LOOKS);
    for (index, flown) in flights.iter().enumerate() {
        let (mut state, mut begin, mut left) = (flown.from, flown.begin, flown.length);
        let mut before = (rates.0)(&state);
        while left > 0.0 {
            let motion = system.flight(&state);
            let length = motion.reach().min(left);
            if length.is_nan() || length <= 0.0 {
                break;
            }
            let rate = |h: f64| (rates.1)(&motion, h);
            let looks = (length / spacing).ceil();
            for look in 1..=looks as usize {
                let [from, to] = [look - 1, look].map(|look| length * (look as f64 / looks));
                let now = rate(to);
                if before * now < 0.0 {
                    let h = zero([from, to], [before, now], rate);
                    see((index, begin + h), (&motion, h), before);
                }
                if now != 0.0 {
                    before = now;
                }
            }
            state = motion.arrival(length);
            begin += length;
            left -= length;
        }
    }
}

/// All extrema between the impacts of a chain over a cycle of this length.
pub(super) fn extrema<S: Coordinates>(
    system: &S,
    flights: &[Flown<S::State>],
    cycle: f64,
) -> Vec<Extremum> {
    let mut found = Vec::new();
    let rates = (
        |state: &S::State| system.rates(state)[2],
        |motion: &S::Flight<'_>, h: f64| motion.gap(h).w,
    );
    turnings(system, flights, cycle, rates, |(flight, time), (motion, h), before| {
        let wall = if before > 0.0 { Wall::Plus } else { Wall::Minus };
        let place = system.coordinates(&motion.state(h))[2] - system.offset();
        let margin = system.clearance() - wall.sign() * place;
        found.push(Extremum { flight, wall, time, margin });
    });
    found
}

/// The largest displacement of the structure in the flights of a chain, to either side.
pub(super) fn amplitude<S: Coordinates>(
    system: &S,
    flights: &[Flown<S::State>],
    cycle: f64,
) -> f64 {
    let begins = flights.iter().map(|flown| system.primary(&flown.from).x.abs());
    let mut largest = begins.fold(0.0, f64::max);
    let rates = (
        |state: &S::State| system.primary(state).v,
        |motion: &S::Flight<'_>, h: f64| motion.primary(h).rate,
    );
    turnings(system, flights, cycle, rates, |_, (motion, h), _| {
        largest = largest.max(motion.primary(h).value.abs());
    });
    largest
}
