//! How errors grow in a run of several absorbers, of a free mass with friction, and on several modes.
//!
//! The variables are q and q̇ of the structure, then y and ẏ of each absorber ([`crate::absorber::derivatives::lists`]). One
//! that is carried along, stuck to a wall or held by friction, has no ẏ of its own; on a wall it has no y either. Impacts
//! at one instant are taken for one contact, which small errors do not divide.
//!
//! Motions on several modes are summed with less rounding than the estimate has for them; it stands for that of the shapes and
//! frequencies which they are made from.
//!
//! A stop in the gap is an event on ẏ = 0 as an impact is one on the distance, with the saltation matrix
//! I + (f⁺ − f⁻) nᵀ/(nᵀ f⁻). At a slip, as at a release, the motion goes on smoothly.

use nalgebra::{DMatrix, DVector};

use super::errors::{ALIKE, DEVIATIONS, GRAZING, LOST, ROUNDING, UNIT};
use super::jumps;
use crate::absorber::Wall;
use crate::absorber::derivatives::lists::{DifferentiableList, Moved, place, slip};
use crate::absorber::derivatives::maps::{Map, carry_covariance, map_columns};

/// The errors of a state, and its derivative.
#[derive(Debug, Clone)]
pub(super) struct Grown {
    /// Number of coordinates of the structure.
    coordinates: usize,
    covariance: DMatrix<f64>,
    /// Correlated errors of the rebounds on one wall, a column for each variable: those up to the last impact, and those since;
    /// `None` if there are none.
    alike: Option<[DMatrix<f64>; 2]>,
    /// Derivative of the state with respect to that at the begin of the run.
    derivative: DMatrix<f64>,
    /// The instant of the last event, and the rates of all variables there.
    begun: (f64, DVector<f64>),
    /// Which absorbers are carried since then.
    carried: Vec<bool>,
    /// The wall that each absorber has met last.
    walls: Vec<Option<Wall>>,
    /// The length that a condition is relative to.
    unit: f64,
    pub condition: f64,
    /// The error of the instant of the last impact of each, and whether it is close to a grazing.
    last: Vec<(f64, bool)>,
    /// True once the estimate has reached [`LOST`].
    pub lost: bool,
}

impl Grown {
    pub fn at<S: DifferentiableList>(system: &S, state: &S::State, time: f64) -> Self {
        let (derivative, count) = (system.derivative_at_begin(), system.absorbers());
        let size = derivative.nrows();
        let carried = system.carried(state, false);
        let x = system.primary(state).x.abs();
        Self {
            coordinates: system.coordinates(),
            covariance: DMatrix::zeros(size, size),
            alike: None,
            derivative,
            begun: (time, system.rates(state, &carried)),
            carried,
            walls: vec![None; count],
            unit: if x > 0.0 { x } else { system.clearance() },
            condition: 0.0,
            last: vec![(0.0, false); count],
            lost: false,
        }
    }

    /// The indices of y and ẏ of an absorber.
    fn of(&self, absorber: usize) -> [usize; 2] {
        place(self.coordinates, absorber)
    }

    fn carry(&mut self, mut map: Map<'_>) {
        carry_covariance(&mut self.covariance, &mut map);
        map_columns(&mut self.derivative, &mut map);
        for errors in self.alike.iter_mut().flatten() {
            map_columns(errors, &mut map);
        }
    }

    /// Adds an independent error of this standard deviation to a variable.
    fn add(&mut self, variable: usize, deviation: f64) {
        self.covariance[(variable, variable)] += deviation * deviation;
    }

    fn deviation(&self, variable: usize) -> f64 {
        let alike = self.alike.as_ref();
        let alike = alike.map_or(0.0, |[before, _]| before.row(variable).norm_squared());
        (self.covariance[(variable, variable)] + alike).sqrt()
    }

    /// A motion begins at an instant in a state.
    fn begin<S: DifferentiableList>(
        &mut self,
        system: &S,
        time: f64,
        state: &S::State,
        sticks: bool,
    ) {
        self.carried = system.carried(state, sticks);
        self.begun = (time, system.rates(state, &self.carried));
    }

    /// The motion since the last event ends at an instant, in a state: that of a linear system, of which nothing was told
    /// in between.
    fn end<S: DifferentiableList>(&mut self, system: &S, time: f64, state: &S::State) {
        let h = time - self.begun.0;
        if system.is_linear() && h > 0.0 && !self.lost {
            let last = system.rates(state, &self.carried);
            let first = std::mem::replace(&mut self.begun.1, DVector::zeros(0));
            self.moved(system, h, [state, state], [&first, &last]);
        }
    }

    /// A part of the motion of a system that is not linear has ended.
    pub fn spanned<S: DifferentiableList>(&mut self, system: &S, h: f64, states: [&S::State; 2]) {
        let [first, last] = states.map(|state| system.rates(state, &self.carried));
        self.moved(system, h, states, [&first, &last]);
    }

    /// A motion of length h has ended, between these states and rates.
    fn moved<S: DifferentiableList>(
        &mut self,
        system: &S,
        h: f64,
        states: [&S::State; 2],
        rates: [&DVector<f64>; 2],
    ) {
        let carried = std::mem::take(&mut self.carried);
        self.carry(system.flow(states[0], &carried, h));
        self.carried = carried;
        let moved = Moved { states, rates, carried: &self.carried, length: h };
        let roundings = system.roundings(&moved);
        for (variable, size) in roundings.iter().enumerate() {
            self.add(variable, UNIT * ROUNDING * size);
        }
        let Some(sizes) = system.sizes(states[0], &self.carried) else { return };
        let count = sizes.len();
        let [_, since] =
            self.alike.get_or_insert_with(|| [(); 2].map(|()| DMatrix::zeros(count, count)));
        let wrong = sizes * (UNIT * ALIKE * h);
        *since += DMatrix::from_diagonal(&wrong);
        // An error of the acceleration displaces as well.
        let n = self.coordinates;
        for j in 0..n {
            since[(j, n + j)] += 0.5 * h * wrong[n + j];
        }
        for k in 0..self.carried.len() {
            let [y, w] = place(n, k);
            since[(y, w)] += 0.5 * h * system.sharpness(states[0], k) * wrong[w];
        }
    }

    /// An impact at an instant between two states, of the absorber at hand and of all that touch their walls with it:
    /// the error of the instant for the one at hand, and whether it is close to a grazing.
    pub fn struck<S: DifferentiableList>(
        &mut self,
        system: &S,
        time: f64,
        [before, after]: [&S::State; 2],
    ) -> (f64, bool) {
        let at_hand = system.at_hand(before);
        let struck = jumps::struck(system, before, &self.carried);
        if !struck.is_empty() {
            self.end(system, time, before);
            self.meet(system, before, &struck);
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

    /// Prepares for an impact of some absorbers: where one of them is on the other wall than at its last impact, where other
    /// numbers are rounded, correlated errors join the covariance.
    fn meet<S: DifferentiableList>(&mut self, system: &S, before: &S::State, struck: &[usize]) {
        let Some([up_to, since]) = &mut self.alike else { return };
        let wall = |k: usize| Some(system.wall(&system.turned_to(before, k)));
        if struck.iter().all(|k| self.walls[*k] == wall(*k)) {
            *up_to += &*since;
        } else {
            self.covariance += &*up_to * up_to.transpose();
            up_to.fill(0.0);
        }
        since.fill(0.0);
    }

    /// The error of the instant at which an absorber meets its wall.
    fn met<S: DifferentiableList>(
        &mut self,
        system: &S,
        before: &S::State,
        absorber: usize,
    ) -> (f64, bool) {
        let [y, _] = self.of(absorber);
        let seen = system.turned_to(before, absorber);
        let (wall, distance) = (system.wall(&seen), system.distance(&seen));
        let met = self.walls[absorber].replace(wall);
        if met.is_some_and(|met| met != wall) {
            let sharpness = system.sharpness(before, absorber);
            self.add(y, UNIT * system.clearance_of(absorber) * sharpness);
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
    fn jump<S: DifferentiableList>(
        &mut self,
        system: &S,
        struck: &[usize],
        states: [&S::State; 2],
    ) {
        let n = self.coordinates;
        let freed = system.carried(states[1], false);
        let carried = std::mem::take(&mut self.carried);
        let (saltation, f_after) = jumps::saltation(system, struck, states, [&carried, &freed]);
        self.carry(saltation);
        let speeds = (0..n).chain(struck.iter().map(|k| self.of(*k)[0]));
        let rounded: Vec<_> = speeds
            .map(|variable| {
                let rate = if variable < n { variable + n } else { variable + 1 };
                (rate, UNIT * ROUNDING * f_after[variable].abs())
            })
            .collect();
        for (variable, deviation) in rounded {
            self.add(variable, deviation);
        }
    }

    /// The absorber at hand sticks. Stick follows an impact at once: the duration of a summed tail is part of the ride.
    pub fn stick<S: DifferentiableList>(&mut self, system: &S, state: &S::State) {
        let carried = system.carried(state, true);
        self.carry(system.stick_map(state, &carried));
        self.begin(system, self.begun.0, state, true);
    }

    /// Masses that were stuck are free from an instant on: each begins at rest on its wall.
    pub fn release<S: DifferentiableList>(&mut self, system: &S, time: f64, state: &S::State) {
        self.end(system, time, state);
        self.carry(jumps::release(system, state, &self.carried));
        self.begin(system, time, state, false);
    }

    /// A mass has stopped in its gap at an instant, between these states.
    pub fn stopped<S: DifferentiableList>(
        &mut self,
        system: &S,
        time: f64,
        [before, after]: [&S::State; 2],
    ) {
        self.end(system, time, before);
        self.carry(jumps::stop(system, [before, after], &self.carried));
        self.begin(system, time, after, false);
    }

    /// A mass that friction held slides off from an instant on.
    pub fn slipped<S: DifferentiableList>(&mut self, system: &S, time: f64, state: &S::State) {
        self.end(system, time, state);
        self.carry(slip(system, state, &self.carried));
        self.begin(system, time, state, false);
    }

    /// The error of all further rebounds of a chatter of the absorber at hand after its last impact, from this state: their
    /// times add up to T, which is inversely proportional to the pressure on the wall.
    pub fn of_tail<S: DifferentiableList>(&self, system: &S, after: &S::State) -> f64 {
        let at_hand = system.at_hand(after);
        let [_, w] = self.of(at_hand);
        let leave = system.distance(after);
        let speed = self.deviation(w) / leave.rate;
        let pressure = system.pressing(at_hand, &|variable| self.deviation(variable));
        let pressure = pressure / leave.curvature.abs();
        let more = DEVIATIONS * system.tail(after) * (speed + pressure);
        self.last[at_hand].0 + if more.is_finite() { more } else { 0.0 }
    }
}
