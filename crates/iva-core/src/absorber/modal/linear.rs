//! A structure with modes, as small differences see it.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};

use super::series::EXACT;
use super::single::FINE;
use super::state::{Modes, Place};
use super::structure::Damping;
use super::{Modal, ModalState};
use crate::absorber::derivatives::lists::{DifferentiableList, Moved, place, tail_of};
use crate::absorber::derivatives::maps::{self, Map};
use crate::absorber::derivatives::masses::{LinearStructure, Pull};
use crate::absorber::{Absorber as _, Clock, ImpactLaw as _, OnStructure as _};
use crate::force::Drive;
use crate::host::Host;
use crate::segment::flight::Motion as _;
use crate::segment::taylor::{Pendulum, Posture};

impl<H: Host<Real = f64>, const N: usize, const M: usize> Modal<H, N, M> {
    /// What small differences obey at a state.
    fn linear(&self, state: &ModalState<H, N, M>) -> Cow<'_, LinearStructure> {
        if self.swings() {
            Cow::Owned(self.linear_at(state))
        } else {
            Cow::Borrowed(self.differences.get_or_init(|| Box::new(self.linear_at(state))))
        }
    }

    fn linear_at(&self, state: &ModalState<H, N, M>) -> LinearStructure {
        let n = self.whole.count();
        let own = self.whole.stiffness.iter().map(|square| square.value);
        let mut stiffness = DMatrix::from_diagonal(&DVector::from_iterator(n, own));
        for (spring, shape) in &self.whole.springs {
            let shape = DVector::from_column_slice(shape);
            stiffness += &shape * shape.transpose() * *spring;
        }
        let damping = match &self.whole.damping {
            Damping::Separate(rates) => {
                let rates = rates.iter().map(|rate| rate.value);
                DMatrix::from_diagonal(&DVector::from_iterator(n, rates))
            }
            Damping::Full(matrix) => DMatrix::from_row_slice(n, n, matrix),
        };
        LinearStructure {
            stiffness,
            damping,
            shapes: (0..self.count())
                .map(|k| DVector::from_column_slice(self.gap_shape(k)))
                .collect(),
            lightness: (0..self.count()).map(|k| self.lightness(k).value).collect(),
            as_coordinates: (0..self.count())
                .filter_map(|k| {
                    Some((k, self.tied[k].as_ref().filter(|it| !it.grounded)?.coordinate))
                })
                .collect(),
            stops: (0..self.count()).filter(|k| self.grounded(*k).is_some()).collect(),
            pulls: (0..self.count()).map(|k| self.pull_of(k, &state.places[k])).collect(),
        }
    }

    /// How a member follows its point and pulls at it. With s = sinθ, P = r² y + σ² φ, with what friction adds, and sin(θ − α) = −γ′ it is for a pendulum
    ///
    /// ```text
    /// G = c P + ν ẏ + s W²/b,    F = λ (γ (P + ν W) − γ′ W²/b),    W = ẏ/c.
    /// ```
    fn pull_of(&self, k: usize, place: &Place<f64>) -> Pull {
        let Some(is) = self.hanging(k) else { return Pull::NONE };
        let Pendulum { coupling, lever, frequency_squared: r2, pivot_damping: nu, .. } = *is;
        if is.small_angles {
            let swing = [r2, nu];
            let inertia = [is.own_inertia(0.0, 1.0), 0.0];
            let pull = swing.map(|it| it * lever);
            return Pull { lever, follows: [coupling, 0.0], inertia, swing, pull };
        }
        let Posture { y, c, arc, .. } = self.posture(k, is, place);
        let (y, c, arc) = (y.value, c.value, arc.value);
        let (over_b, w) = (1.0 / is.contact_distance, place.gap(&self.masses[k]).w / c);
        let sine = y * over_b;
        // All derivatives are those by the arc, over that of y by it, which is c.
        let lean = is.lean(y, c);
        let turned = (is.rise * c - is.level * sine) * over_b;
        let [c1, lean1, turned1] =
            [-sine * over_b, turned, -lean * over_b * over_b].map(|it| it / c);
        let held = is.spring.acting().mul_add(arc, r2 * y) + self.rubbing(k, place);
        let held1 = is.spring.acting() / c + r2;
        // That of W at the same ẏ.
        let w1 = -w * c1 / c;
        let square = w * w * over_b;
        let follows = [coupling * c * lean, coupling * (c1 * lean + c * lean1)];
        let share = is.mass_ratio / is.inertia_ratio;
        let inertia = [is.own_inertia(y, c), -2.0 * share * lean * lean1];
        let whirled = square * over_b + 2.0 * sine * over_b * w * w1;
        let swing = [c1 * held + c * held1 + whirled, nu + 2.0 * sine * over_b * w / c];
        let along = lean1 * (held + nu * w) + lean * (held1 + nu * w1);
        let aside = turned1 * w * w + 2.0 * turned * w * w1;
        let pull = [along - aside, (lean * nu - 2.0 * turned * w) / c].map(|it| it * lever);
        Pull { lever: lever * lean / c, follows, inertia, swing, pull }
    }

    /// A state in which nothing moves, far from all walls.
    pub(super) fn at_rest(&self) -> ModalState<H, N, M> {
        let phase = self.host.begin_at(Clock::ZERO);
        ModalState { modes: Modes::REST, places: [Place::FAR; N], phase, at_hand: 0, felt: None }
    }

    /// The state with these members carried.
    fn carrying_these(state: &ModalState<H, N, M>, carried: &[bool]) -> ModalState<H, N, M> {
        let mut state = state.renewed();
        for (place, carried) in state.places.iter_mut().zip(carried) {
            (place.stuck, place.held) = (*carried, false);
        }
        state
    }

    /// The acceleration of the point of a member, where these are all rates.
    fn felt(&self, state: &ModalState<H, N, M>, rates: &DVector<f64>, k: usize) -> f64 {
        let base = self.pushes(&state.phase, 1.0)(0)[1].value;
        let bent = self.shape(k).iter().enumerate();
        bent.fold(base, |sum, (j, phi)| phi.mul_add(rates[self.whole.count() + j], sum))
    }

    /// The derivative of all rates at a state, in which these members are carried.
    pub(super) fn jacobian(&self, state: &ModalState<H, N, M>, carried: &[bool]) -> DMatrix<f64> {
        let state = Self::carrying_these(state, carried);
        let rates = DifferentiableList::rates(self, &state, carried);
        let felt: Vec<f64> = (0..self.count()).map(|k| self.felt(&state, &rates, k)).collect();
        self.linear(&state).jacobian(carried, &felt)
    }

    /// The derivative of a motion of length h in which these members are carried. Where a pendulum swings, by Magnus's series to the sixth order (S. Blanes et al.,
    /// Phys. Rep. 470, 2009, section 5.6) over parts of this length, in units of the fastest rate.
    pub(super) fn flow_in_parts<'a>(
        &'a self,
        from: &ModalState<H, N, M>,
        carried: &'a [bool],
        h: f64,
        part: f64,
    ) -> Map<'a> {
        if self.is_linear() {
            return maps::flow(self.linear(from), carried, h);
        }
        let from = Self::carrying_these(from, carried);
        if self.swinging(&from.places).next().is_none() {
            return maps::flow(self.linear(&from), carried, h);
        }
        let flight = self.flight(&from);
        let fastest = self.swinging_rate(&from.places).max(self.whole.growth());
        let parts = (h * fastest / part).ceil().max(1.0);
        let length = h / parts;
        let both = |a: &DMatrix<f64>, b: &DMatrix<f64>| a * b - b * a;
        let mut flow = DMatrix::identity(2, 2);
        for part in 0..parts as usize {
            let [a, b, c] = NODES
                .map(|node| self.jacobian(&flight.state((part as f64 + node) * length), carried));
            let first = &b * length;
            let second = (&c - &a) * (length * 15.0_f64.sqrt() / 3.0);
            let third = (c - b * 2.0 + a) * (length * 10.0 / 3.0);
            let turned = both(&first, &second);
            let again = both(&first, &(&third * 2.0 + &turned)) / -60.0;
            let inner = &first * -20.0 - &third + turned;
            let step = (first + third / 12.0 + both(&inner, &(second + again)) / 240.0).exp();
            flow = if part == 0 { step } else { step * flow };
        }
        maps::by_matrix(flow)
    }
}

/// Length of a part of a motion over which the derivative of a swing is found from three states, in units of its fastest rate, for estimates.
const PART: f64 = 0.25;
/// The nodes of Gauss's quadrature over a length of 1.
const NODES: [f64; 3] = [0.112_701_665_379_258_3, 0.5, 0.887_298_334_620_741_7];

impl<H: Host<Real = f64>, const N: usize, const M: usize> DifferentiableList for Modal<H, N, M> {
    fn is_linear(&self) -> bool {
        !self.swings()
    }

    fn coordinates(&self) -> usize {
        self.whole.count()
    }

    fn carried(&self, state: &Self::State, _sticks: bool) -> Vec<bool> {
        state.places[..self.count()].iter().map(Place::carried).collect()
    }

    fn rates(&self, state: &Self::State, carried: &[bool]) -> DVector<f64> {
        let state = &Self::carrying_these(state, carried);
        let places = &state.places;
        let pushes = self.pushes(&state.phase, 1.0);
        let asides = self.asides(&state.phase, 1.0, 1);
        let regime = self.regime(places);
        let feed = (&pushes, asides.as_slice());
        let grown = self.grown(state, &regime, feed, 1.0, (2, EXACT));
        let rows = &grown.rows;
        let n = self.whole.count();
        let mut rates = DVector::zeros(2 * (n + self.count()));
        for j in 0..n {
            rates[j] = state.modes.velocities[j].value;
            rates[n + j] = 2.0 * rows.plain(j, 2);
        }
        for (k, gap) in self.each_gap(state).enumerate().filter(|(k, _)| !carried[*k]) {
            let curved = self.curved(&grown, (k, &places[k]), |m| pushes(m)[1], (1.0, 2));
            (rates[2 * (n + k)], rates[2 * (n + k) + 1]) = (gap.w, -2.0 * curved.plain(2));
        }
        rates
    }

    fn slip_gradient(&self, state: &Self::State, carried: &[bool]) -> Option<DVector<f64>> {
        let k = self.at_hand_of(state).0;
        if self.static_friction[k] <= self.friction[k] {
            return None;
        }
        let mut held = state.renewed();
        for (place, carried) in held.places.iter_mut().zip(carried) {
            place.held = *carried && !place.stuck;
        }
        let [a, rate, ..] = self.shaken(&held, k);
        let linear = self.linear(state);
        let point = DVector::from_column_slice(self.shape(k));
        let [y, _] = linear.of(k);
        let (follows, swing) = (linear.pulls[k].follows, linear.pulls[k].swing);
        let mut gradient = linear.pull_on(&point, carried) * follows[0];
        gradient[y] += self.tie(k).spring / self.masses[k].mass_ratio;
        if let Some(is) = self.hanging(k).filter(|is| !is.small_angles) {
            // What friction holds of it falls with c as well.
            let Posture { y: at, c, .. } = self.posture(k, is, &held.places[k]);
            let steep = at.value / (is.contact_distance * c.value).powi(2);
            let felt = self.felt(&held, &DifferentiableList::rates(self, &held, carried), k);
            gradient[y] += follows[1] * felt + swing[0] + steep * a;
        } else {
            gradient[y] += swing[0];
        }
        Some(gradient / -rate)
    }

    fn derivative_at_begin(&self) -> DMatrix<f64> {
        self.linear(&self.at_rest()).begin()
    }

    fn flow<'a>(&'a self, from: &Self::State, carried: &'a [bool], h: f64) -> Map<'a> {
        self.flow_in_parts(from, carried, h, PART)
    }

    fn by_numbers(&self) -> &(DMatrix<f64>, Vec<usize>) {
        let single = || (self.spread(), self.four().to_vec());
        let several = || (self.by_point(), self.independent());
        self.by_numbers
            .get_or_init(|| Box::new(if self.is_single() { single() } else { several() }))
    }

    fn fine_flow<'a>(&'a self, from: &Self::State, carried: &'a [bool], h: f64) -> Map<'a> {
        self.flow_in_parts(from, carried, h, FINE)
    }

    fn roundings(&self, moved: &Moved<'_, Self::State>) -> DVector<f64> {
        if self.is_linear() {
            let end = moved.states[1];
            return self.linear(end).roundings(moved, self.primary(end));
        }
        let [first, last] = moved.rates;
        first.abs().sup(&last.abs()) * moved.length
    }

    /// Those of the pendulums, whose series are in plain numbers beyond their first terms.
    fn sizes(&self, state: &Self::State, carried: &[bool]) -> Option<DVector<f64>> {
        let state = Self::carrying_these(state, carried);
        let (n, linear) = (self.whole.count(), self.linear(&state));
        self.swinging(&state.places).next()?;
        let rates = DifferentiableList::rates(self, &state, carried);
        let driven = self.host.drive_ahead::<3>(&state.phase).as_ref().map_or(0.0, Drive::size);
        let mut sizes = rates.abs();
        for j in 0..n {
            let [q, v] =
                [state.modes.places[j], state.modes.velocities[j]].map(|it| it.value.abs());
            let pulled = self
                .swinging(&state.places)
                .map(|(k, is)| linear.shapes[k][j].abs() * self.pulling(k, is, &state.places[k]));
            let own = linear.stiffness[(j, j)] * q + linear.damping[(j, j)].abs() * v;
            sizes[n + j] = own + driven + pulled.sum::<f64>();
        }
        for k in (0..self.count()).filter(|k| !carried[*k]) {
            let [_, w] = place(n, k);
            let shape = linear.shapes[k].iter().enumerate();
            let shaken = shape.map(|(j, phi)| phi.abs() * sizes[n + j]).sum::<f64>();
            let own = self.hanging(k).map_or(0.0, |is| {
                self.pulling(k, is, &state.places[k]) / (is.mass_ratio * is.lever)
            });
            // The relative error of cos²θ is larger than that of y, from which it is computed.
            let [follows, _] = linear.pulls[k].follows;
            let steep = 1.0 / self.turned_by(k, &state.places[k]).powi(2);
            sizes[w] = steep * (follows.abs() * (shaken + driven) + own);
        }
        Some(sizes)
    }

    fn impact_map<'a>(
        &'a self,
        struck: &[usize],
        [before, after]: [&Self::State; 2],
        carried: [&'a [bool]; 2],
    ) -> Map<'a> {
        let slope = |k: &usize| {
            let seen = self.turned_to(before, *k);
            let approach = -self.distance(&seen).rate;
            (*k, self.law_of(*k, self.wall(&seen), approach).slope)
        };
        let slopes = struck.iter().map(slope).collect();
        let n = self.whole.count();
        let speeds = [before, after].map(|state| &state.modes.velocities);
        let faster = DVector::from_fn(n, |j, _| (speeds[1][j] - speeds[0][j]).value);
        maps::impact(self.linear(before), slopes, carried, &faster)
    }

    fn stick_map(&self, state: &Self::State, carried: &[bool]) -> Map<'_> {
        maps::stick(self.linear(state), self.at_hand(state), carried)
    }

    fn tail(&self, after: &Self::State) -> f64 {
        tail_of(self, after)
    }

    fn pressing(&self, absorber: usize, changes: &dyn Fn(usize) -> f64) -> f64 {
        let (linear, n) = (self.linear(&self.at_rest()), self.whole.count());
        let of = |(j, phi): (usize, &f64)| {
            let square = linear.stiffness[(j, j)];
            phi.abs() * (square * changes(j) + square.sqrt() * changes(n + j))
        };
        let follows = self.hanging(absorber).map_or(1.0, |is| is.coupling);
        follows * linear.shapes[absorber].iter().enumerate().map(of).sum::<f64>()
    }
}
