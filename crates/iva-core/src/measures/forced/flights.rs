//! The entries of the log of a driven run.

use crate::absorber::plain::{State, Structure};
use crate::absorber::{Clock, Wall};
use crate::measures::steady::Steady;
use crate::number::arrays::{Lanes as _, arrays};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::number::trigonometry::factorials;
use crate::segment::taylor::unrolled;

/// Number of flights side by side.
pub(super) const BLOCK: usize = 16;

arrays! {
    /// A flight.
    Flight, Flights:
    /// The clock at its begin in double-double, and its length.
    time, time_rest, length,
    /// The state at its begin: x and ẋ; distance to the wall last touched, its rate, and the sign of that wall.
    x, v, distance, rate, side,
    /// x and ẋ at its end, before the impact.
    end_x, end_v,
    /// The impact at its end: its instant, approach speed (0: there is none), and sign of the wall.
    impact_time, approach, wall,
}

impl Flight {
    /// The clock at its begin.
    #[inline(always)]
    pub fn clock(&self) -> Clock {
        DoubleDouble { value: self.time, rest: self.time_rest }
    }

    /// The state at its begin, under this force.
    #[inline(always)]
    pub fn begin(&self, [force, quadrature]: [f64; 2]) -> State {
        let Self { x, v, distance, rate, side, .. } = *self;
        State { x, v, force, quadrature, distance, rate, side }
    }
}

/// Flights side by side, with their forces.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct Block {
    pub flights: Flights<BLOCK>,
    /// f and f̂ at their begins, in their middles and at their ends; computed when the log is taken.
    begin: [[f64; BLOCK]; 2],
    middle: [[f64; BLOCK]; 2],
    end: [[f64; BLOCK]; 2],
}

impl Block {
    pub fn new() -> Self {
        let [begin, middle, end] = [[[0.0; BLOCK]; 2]; 3];
        Self { flights: Flights::new(), begin, middle, end }
    }

    /// Computes the forces: at the begins from the clock, and from there on by turning.
    #[inline(always)]
    pub fn put_forces(&mut self, structure: &Structure) {
        let Flights { time, time_rest, length, .. } = self.flights;
        let [mut begin, mut middle, mut end] = [[[0.0; BLOCK]; 2]; 3];
        for i in 0..BLOCK {
            let clock = DoubleDouble { value: time[i], rest: time_rest[i] };
            [begin[0][i], begin[1][i]] = structure.force_at(clock);
        }
        let half = 0.5 * structure.frequency;
        for i in 0..BLOCK {
            let [sine, cosine] = turned(half * length[i]);
            let [twice, versine] = [2.0 * sine * cosine, 2.0 * sine * sine];
            let (force, quadrature) = (begin[0][i], begin[1][i]);
            middle[0][i] = force.mul_add(cosine, -(quadrature * sine));
            middle[1][i] = quadrature.mul_add(cosine, force * sine);
            end[0][i] = force - force.mul_add(versine, quadrature * twice);
            end[1][i] = quadrature - quadrature.mul_add(versine, -(force * twice));
        }
        (self.begin, self.middle, self.end) = (begin, middle, end);
    }

    /// The state at the begin of a flight.
    #[inline(always)]
    pub fn begin(&self, i: usize) -> State {
        let [force, quadrature] = &self.begin;
        self.flights.get(i).begin([force[i], quadrature[i]])
    }

    /// The force in the middle of a flight.
    #[inline(always)]
    pub fn middle(&self, i: usize) -> [f64; 2] {
        let [force, quadrature] = &self.middle;
        [force[i], quadrature[i]]
    }

    /// The structure and its force at the end of a flight.
    #[inline(always)]
    fn end(&self, i: usize) -> State {
        let [force, quadrature] = &self.end;
        let [x, v] = [self.flights.end_x[i], self.flights.end_v[i]];
        State { x, v, force: force[i], quadrature: quadrature[i], ..State::default() }
    }

    /// A flight between its ends.
    #[inline(always)]
    pub fn part(&self, i: usize) -> Part {
        Part { begin: self.begin(i), end: self.end(i), length: self.flights.length[i] }
    }
}

/// Sine and cosine of an angle from 0 to 1: that of a force in half of a flight.
#[inline(always)]
pub(super) fn turned(angle: f64) -> [f64; 2] {
    /// The coefficients of sin r/r and cos r in powers of r².
    const SINE: [f64; 10] = factorials(1);
    const COSINE: [f64; 10] = factorials(0);
    let z = angle * angle;
    let (mut sine, mut cosine) = (SINE[9], COSINE[9]);
    unrolled!(k < 9 => {
        sine = sine.mul_add(z, SINE[8 - k]);
        cosine = cosine.mul_add(z, COSINE[8 - k]);
    });
    [angle * sine, cosine]
}

/// A flight between its ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Part {
    pub begin: State,
    /// The structure and its force at the end.
    pub end: State,
    pub length: f64,
}

/// An event that is no flight.
#[derive(Debug, Clone, Copy)]
pub(super) enum Event {
    /// An impact that no logged flight contains: its instant, wall and approach speed.
    Impact(f64, Wall, f64),
    /// Impacts up to this approach speed turned out to belong to a chatter that ended in stick, and are not
    /// listed.
    Unlist(f64),
}

impl Event {
    /// Hands it out.
    pub fn show<R: Real>(&self, steady: &mut Steady<R>) {
        match *self {
            Event::Impact(time, wall, approach) => {
                steady.count(time.into(), (0, wall), approach.into())
            }
            Event::Unlist(floor) => steady.unlist_up_to(0, floor.into()),
        }
    }
}
