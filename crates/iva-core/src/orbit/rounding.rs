//! How rounding errors grow in the derivative of a run.
//!
//! The derivative is the product of the matrices of flights, impacts, sticks and releases. Each factor has rounding errors,
//! which the later factors multiply. They are taken as independent and random: for each column of the product the
//! covariance P of its error changes by A P Aᵀ + Q where a factor A joins, and so does that of the error of the state.

use nalgebra::DMatrix;

use super::coordinates::Coordinates;
use crate::engine::observe::{Contact, Observer, Span};
use crate::engine::simulate::{Instant, Tally};
use crate::measures::propagation::Derivative;
use crate::segment::flight::Motion;

/// The standard error of an element of a factor, over the sum of the sizes of its terms; and that of a state.
const UNIT: f64 = 2.0 * f64::EPSILON;

/// An observer of the derivative of a run and of its rounding errors.
#[derive(Debug, Default)]
pub(super) struct Rounding<A> {
    factor: A,
    /// The derivative.
    pub product: DMatrix<f64>,
    /// The covariances of the errors of its columns.
    columns: Vec<DMatrix<f64>>,
    /// The covariance of the error of the state.
    pub state: DMatrix<f64>,
    /// The instant from which a tail of a chatter is summed.
    summed_from: Option<f64>,
}

impl<A> Rounding<A> {
    /// The standard errors of the elements of the derivative.
    pub(super) fn errors(&self) -> DMatrix<f64> {
        let deviations = |covariance: &DMatrix<f64>| covariance.diagonal().map(f64::sqrt);
        let columns: Vec<_> = self.columns.iter().map(deviations).collect();
        DMatrix::from_columns(&columns)
    }

    /// The next factor, with errors of a relative size, at a state of given coordinates.
    fn join(&mut self, factor: &DMatrix<f64>, error: f64, size: f64) {
        for (column, covariance) in self.columns.iter_mut().enumerate() {
            let terms = factor.abs() * self.product.column(column).abs();
            let fresh = DMatrix::from_diagonal(&terms.map(|term| (error * term).powi(2)));
            *covariance = factor * &*covariance * factor.transpose() + fresh;
        }
        let count = factor.nrows();
        let fresh = DMatrix::from_diagonal_element(count, count, (UNIT * size).powi(2));
        self.state = factor * &self.state * factor.transpose() + fresh;
        self.product = factor * &self.product;
    }

    fn joined<S: Coordinates<Derivative = A>>(&mut self, system: &S, state: &S::State, error: f64)
    where
        A: Derivative<S>,
    {
        let factor = self.factor.factor(system);
        if factor != DMatrix::identity(factor.nrows(), factor.ncols()) {
            let size = system.point(state).amax();
            self.join(&factor, error, size);
        }
    }
}

impl<A: Derivative<S>, S: Coordinates<Derivative = A>> Observer<S> for Rounding<A> {
    fn start(&mut self, system: &S, from: &Instant<S::State>, duration: f64) {
        let count = system.point(&from.state).len();
        let zero = DMatrix::zeros(count, count);
        *self = Self {
            factor: A::default(),
            product: DMatrix::identity(count, count),
            columns: vec![zero.clone(); count],
            state: zero,
            summed_from: None,
        };
        self.factor.start(system, from, duration);
    }

    fn looks_within(&self) -> bool {
        self.factor.looks_within()
    }

    fn span<M: Motion<Real = f64, State = S::State>>(&mut self, system: &S, span: &Span<'_, M>) {
        self.factor.span(system, span);
        self.joined(system, span.end, UNIT);
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State>) {
        self.factor.contact(system, contact);
        self.joined(system, contact.states[1], UNIT);
        let first = self.summed_from.unwrap_or(contact.time);
        self.summed_from = contact.summed.then_some(first);
    }

    /// The rest of the chatter counts as stuck. Of its duration the error is of second order, for a pendulum of first.
    fn stick(&mut self, system: &S, from: &Instant<S::State>) {
        self.factor.stick(system, from);
        let rest = self.summed_from.take().map_or(0.0, |begin| from.time.value - begin);
        let error = if S::LINEAR { rest * rest } else { rest };
        self.joined(system, &from.state, error + UNIT);
    }

    fn release(&mut self, system: &S, from: &Instant<S::State>) {
        self.factor.release(system, from);
        self.joined(system, &from.state, UNIT);
    }

    fn stop(&mut self, system: &S, time: f64, states: [&S::State; 2]) {
        self.factor.stop(system, time, states);
        self.joined(system, states[1], UNIT);
    }

    fn slip(&mut self, system: &S, from: &Instant<S::State>) {
        self.factor.slip(system, from);
        self.joined(system, &from.state, UNIT);
    }

    fn end(&mut self, system: &S, tally: &Tally<S::State>) {
        self.factor.end(system, tally);
        self.joined(system, &tally.state, UNIT);
    }
}
