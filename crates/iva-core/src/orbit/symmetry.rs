//! Orbits that may be their own mirror image half a cycle later, or not: which of the two maps to solve.

use std::sync::atomic::AtomicBool;

use super::coordinates::Coordinates;
use super::periodic::{Missed, Orbit, find, reached};
use super::{Cycle, Trajectory};

/// A start counts as close to a symmetric orbit if the half map moves it by at most so many times as much as the map does,
const TIMES: f64 = 4.0;
/// or by no more than this over the size of its state.
const CLOSE: f64 = 1e-9;
/// An orbit counts as symmetric if the half map moves it by no more than this over the size of its state.
const SAME: f64 = 1e-7;

/// The periodic orbit near a trajectory, symmetric or not, in a scene with like walls, a level motion and a cycle of an odd
/// number of periods of one harmonic force.
///
/// Where the start is as close to its mirror image half a cycle later as it is to itself a cycle later, the half map is
/// solved first, otherwise the map; if no orbit is found so, the other one.
///
/// # Errors
/// [`Missed`] of the map, if neither finds an orbit.
pub fn find_either<S: Coordinates + Clone>(
    trajectory: &Trajectory<S>,
    cancel: Option<&AtomicBool>,
) -> Result<Orbit<S>, Missed> {
    let size = size(trajectory);
    let [by_half, by_whole] = moved(trajectory, cancel)?;
    let close = by_half <= TIMES * by_whole + CLOSE * size;
    let symmetric = || find(trajectory, true, cancel);
    if close && let Ok(orbit) = symmetric() {
        return Ok(orbit);
    }
    match find_any(trajectory, cancel) {
        Err(missed) if !close => symmetric().map_err(|_| missed),
        other => other,
    }
}

/// The periodic orbit near a trajectory in such a scene, sought by the map over the cycle. One that turns out to be
/// symmetric is solved again by the half map.
///
/// # Errors
/// [`Missed`] of the map.
pub fn find_any<S: Coordinates + Clone>(
    trajectory: &Trajectory<S>,
    cancel: Option<&AtomicBool>,
) -> Result<Orbit<S>, Missed> {
    let orbit = find(trajectory, false, cancel)?;
    let [by_half, _] = moved(&orbit.trajectory, cancel)?;
    let same = by_half <= SAME * size(&orbit.trajectory);
    let again = same.then(|| find(&orbit.trajectory, true, cancel).ok()).flatten();
    Ok(again.unwrap_or(orbit))
}

/// The size of the first state of a trajectory.
fn size<S: Coordinates>(trajectory: &Trajectory<S>) -> f64 {
    let Trajectory { system, state, .. } = trajectory;
    system.point(state).amax().max(system.clearance())
}

/// The largest change of a coordinate by the half map, and by the map.
fn moved<S: Coordinates>(
    trajectory: &Trajectory<S>,
    cancel: Option<&AtomicBool>,
) -> Result<[f64; 2], Missed> {
    let Trajectory { system, state, cycle: Cycle { begin, length }, .. } = trajectory;
    let at = system.point(state);
    let half = system.point(&reached(trajectory, begin + 0.5 * length, cancel, &mut ())?);
    let whole = system.point(&reached(trajectory, begin + length, cancel, &mut ())?);
    Ok([(half + &at).amax(), (whole - at).amax()])
}
