//! How far a chain is from the next change of its sequence of impacts: the margins of the extrema of the gap displacement
//! between impacts.

use super::chain::{Flown, Passed};
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
    /// The index of the impact of the chain that comes before.
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

/// Shows each instant of flights or rides at which a rate vanishes: which one, the instant, the motion with the time in
/// it, and the rate shortly before. The rate at the begin of a flight is that of its first state.
fn turnings<State: Copy, M: Motion<Real = f64, State = State>>(
    flights: &[Flown<State>],
    cycle: f64,
    go_on: impl Fn(&State) -> M,
    rates: (impl Fn(&State) -> f64, impl Fn(&M, f64) -> f64),
    mut see: impl FnMut((usize, f64), (&M, f64), f64),
) {
    let spacing = SPACING.min(cycle / LEAST_LOOKS);
    for flown in flights {
        let (mut state, mut begin, mut left) = (flown.from, flown.begin, flown.length);
        let mut before = (rates.0)(&state);
        while left > 0.0 {
            let motion = go_on(&state);
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
                    see((flown.after, begin + h), (&motion, h), before);
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

/// The distance of y, from the middle of the gap, to a wall; infinite where there is none.
pub(super) fn margin<S: Coordinates>(system: &S, wall: Wall, y: f64) -> f64 {
    margin_of(system, 0, wall, y)
}

/// The same of the absorber of this index.
pub(super) fn margin_of<S: Coordinates>(system: &S, absorber: usize, wall: Wall, y: f64) -> f64 {
    let [minus, plus] = system.walls_of(absorber);
    match wall {
        Wall::Plus if plus.is_infinite() => plus,
        Wall::Minus if minus.is_infinite() => -minus,
        _ => system.clearance_of(absorber) - wall.sign() * y,
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
    let go_on = |state: &S::State| system.flight(state);
    turnings(flights, cycle, go_on, rates, |(flight, time), (motion, h), before| {
        let wall = if before > 0.0 { Wall::Plus } else { Wall::Minus };
        let place = system.coordinates(&motion.state(h))[2];
        let margin = margin(system, wall, place);
        found.push(Extremum { flight, wall, time, margin });
    });
    found
}

/// The largest displacement of the structure in a chain, to either side.
pub(super) fn amplitude<S: Coordinates>(
    system: &S,
    Passed { flights, rides, .. }: &Passed<S::State>,
    cycle: f64,
) -> f64 {
    let flying = |state: &S::State| system.flight(state);
    let riding = |state: &S::State| system.ride(state);
    largest(system, flights, cycle, flying).max(largest(system, rides, cycle, riding))
}

fn largest<S: Coordinates, M: Motion<Real = f64, State = S::State>>(
    system: &S,
    flights: &[Flown<S::State>],
    cycle: f64,
    go_on: impl Fn(&S::State) -> M,
) -> f64 {
    let begins = flights.iter().map(|flown| system.primary(&flown.from).x.abs());
    let mut largest = begins.fold(0.0, f64::max);
    let rate = |state: &S::State| system.primary(state).v;
    let later = |motion: &M, h: f64| motion.primary(h).rate;
    turnings(flights, cycle, go_on, (rate, later), |_, (motion, h), _| {
        largest = largest.max(motion.primary(h).value.abs());
    });
    largest
}
