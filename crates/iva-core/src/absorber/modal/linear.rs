//! A structure with modes, as small differences see it.

use nalgebra::{DMatrix, DVector};

use super::series::EXACT;
use super::state::Place;
use super::structure::Damping;
use super::{Followed, Modal};
use crate::absorber::derivatives::lists::{DifferentiableList, Moved, tail_of};
use crate::absorber::derivatives::masses::LinearStructure;
use crate::absorber::{Absorber as _, ImpactLaw as _, OnStructure as _};
use crate::host::Host;

impl<H: Host<Real = f64>, const N: usize, const M: usize> Modal<H, N, M> {
    /// What small differences obey.
    fn linear(&self) -> LinearStructure {
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
                .filter_map(|k| Some((k, self.tied[k].as_ref()?.coordinate)))
                .collect(),
        }
    }
}

impl<H: Host<Real = f64>, const N: usize, const M: usize> DifferentiableList for Modal<H, N, M> {
    const LINEAR: bool = true;

    fn coordinates(&self) -> usize {
        self.whole.count()
    }

    fn carried(&self, state: &Self::State, _sticks: bool) -> Vec<bool> {
        state.places[..self.count()].iter().map(Place::carried).collect()
    }

    fn rates(&self, state: &Self::State, carried: &[bool]) -> DVector<f64> {
        let mut places = state.places;
        for (place, carried) in places.iter_mut().zip(carried) {
            (place.stuck, place.held) = (*carried, false);
        }
        let pushes = self.pushes(&state.phase, 1.0);
        let [_, base, _] = pushes(0);
        let asides = self.asides(&state.phase, 1.0, 1);
        let regime = self.regime(&places);
        let rows = self.series(&state.modes, &regime, (&pushes, &asides), 1.0, (2, EXACT));
        let n = self.whole.count();
        let mut rates = DVector::zeros(2 * (n + self.count()));
        for j in 0..n {
            rates[j] = state.modes.velocities[j].value;
            rates[n + j] = 2.0 * rows.plain(j, 2);
        }
        for (k, gap) in self.each_gap(state).enumerate().filter(|(k, _)| !carried[*k]) {
            let flying = Place { stuck: false, held: false, ..state.places[k] };
            let Followed { shape, with_base, constant, .. } = self.followed(k, &flying);
            let moved = constant.value + if with_base { base.value } else { 0.0 };
            let a = shape
                .iter()
                .enumerate()
                .fold(moved, |sum, (j, phi)| phi.mul_add(rates[n + j], sum));
            (rates[2 * (n + k)], rates[2 * (n + k) + 1]) = (gap.w, -a);
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
        let [_, rate, ..] = self.shaken(&held, k);
        let linear = self.linear();
        let point = DVector::from_column_slice(self.shape(k));
        let mut gradient = linear.pull_on(&point, carried);
        gradient[linear.of(k)[0]] += self.tie(k).spring / self.masses[k].mass_ratio;
        Some(gradient / -rate)
    }

    fn derivative_at_begin(&self) -> DMatrix<f64> {
        self.linear().begin()
    }

    fn flow(&self, _from: &Self::State, carried: &[bool], h: f64) -> DMatrix<f64> {
        self.linear().flow(carried, h)
    }

    fn roundings(&self, moved: &Moved<'_, Self::State>) -> DVector<f64> {
        self.linear().roundings(moved, self.primary(moved.states[1]))
    }

    fn impact_matrix(
        &self,
        struck: &[usize],
        [before, _]: [&Self::State; 2],
        carried: [&[bool]; 2],
    ) -> DMatrix<f64> {
        let slope = |k: &usize| {
            let seen = self.turned_to(before, *k);
            let approach = -self.distance(&seen).rate;
            (*k, self.law_of(*k, self.wall(&seen), approach).slope)
        };
        let slopes: Vec<_> = struck.iter().map(slope).collect();
        self.linear().impact_matrix(&slopes, carried)
    }

    fn stick_matrix(&self, state: &Self::State, carried: &[bool]) -> DMatrix<f64> {
        self.linear().stick_matrix(self.at_hand(state), carried)
    }

    fn tail(&self, after: &Self::State) -> f64 {
        tail_of(self, after)
    }

    fn pressing(&self, absorber: usize, changes: &dyn Fn(usize) -> f64) -> f64 {
        let linear = self.linear();
        let n = linear.coordinates();
        let of = |(j, phi): (usize, &f64)| {
            let square = linear.stiffness[(j, j)];
            phi.abs() * (square * changes(j) + square.sqrt() * changes(n + j))
        };
        linear.shapes[absorber].iter().enumerate().map(of).sum()
    }
}
