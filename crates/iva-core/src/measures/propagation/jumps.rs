//! The derivatives of the events of a list: impacts, stops in the gap, releases and slips.
//!
//! Each is that of the state after the event with respect to that before, in q, q̇, y and ẏ of all coordinates and members
//! ([`crate::absorber::derivatives::lists`]); `carried` are the members that the structure carried along before it.

use nalgebra::{DMatrix, DVector};

use crate::absorber::derivatives::lists::{DifferentiableList, place};

/// The members that have their impact with the one at hand; empty unless that is the first of them: all of one instant are taken there.
pub(super) fn struck<S: DifferentiableList>(
    system: &S,
    before: &S::State,
    carried: &[bool],
) -> Vec<usize> {
    let strikes = |k: &usize| {
        let [distance, rate] = system.approach_of(before, *k);
        !carried[*k] && distance == 0.0 && rate < 0.0
    };
    let struck: Vec<usize> = (0..carried.len()).filter(strikes).collect();
    if struck.first() == Some(&system.at_hand(before)) { struck } else { Vec::new() }
}

/// The saltation matrix of an impact of some members between two states, by the first of them, and the rates after it.
pub(super) fn saltation<S: DifferentiableList>(
    system: &S,
    struck: &[usize],
    [before, after]: [&S::State; 2],
    carried: &[bool],
) -> (DMatrix<f64>, DVector<f64>) {
    let freed = system.carried(after, false);
    let mut jump = system.impact_matrix(struck, [before, after], [carried, &freed]);
    let f = system.rates(before, carried);
    let f_after = system.rates(after, &freed);
    if let Some(first) = struck.first() {
        let [y, _] = place(system.coordinates(), *first);
        let moved = (&f_after - &jump * &f) / f[y];
        let mut column = jump.column_mut(y);
        column += moved;
    }
    (jump, f_after)
}

/// The derivative of a stop of the member at hand in its gap, between two states.
pub(super) fn stop<S: DifferentiableList>(
    system: &S,
    [before, after]: [&S::State; 2],
    carried: &[bool],
) -> DMatrix<f64> {
    let [_, w] = place(system.coordinates(), system.at_hand(before));
    let f = system.rates(before, carried);
    let f_after = system.rates(after, &system.carried(after, false));
    let mut saltation = DMatrix::identity(f.len(), f.len());
    let mut column = saltation.column_mut(w);
    column += (f_after - &f) / f[w];
    saltation
}

/// The derivative of a release in a state: each member that is freed begins at rest on its wall.
pub(super) fn release<S: DifferentiableList>(
    system: &S,
    state: &S::State,
    carried: &[bool],
) -> DMatrix<f64> {
    let freed = system.carried(state, false);
    let mut map = slip(system, state, carried);
    for k in (0..freed.len()).filter(|k| carried[*k] && !freed[*k]) {
        for variable in place(system.coordinates(), k) {
            map.column_mut(variable).fill(0.0);
        }
    }
    map
}

/// The derivative where the member at hand begins to slide in a state: where rates jump, the saltation matrix.
pub(super) fn slip<S: DifferentiableList>(
    system: &S,
    state: &S::State,
    carried: &[bool],
) -> DMatrix<f64> {
    let before = system.rates(state, carried);
    let mut map = DMatrix::identity(before.len(), before.len());
    if let Some(gradient) = system.slip_gradient(state, carried) {
        let after = system.rates(state, &system.carried(state, false));
        map += (before - after) * gradient.transpose();
    }
    map
}
