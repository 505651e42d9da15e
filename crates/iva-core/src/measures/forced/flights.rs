//! The entries of the log of a driven run.

use crate::arrays::arrays;
use crate::compensated::DoubleDouble;
use crate::plain::State;
use crate::real::Real;
use crate::steady::Steady;
use crate::system::{Clock, Wall};

/// Number of flights side by side.
pub(super) const BLOCK: usize = 16;

arrays! {
    /// A flight.
    Flight,
    /// [`Flight`] of several: every field an array over them.
    Flights:
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
    /// f and f̂ at their begins, and at their ends; computed when the log is taken.
    pub forces: [[[f64; BLOCK]; 2]; 2],
}

impl Block {
    pub const fn new() -> Self {
        Self { flights: Flights::new(), forces: [[[0.0; BLOCK]; 2]; 2] }
    }

    /// The state at the begin of a flight.
    #[inline(always)]
    pub fn begin(&self, i: usize) -> State {
        let [[force, quadrature], _] = &self.forces;
        self.flights.get(i).begin([force[i], quadrature[i]])
    }

    /// The structure and its force at the end of a flight.
    #[inline(always)]
    fn end(&self, i: usize) -> State {
        let [_, [force, quadrature]] = &self.forces;
        let [x, v] = [self.flights.end_x[i], self.flights.end_v[i]];
        State { x, v, force: force[i], quadrature: quadrature[i], ..State::default() }
    }

    /// A flight as a part of itself.
    #[inline(always)]
    pub fn part(&self, i: usize) -> Part {
        Part { begin: self.begin(i), end: self.end(i), length: self.flights.length[i] }
    }
}

/// A part of a flight.
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
            Event::Impact(time, wall, approach) => steady.count(time.into(), wall, approach.into()),
            Event::Unlist(floor) => steady.unlist_up_to(floor.into()),
        }
    }
}
