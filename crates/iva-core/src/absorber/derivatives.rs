//! The derivatives of the motion of each absorber: of flights and rides, impacts and sticks.
//!
//! A small difference of the state z is one of (x, ẋ, y, ẏ), with W = b θ̇ in place of ẏ for a pendulum. What is made of
//! them along a run, error estimates and the derivative of the run, is in [`crate::measures::propagation`].

use nalgebra::{Matrix4, Vector4};

use crate::absorber::{Absorber, LawAt};

pub(crate) mod lists;
pub(crate) mod maps;
pub(crate) mod masses;
pub(crate) mod piva;
mod siva;
mod structure;

pub(crate) use structure::columns;

/// A system whose motion can be differentiated.
pub trait Differentiable: Absorber<Real = f64> {
    /// True if the derivatives of the motion are those of a linear equation: known for any length, and the same
    /// from any state. Then the estimate needs the states at events only.
    const LINEAR: bool = false;
    /// The rates ż in free flight.
    fn rates(&self, state: &Self::State) -> Vector4<f64>;
    /// |D̈| in contact with a wall, just before an impact.
    fn bend(&self, before: &Self::State) -> f64 {
        self.distance(before).curvature.abs()
    }
    /// Sizes of the terms of ẋ, ẍ, ẏ and ÿ (or Ẇ) before they cancel: the rounding errors that are the same
    /// at every rebound are proportional to these. `None`: the rates are computed in double-double.
    fn sizes(&self, _state: &Self::State) -> Option<Vector4<f64>> {
        None
    }
    /// Derivative of the state after a flight of length h with respect to the state before it.
    fn flight_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64>;
    /// The same to some five digits, which estimates of errors need.
    fn rough_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64> {
        self.flight_tangent(from, h)
    }
    /// Derivative of the state after a time h stuck on a wall, where y and ẏ do not change, with respect to
    /// that before it.
    fn ride_tangent(&self, from: &Self::State, h: f64) -> Matrix4<f64>;
    /// Derivative of the state just after an impact, between two states, with respect to that just before, at a fixed
    /// instant.
    fn impact_matrix(&self, states: [&Self::State; 2]) -> Matrix4<f64>;
    /// The determinant of the derivative of a flight.
    #[inline(always)]
    fn flight_volume(&self, tangent: &Matrix4<f64>) -> f64 {
        determinant(tangent)
    }
    /// The determinant of the derivative of an impact.
    #[inline(always)]
    fn impact_volume(&self, jump: &Matrix4<f64>) -> f64 {
        determinant(jump)
    }
    /// Derivative of the state at the end of a chatter, in which the absorber is stuck, with respect to that after one of its
    /// rebounds.
    fn stick_matrix(&self, stuck: &Self::State) -> Matrix4<f64>;
    /// Derivative of the state after a stop in the gap of an absorber that rubs, between two states, with respect to that before.
    fn stop_matrix(&self, states: [&Self::State; 2]) -> Matrix4<f64> {
        let [before, after] = states.map(|state| self.rates(state));
        let normal = Vector4::new(0.0, 0.0, 0.0, 1.0 / before[3]);
        Matrix4::identity() + (after - before) * normal.transpose()
    }
    /// Derivative of the state where friction lets the absorber go, with respect to that before.
    fn slip_matrix(&self, _sliding: &Self::State) -> Matrix4<f64> {
        Matrix4::identity()
    }
    /// Error of y per rounding of the position at a state: 1, or cosθ where the position is computed from
    /// cosθ.
    fn sharpness(&self, _state: &Self::State) -> f64 {
        1.0
    }
    /// Sizes of x, ẋ, the distance to a wall and ẏ: a state carried in plain doubles is rounded in proportion
    /// to these. 0: no tier carries it so.
    fn plain_state(&self, _state: &Self::State) -> Vector4<f64> {
        Vector4::zeros()
    }
    /// As [`Differentiable::sizes`], for a motion in plain doubles.
    fn plain_rates(&self, _state: &Self::State) -> Vector4<f64> {
        Vector4::zeros()
    }
    /// Rate of the position: |ẏ|, for a pendulum |W|.
    fn turning(&self, state: &Self::State) -> f64 {
        self.rates(state)[2].abs()
    }
    /// Largest truncation error of a segment, of x and ẋ and of y and ẏ.
    fn truncation(&self, _from: &Self::State) -> [f64; 2] {
        [0.0; 2]
    }
}

/// The determinant of a matrix by the minors of its upper and its lower half (P.-S. Laplace): a tenth of the work of one by LU
/// factors, for matrices that are far from singular.
#[inline(always)]
fn determinant(matrix: &Matrix4<f64>) -> f64 {
    let minor = |row: usize, i: usize, j: usize| {
        matrix[(row, i)] * matrix[(row + 1, j)] - matrix[(row, j)] * matrix[(row + 1, i)]
    };
    let [upper, lower] = [0, 2].map(|row| move |i, j| minor(row, i, j));
    upper(0, 1) * lower(2, 3) - upper(0, 2) * lower(1, 3)
        + upper(0, 3) * lower(1, 2)
        + upper(1, 2) * lower(0, 3)
        - upper(1, 3) * lower(0, 2)
        + upper(2, 3) * lower(0, 1)
}

/// The derivative of an impact of a free mass.
pub fn free_mass_impact(law: &LawAt) -> Matrix4<f64> {
    let mut matrix = Matrix4::identity();
    let [gained, rebound] = law.slopes();
    (matrix[(1, 3)], matrix[(3, 3)]) = (gained, -rebound);
    matrix
}

/// The derivative of a stick of a free mass, from the primary's share μ/(1 + μ) of the gap velocity.
pub fn free_mass_stick(share: f64) -> Matrix4<f64> {
    let mut matrix = Matrix4::from_diagonal(&Vector4::new(1.0, 1.0, 0.0, 0.0));
    (matrix[(0, 2)], matrix[(1, 3)]) = (share, share);
    matrix
}
