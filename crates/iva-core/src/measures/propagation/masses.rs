//! How errors grow in a run of several free masses.
//!
//! The variables are x and ẋ of the structure, then y and ẏ of each mass. All masses fly in one motion of the structure, so the
//! derivative of a motion is that of [`crate::absorber::siva`] for each of them; a stuck mass has y and ẏ of its own no
//! more. Impacts at one instant are taken for one contact, which small errors do not divide.

use nalgebra::{SMatrix, SVector};

use super::errors::{DEVIATIONS, GRAZING, LOST, ROUNDING, UNIT};
use crate::absorber::derivatives::columns;
use crate::absorber::several::{MOST, Several, SeveralState};
use crate::absorber::{Absorber, ImpactLaw, OnStructure, Point, Wall};
use crate::host::Host;

/// Number of variables.
const SIZE: usize = 2 + 2 * MOST;

type Square = SMatrix<f64, SIZE, SIZE>;
type Column = SVector<f64, SIZE>;

/// The indices of y and ẏ of a mass.
fn of(absorber: usize) -> [usize; 2] {
    [2 + 2 * absorber, 3 + 2 * absorber]
}

/// The errors of a state, and its derivative.
#[derive(Debug, Clone)]
pub(super) struct Grown {
    covariance: Square,
    derivative: Square,
    /// The instant of the last event, and the rates of all variables there.
    begun: (f64, Column),
    /// Which masses are stuck since then.
    stuck: [bool; MOST],
    /// The wall that each mass has met last.
    walls: [Option<Wall>; MOST],
    /// The length that a condition is relative to.
    unit: f64,
    pub condition: f64,
    /// The error of the instant of the last impact of each mass, and whether it is close to a grazing.
    last: [(f64, bool); MOST],
    /// True once the estimate has reached [`LOST`].
    pub lost: bool,
}

/// Which masses are stuck in a state.
fn stuck_in<H: Host<Real = f64>>(state: &SeveralState<H>) -> [bool; MOST] {
    state.masses.map(|mass| mass.stuck)
}

impl Grown {
    pub fn at<H: Host<Real = f64>>(
        system: &Several<H>,
        state: &SeveralState<H>,
        time: f64,
    ) -> Self {
        let x = system.primary(state).x.abs();
        Self {
            covariance: Square::zeros(),
            derivative: Square::identity(),
            begun: (time, rates(system, state)),
            stuck: stuck_in(state),
            walls: [None; MOST],
            unit: if x > 0.0 { x } else { system.clearance() },
            condition: 0.0,
            last: [(0.0, false); MOST],
            lost: false,
        }
    }

    fn carry(&mut self, map: &Square) {
        self.covariance = map * self.covariance * map.transpose();
        self.derivative = map * self.derivative;
    }

    /// Adds an independent error of this standard deviation to a variable.
    fn add(&mut self, variable: usize, deviation: f64) {
        self.covariance[(variable, variable)] += deviation * deviation;
    }

    fn deviation(&self, variable: usize) -> f64 {
        self.covariance[(variable, variable)].sqrt()
    }

    /// The motion since the last event ends at an instant, in a state.
    pub fn turn<H: Host<Real = f64>>(
        &mut self,
        system: &Several<H>,
        time: f64,
        state: &SeveralState<H>,
    ) {
        let (begin, first) = self.begun;
        let h = time - begin;
        let mut moving = *state;
        for (mass, stuck) in moving.masses.iter_mut().zip(self.stuck) {
            mass.stuck = stuck;
        }
        let last = rates(system, &moving);
        self.begun = (time, rates(system, state));
        if h <= 0.0 || self.lost {
            return;
        }
        self.carry(&flow(system, &moving, h));
        // A long motion may be fastest in between, up to the root mean square of its velocity.
        let Point { x, v } = system.primary(state);
        let most = (0.5 * (x * x + v * v)).sqrt();
        let fastest = first.abs().sup(&last.abs());
        let mut round = |variable: usize, change: usize| {
            let between = (0.25 * h * fastest[change]).min(most);
            self.add(variable, UNIT * ROUNDING * h * fastest[variable].max(between));
        };
        round(0, 1);
        round(1, 0);
        for absorber in (0..system.absorbers()).filter(|k| !moving.masses[*k].stuck) {
            let [y, w] = of(absorber);
            round(y, w);
            round(w, 0);
        }
    }

    /// An impact at an instant between two states, of the absorber at hand and of all that touch their walls with it:
    /// the error of the instant for the one at hand, and whether it is close to a grazing.
    pub fn struck<H: Host<Real = f64>>(
        &mut self,
        system: &Several<H>,
        time: f64,
        [before, after]: [&SeveralState<H>; 2],
    ) -> (f64, bool) {
        let at_hand = system.at_hand(before);
        let struck: Vec<usize> = (0..system.absorbers())
            .filter(|k| {
                let mass = &before.masses[*k];
                !mass.stuck && mass.distance.value == 0.0 && mass.rate.value < 0.0
            })
            .collect();
        // All of one instant are taken at the first of them.
        if struck.first() == Some(&at_hand) {
            self.turn(system, time, before);
            for &absorber in &struck {
                self.last[absorber] = self.met(system, before, absorber);
            }
            if !self.lost {
                self.jump(system, &struck, [before, after]);
            }
            self.begun = (time, rates(system, after));
            self.stuck = stuck_in(after);
        }
        self.last[at_hand]
    }

    /// The error of the instant at which a mass meets its wall.
    fn met<H: Host<Real = f64>>(
        &mut self,
        system: &Several<H>,
        before: &SeveralState<H>,
        absorber: usize,
    ) -> (f64, bool) {
        let [y, _] = of(absorber);
        let seen = system.turned_to(before, absorber);
        let (wall, distance) = (system.wall(&seen), system.distance(&seen));
        let met = self.walls[absorber].replace(wall);
        if met.is_some_and(|met| met != wall) {
            self.add(y, UNIT * system.clearance_of(absorber));
        }
        let (approach, bend) = (distance.rate.abs(), distance.curvature.abs());
        let beside = DEVIATIONS * self.deviation(y);
        let margin = approach * approach - 2.0 * bend * beside;
        let error = 2.0 * beside / (approach + margin.max(0.0).sqrt());
        self.lost |= !error.is_finite() || error >= LOST || approach == 0.0;
        if !self.lost {
            let largest = self.derivative.row(y).amax();
            self.condition = self.condition.max((self.unit / approach) * largest);
        }
        (error, bend * beside > GRAZING * (approach * approach))
    }

    /// Carries the errors through an impact of some masses, by the saltation matrix of the first of them.
    fn jump<H: Host<Real = f64>>(
        &mut self,
        system: &Several<H>,
        struck: &[usize],
        [before, after]: [&SeveralState<H>; 2],
    ) {
        let Some(&first) = struck.first() else { return };
        let masses = system.masses();
        let together: f64 = (0..masses.len())
            .filter(|k| struck.contains(k) || after.masses[*k].stuck)
            .fold(1.0, |sum, k| sum + masses[k].mass_ratio);
        let mut jump = Square::identity();
        let left = |k: usize| before.masses[k].stuck && !after.masses[k].stuck;
        for k in (0..masses.len()).filter(|k| left(*k)) {
            let [_, w] = of(k);
            jump[(w, w)] = 0.0;
        }
        for &k in struck {
            let [_, w] = of(k);
            let seen = system.turned_to(before, k);
            let slope = system.law_of(k, system.wall(&seen), -before.masses[k].rate.value).slope;
            let share = masses[k].mass_ratio * (1.0 + slope) / together;
            jump[(1, w)] = share;
            jump[(w, w)] = -slope;
            for j in (0..masses.len()).filter(|j| !struck.contains(j) && !after.masses[*j].stuck) {
                jump[(of(j)[1], w)] = -share;
            }
        }
        let [f, f_after] = [before, after].map(|state| rates(system, state));
        let [y, _] = of(first);
        let mut saltation = jump;
        let moved = (f_after - jump * f) / f[y];
        for (row, moved) in moved.iter().enumerate() {
            saltation[(row, y)] += moved;
        }
        self.carry(&saltation);
        for variable in [0].into_iter().chain(struck.iter().map(|k| of(*k)[0])) {
            self.add(variable + 1, UNIT * ROUNDING * f_after[variable].abs());
        }
    }

    /// The absorber at hand sticks. Stick follows an impact at once: the duration of a summed tail is part of the ride.
    pub fn stick<H: Host<Real = f64>>(&mut self, system: &Several<H>, state: &SeveralState<H>) {
        let at_hand = system.at_hand(state);
        let masses = system.masses();
        let with = (0..masses.len()).filter(|k| *k == at_hand || state.masses[*k].stuck);
        let together = with.fold(1.0, |sum, k| sum + masses[k].mass_ratio);
        let share = masses[at_hand].mass_ratio / together;
        let damping = system.equation(state).damping;
        let [y, w] = of(at_hand);
        let mut map = Square::identity();
        (map[(0, y)], map[(1, w)], map[(1, y)]) = (share, share, -share * damping);
        for k in (0..masses.len()).filter(|k| *k != at_hand && !state.masses[*k].stuck) {
            let [place, rate] = of(k);
            (map[(place, y)], map[(rate, w)]) = (-share, -share);
            map[(rate, y)] = share * damping;
        }
        (map[(y, y)], map[(w, w)]) = (0.0, 0.0);
        self.carry(&map);
        self.stuck = stuck_in(state);
        self.begun.1 = rates(system, state);
    }

    /// Masses that were stuck are free from an instant on: each begins at rest on its wall.
    pub fn release<H: Host<Real = f64>>(
        &mut self,
        system: &Several<H>,
        time: f64,
        state: &SeveralState<H>,
    ) {
        self.turn(system, time, state);
        let mut map = Square::identity();
        for k in (0..system.absorbers()).filter(|k| self.stuck[*k] && !state.masses[*k].stuck) {
            for variable in of(k) {
                map[(variable, variable)] = 0.0;
            }
        }
        self.carry(&map);
        self.stuck = stuck_in(state);
    }

    /// The error of all further rebounds of a chatter of the absorber at hand after its last impact, from this state: their
    /// times add up to T = 2u/(A(1 − e)).
    pub fn of_tail<H: Host<Real = f64>>(
        &self,
        system: &Several<H>,
        after: &SeveralState<H>,
    ) -> f64 {
        let at_hand = system.at_hand(after);
        let [_, w] = of(at_hand);
        let leave = system.distance(after);
        let left = 1.0 - system.law_of(at_hand, system.wall(after), leave.rate).rebound;
        let whole = 2.0 * leave.rate / (leave.curvature.abs() * left);
        let speed = self.deviation(w) / leave.rate;
        let pressure = (self.deviation(0) + self.deviation(1)) / leave.curvature.abs();
        let more = DEVIATIONS * whole * (speed + pressure);
        self.last[at_hand].0 + if more.is_finite() { more } else { 0.0 }
    }
}

/// The rates of all variables in a state.
fn rates<H: Host<Real = f64>>(system: &Several<H>, state: &SeveralState<H>) -> Column {
    let [v, a, base] = system.motion_of(state);
    let mut rates = Column::zeros();
    (rates[0], rates[1]) = (v, a - base);
    for (absorber, gap) in system.gaps(state).enumerate() {
        if !state.masses[absorber].stuck {
            let [y, w] = of(absorber);
            (rates[y], rates[w]) = (gap.w, -a);
        }
    }
    rates
}

/// The derivative of a motion of length h, with the masses stuck that are so in a state.
fn flow<H: Host<Real = f64>>(system: &Several<H>, state: &SeveralState<H>, h: f64) -> Square {
    let [[xx, vx], [xv, vv]] = columns(system.equation(state), h);
    let mut flow = Square::identity();
    (flow[(0, 0)], flow[(0, 1)], flow[(1, 0)], flow[(1, 1)]) = (xx, xv, vx, vv);
    for absorber in 0..system.absorbers() {
        let [y, w] = of(absorber);
        if state.masses[absorber].stuck {
            flow[(w, w)] = 0.0;
            continue;
        }
        (flow[(y, 0)], flow[(y, 1)], flow[(y, w)]) = (1.0 - xx, h - xv, h);
        (flow[(w, 0)], flow[(w, 1)]) = (-vx, 1.0 - vv);
    }
    flow
}
