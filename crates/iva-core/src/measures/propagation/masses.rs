//! How errors grow in a run of free masses on a linear structure: of several masses, of several modes, or with friction.
//!
//! The variables are q and q̇ of the structure, then y and ẏ of each mass ([`crate::absorber::derivatives::masses`]). A mass
//! that is carried along, stuck to a wall or held by friction, has no ẏ of its own; on a wall it has no y either. Impacts
//! at one instant are taken for one contact, which small errors do not divide.
//!
//! Motions on several modes are summed with less rounding than the estimate has for them; it stands for that of the shapes and
//! frequencies which they are made from.
//!
//! A stop in the gap is an event on ẏ = 0 as an impact is one on the distance, with the saltation matrix
//! I + (f⁺ − f⁻) nᵀ/(nᵀ f⁻). At a slip, as at a release, the motion goes on smoothly.

use nalgebra::{DMatrix, DVector};

use super::errors::{DEVIATIONS, GRAZING, LOST, ROUNDING, UNIT};
use crate::absorber::derivatives::masses::{LinearMasses, LinearStructure};
use crate::absorber::{Point, Wall};

/// The errors of a state, and its derivative.
#[derive(Debug, Clone)]
pub(super) struct Grown {
    linear: LinearStructure,
    covariance: DMatrix<f64>,
    derivative: DMatrix<f64>,
    /// The instant of the last event, and the rates of all variables there.
    begun: (f64, DVector<f64>),
    /// Which masses are carried since then.
    carried: Vec<bool>,
    /// The wall that each mass has met last.
    walls: Vec<Option<Wall>>,
    /// The length that a condition is relative to.
    unit: f64,
    pub condition: f64,
    /// The error of the instant of the last impact of each mass, and whether it is close to a grazing.
    last: Vec<(f64, bool)>,
    /// True once the estimate has reached [`LOST`].
    pub lost: bool,
}

impl Grown {
    pub fn at<S: LinearMasses>(system: &S, state: &S::State, time: f64) -> Self {
        let linear = system.linear();
        let (size, count) = (linear.variables(), linear.shapes.len());
        let carried = system.carried(state, false);
        let x = system.primary(state).x.abs();
        Self {
            covariance: DMatrix::zeros(size, size),
            derivative: linear.begin(),
            begun: (time, system.rates(state, &carried)),
            carried,
            walls: vec![None; count],
            unit: if x > 0.0 { x } else { system.clearance() },
            condition: 0.0,
            last: vec![(0.0, false); count],
            lost: false,
            linear,
        }
    }

    fn carry(&mut self, map: &DMatrix<f64>) {
        self.covariance = map * &self.covariance * map.transpose();
        self.derivative = map * &self.derivative;
    }

    /// Adds an independent error of this standard deviation to a variable.
    fn add(&mut self, variable: usize, deviation: f64) {
        self.covariance[(variable, variable)] += deviation * deviation;
    }

    fn deviation(&self, variable: usize) -> f64 {
        self.covariance[(variable, variable)].sqrt()
    }

    /// A motion begins at an instant in a state.
    fn begin<S: LinearMasses>(&mut self, system: &S, time: f64, state: &S::State, sticks: bool) {
        self.carried = system.carried(state, sticks);
        self.begun = (time, system.rates(state, &self.carried));
    }

    /// The motion since the last event ends at an instant, in a state.
    fn end<S: LinearMasses>(&mut self, system: &S, time: f64, state: &S::State) {
        let h = time - self.begun.0;
        if h <= 0.0 || self.lost {
            return;
        }
        let last = system.rates(state, &self.carried);
        let fastest = self.begun.1.abs().sup(&last.abs());
        self.carry(&self.linear.flow(&self.carried, h));
        // A long motion may be fastest in between, up to the root mean square of its velocity.
        let n = self.linear.coordinates();
        let Point { x, v } = system.primary(state);
        let whole = (0.5 * (x * x + v * v)).sqrt();
        let most = |j: usize| {
            let square = self.linear.stiffness[j].max(f64::MIN_POSITIVE);
            let speed = (0.5 * (fastest[j].powi(2) + fastest[n + j].powi(2) / square)).sqrt();
            if n == 1 { whole } else { speed }
        };
        let most = DVector::from_fn(n, |j, _| most(j));
        let deviation = |fastest: f64, change: f64, most: f64| {
            UNIT * ROUNDING * h * fastest.max((0.25 * h * change).min(most))
        };
        let mut deviations = vec![];
        for j in 0..n {
            let square = self.linear.stiffness[j];
            let (speed, bend) = (fastest[j], fastest[n + j]);
            deviations.push((j, deviation(speed, bend, most[j])));
            deviations.push((n + j, deviation(bend, square * speed, square.sqrt() * most[j])));
        }
        for (k, shape) in self.linear.shapes.iter().enumerate().filter(|(k, _)| !self.carried[*k]) {
            let [y, w] = self.linear.of(k);
            let at_point = |of: &dyn Fn(usize) -> f64| {
                shape.iter().enumerate().map(|(j, phi)| phi.abs() * of(j)).sum::<f64>()
            };
            let frequency = |j: usize| self.linear.stiffness[j].sqrt();
            let change = at_point(&|j| self.linear.stiffness[j] * fastest[j]);
            let [slow, fast] = [at_point(&|j| most[j]), at_point(&|j| frequency(j) * most[j])];
            deviations.push((y, deviation(fastest[y], fastest[w], slow)));
            deviations.push((w, deviation(fastest[w], change, fast)));
        }
        for (variable, deviation) in deviations {
            self.add(variable, deviation);
        }
    }

    /// An impact at an instant between two states, of the absorber at hand and of all that touch their walls with it:
    /// the error of the instant for the one at hand, and whether it is close to a grazing.
    pub fn struck<S: LinearMasses>(
        &mut self,
        system: &S,
        time: f64,
        [before, after]: [&S::State; 2],
    ) -> (f64, bool) {
        let at_hand = system.at_hand(before);
        let struck: Vec<usize> = (0..self.carried.len())
            .filter(|k| {
                let distance = system.distance(&system.turned_to(before, *k));
                !self.carried[*k] && distance.value == 0.0 && distance.rate < 0.0
            })
            .collect();
        // All of one instant are taken at the first of them.
        if struck.first() == Some(&at_hand) {
            self.end(system, time, before);
            for &absorber in &struck {
                self.last[absorber] = self.met(system, before, absorber);
            }
            if !self.lost {
                self.jump(system, &struck, [before, after]);
            }
            self.begin(system, time, after, false);
        }
        self.last[at_hand]
    }

    /// The error of the instant at which a mass meets its wall.
    fn met<S: LinearMasses>(
        &mut self,
        system: &S,
        before: &S::State,
        absorber: usize,
    ) -> (f64, bool) {
        let [y, _] = self.linear.of(absorber);
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
    fn jump<S: LinearMasses>(
        &mut self,
        system: &S,
        struck: &[usize],
        [before, after]: [&S::State; 2],
    ) {
        let Some(&first) = struck.first() else { return };
        let (linear, size) = (&self.linear, self.linear.variables());
        let n = linear.coordinates();
        let carried = system.carried(after, false);
        let slopes: Vec<_> = struck
            .iter()
            .map(|&k| {
                let seen = system.turned_to(before, k);
                let approach = -system.distance(&seen).rate;
                (k, system.law_of(k, system.wall(&seen), approach).slope)
            })
            .collect();
        let mut jump = DMatrix::identity(size, size);
        for k in (0..carried.len()).filter(|k| self.carried[*k] && !carried[*k]) {
            let [_, w] = linear.of(k);
            jump[(w, w)] = 0.0;
        }
        let blows = linear.blows(&slopes, &carried);
        for ((k, slope), gained) in slopes.iter().zip(blows.column_iter()) {
            let [_, w] = linear.of(*k);
            jump.view_mut((n, w), (n, 1)).copy_from(&gained);
            for j in (0..carried.len()).filter(|j| !carried[*j] && !struck.contains(j)) {
                jump[(linear.of(j)[1], w)] = -linear.shapes[j].dot(&gained);
            }
            jump[(w, w)] = -slope;
        }
        let f = system.rates(before, &self.carried);
        let f_after = system.rates(after, &carried);
        let [y, _] = linear.of(first);
        let moved = (&f_after - &jump * &f) / f[y];
        let mut saltation = jump;
        let mut column = saltation.column_mut(y);
        column += moved;
        let speeds = (0..n).chain(struck.iter().map(|k| linear.of(*k)[0]));
        let rounded: Vec<_> = speeds
            .map(|variable| {
                let rate = if variable < n { variable + n } else { variable + 1 };
                (rate, UNIT * ROUNDING * f_after[variable].abs())
            })
            .collect();
        self.carry(&saltation);
        for (variable, deviation) in rounded {
            self.add(variable, deviation);
        }
    }

    /// The absorber at hand sticks. Stick follows an impact at once: the duration of a summed tail is part of the ride.
    pub fn stick<S: LinearMasses>(&mut self, system: &S, state: &S::State) {
        let at_hand = system.at_hand(state);
        let carried = system.carried(state, true);
        let (linear, size) = (&self.linear, self.linear.variables());
        let n = linear.coordinates();
        let [share, damped] = linear.stick(at_hand, &carried);
        let [y, w] = linear.of(at_hand);
        let mut map = DMatrix::identity(size, size);
        map.view_mut((0, y), (n, 1)).copy_from(&share);
        map.view_mut((n, w), (n, 1)).copy_from(&share);
        map.view_mut((n, y), (n, 1)).copy_from(&damped);
        for k in (0..carried.len()).filter(|k| !carried[*k]) {
            let [place, rate] = linear.of(k);
            let moved = -linear.shapes[k].dot(&share);
            (map[(place, y)], map[(rate, w)]) = (moved, moved);
            map[(rate, y)] = -linear.shapes[k].dot(&damped);
        }
        (map[(y, y)], map[(w, w)]) = (0.0, 0.0);
        self.carry(&map);
        self.begin(system, self.begun.0, state, true);
    }

    /// Masses that were stuck are free from an instant on: each begins at rest on its wall.
    pub fn release<S: LinearMasses>(&mut self, system: &S, time: f64, state: &S::State) {
        self.end(system, time, state);
        let freed = system.carried(state, false);
        let mut map = DMatrix::identity(self.linear.variables(), self.linear.variables());
        for k in (0..freed.len()).filter(|k| self.carried[*k] && !freed[*k]) {
            for variable in self.linear.of(k) {
                map[(variable, variable)] = 0.0;
            }
        }
        self.carry(&map);
        self.begin(system, time, state, false);
    }

    /// A mass has stopped in its gap at an instant, between these states.
    pub fn stopped<S: LinearMasses>(
        &mut self,
        system: &S,
        time: f64,
        [before, after]: [&S::State; 2],
    ) {
        self.end(system, time, before);
        let [_, w] = self.linear.of(system.at_hand(before));
        let f = system.rates(before, &self.carried);
        self.begin(system, time, after, false);
        if self.lost {
            return;
        }
        let size = self.linear.variables();
        let mut saltation = DMatrix::identity(size, size);
        let mut column = saltation.column_mut(w);
        column += (&self.begun.1 - &f) / f[w];
        self.carry(&saltation);
    }

    /// A mass that friction held slides off from an instant on.
    pub fn slipped<S: LinearMasses>(&mut self, system: &S, time: f64, state: &S::State) {
        self.end(system, time, state);
        self.begin(system, time, state, false);
    }

    /// The error of all further rebounds of a chatter of the absorber at hand after its last impact, from this state: their
    /// times add up to T, which is inversely proportional to the pressure on the wall.
    pub fn of_tail<S: LinearMasses>(&self, system: &S, after: &S::State) -> f64 {
        let (at_hand, linear) = (system.at_hand(after), &self.linear);
        let [_, w] = linear.of(at_hand);
        let leave = system.distance(after);
        let speed = self.deviation(w) / leave.rate;
        let n = linear.coordinates();
        let pressure: f64 = linear.shapes[at_hand]
            .iter()
            .enumerate()
            .map(|(j, phi)| {
                let square = linear.stiffness[j];
                phi.abs() * (square * self.deviation(j) + square.sqrt() * self.deviation(n + j))
            })
            .sum();
        let pressure = pressure / leave.curvature.abs();
        let more = DEVIATIONS * system.tail(after) * (speed + pressure);
        self.last[at_hand].0 + if more.is_finite() { more } else { 0.0 }
    }
}
