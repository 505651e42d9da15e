//! What a list of absorbers tells about its derivatives.
//!
//! A small difference of a state is one of q and q̇ of the structure, then of y and ẏ of each absorber.

use nalgebra::{DMatrix, DVector};

use super::maps::Map;
use crate::absorber::Absorber;

/// The end of a motion, as its rounding errors see it.
#[derive(Debug)]
pub struct Moved<'a, S> {
    /// The states at its begin and end. A linear system is asked with its end for both.
    pub states: [&'a S; 2],
    /// The rates of all variables at both ends.
    pub rates: [&'a DVector<f64>; 2],
    /// Which absorbers are carried.
    pub carried: &'a [bool],
    /// Its length.
    pub length: f64,
}

/// Several absorbers on one structure, or one whose motion has more phases than flight and ride, whose motion can be
/// differentiated.
pub trait DifferentiableList: Absorber<Real = f64> {
    /// True if the derivatives of the motion are those of a linear equation: known for any length, and the same from any
    /// state. Then the estimate needs the states at events only.
    fn is_linear(&self) -> bool;

    /// Number of coordinates of the structure.
    fn coordinates(&self) -> usize;

    /// The derivative of all variables with respect to q, q̇, y and ẏ at the begin.
    fn derivative_at_begin(&self) -> DMatrix<f64>;

    /// The derivative of all variables by the numbers of a state that are independent, and the indices of these.
    fn by_numbers(&self) -> &(DMatrix<f64>, Vec<usize>);

    /// [`DifferentiableList::flow`] to some twelve digits.
    fn fine_flow<'a>(&'a self, from: &Self::State, carried: &'a [bool], h: f64) -> Map<'a>;

    /// Which absorbers the structure carries along in a state; `sticks`: the one at hand has come to rest on its wall.
    fn carried(&self, state: &Self::State, sticks: bool) -> Vec<bool>;

    /// The rates of all variables while these absorbers are carried.
    fn rates(&self, state: &Self::State, carried: &[bool]) -> DVector<f64>;

    /// The derivative of a motion of length h in which these absorbers are carried.
    fn flow<'a>(&'a self, from: &Self::State, carried: &'a [bool], h: f64) -> Map<'a>;

    /// Sizes of the numbers that a motion rounds independently, for each variable.
    fn roundings(&self, moved: &Moved<'_, Self::State>) -> DVector<f64>;

    /// Sizes of the terms of the rates before they cancel: the rounding errors that are the same at every rebound are
    /// proportional to these. `None`: the rates are computed to twice the precision.
    fn sizes(&self, _state: &Self::State, _carried: &[bool]) -> Option<DVector<f64>> {
        None
    }

    /// The derivative of the instant at which the absorber at hand has begun to slide in a state with respect to the state before, in which
    /// these absorbers were carried; `None` where no rate jumps there.
    fn slip_gradient(&self, _state: &Self::State, _carried: &[bool]) -> Option<DVector<f64>> {
        None
    }

    /// Error of y of an absorber per rounding of its position at a state: 1, or cosθ where it is computed from cosθ.
    fn sharpness(&self, _state: &Self::State, _absorber: usize) -> f64 {
        1.0
    }

    /// The derivative of the state after an impact of these absorbers, between two states, with respect to that before, at a
    /// fixed instant; `carried` before and after it.
    fn impact_map<'a>(
        &'a self,
        struck: &[usize],
        states: [&Self::State; 2],
        carried: [&'a [bool]; 2],
    ) -> Map<'a>;

    /// The derivative of the state after the absorber at hand has come to rest on its wall; `carried` with it.
    fn stick_map(&self, state: &Self::State, carried: &[bool]) -> Map<'_>;

    /// How long the rebounds of the chatter of the absorber at hand last that begin in a state, by the first of them.
    fn tail(&self, after: &Self::State) -> f64;

    /// How much the pressure on the wall of an absorber may change by changes of the variables.
    fn pressing(&self, absorber: usize, changes: &dyn Fn(usize) -> f64) -> f64;
}

/// The indices of y and ẏ of an absorber.
pub fn place(coordinates: usize, absorber: usize) -> [usize; 2] {
    let y = 2 * (coordinates + absorber);
    [y, y + 1]
}

/// [`DifferentiableList::tail`] of a free mass. With friction the way back takes 1/q times as long as the way out, q = √((A − R)/(A + R)).
pub(crate) fn tail_of<S: Absorber<Real = f64> + ?Sized>(system: &S, after: &S::State) -> f64 {
    let leave = system.distance(after);
    let law = system.law_of(system.at_hand(after), system.wall(after), leave.rate);
    let out = leave.rate / leave.curvature.abs();
    let back = system.back(after);
    let slower = back.map_or(1.0, |back| (back.pressure / leave.curvature.abs()).sqrt());
    out * (1.0 + 1.0 / slower) / (1.0 - law.rebound * slower)
}

/// The derivative where the member at hand begins to slide in a state: where rates jump, the saltation matrix.
pub(crate) fn slip<'a, S: DifferentiableList>(
    system: &S,
    state: &S::State,
    carried: &[bool],
) -> Map<'a> {
    let Some(gradient) = system.slip_gradient(state, carried) else { return Box::new(|_| ()) };
    let after = system.rates(state, &system.carried(state, false));
    let moved = system.rates(state, carried) - after;
    Box::new(move |it| {
        let late = gradient.iter().zip(&*it).map(|(by, own)| by * own).sum();
        add(it, late, &moved);
    })
}

/// Adds a change so many times.
pub(crate) fn add(it: &mut [f64], times: f64, change: &DVector<f64>) {
    it.iter_mut().zip(change.iter()).for_each(|(own, change)| *own += times * change);
}
