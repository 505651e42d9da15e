//! The derivatives of the events of a list: impacts, stops in the gap, releases and slips.
//!
//! Each is that of the state after the event with respect to that before, in q, q̇, y and ẏ of all coordinates and members
//! ([`crate::absorber::derivatives::lists`]); `carried` are the members that the structure carried along before it.

use nalgebra::DVector;

use crate::absorber::derivatives::lists::{DifferentiableList, add, place, slip};
use crate::absorber::derivatives::maps::Map;

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

/// The saltation matrix of an impact of some members between two states, by the first of them, and the rates after it; `carried` before it
/// and after it.
pub(super) fn saltation<'a, S: DifferentiableList>(
    system: &'a S,
    struck: &[usize],
    [before, after]: [&S::State; 2],
    carried: [&'a [bool]; 2],
) -> (Map<'a>, DVector<f64>) {
    let mut jump = system.impact_map(struck, [before, after], carried);
    let mut moved = system.rates(before, carried[0]);
    let f_after = system.rates(after, carried[1]);
    let y = struck.first().map_or(0, |first| place(system.coordinates(), *first)[0]);
    let speed = moved[y];
    jump(moved.as_mut_slice());
    let moved = (&f_after - moved) / speed;
    let map = Box::new(move |it: &mut [f64]| {
        let late = it[y];
        jump(it);
        add(it, late, &moved);
    });
    (map, f_after)
}

/// The derivative of a stop of the member at hand in its gap, between two states.
pub(super) fn stop<'a, S: DifferentiableList>(
    system: &S,
    [before, after]: [&S::State; 2],
    carried: &[bool],
) -> Map<'a> {
    let [_, w] = place(system.coordinates(), system.at_hand(before));
    let f = system.rates(before, carried);
    let f_after = system.rates(after, &system.carried(after, false));
    let moved = (f_after - &f) / f[w];
    Box::new(move |it| add(it, it[w], &moved))
}

/// The derivative of a release in a state: each member that is freed begins at rest on its wall.
pub(super) fn release<'a, S: DifferentiableList>(
    system: &S,
    state: &S::State,
    carried: &[bool],
) -> Map<'a> {
    let after = system.carried(state, false);
    let freed = (0..after.len()).filter(|k| carried[*k] && !after[*k]);
    let freed: Vec<_> = freed.flat_map(|k| place(system.coordinates(), k)).collect();
    let mut slip = slip(system, state, carried);
    Box::new(move |it| {
        freed.iter().for_each(|variable| it[*variable] = 0.0);
        slip(it);
    })
}
