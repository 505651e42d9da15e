//! Bifurcation diagrams: the strobes of a steady state for one value of a parameter after another, each begun where the last one
//! has ended.
//!
//! So an attractor is followed until it ends, and where there are two the diagram upwards is another than that downwards:
//! hysteresis.

use std::sync::atomic::{AtomicBool, AtomicU64};

use super::coordinates::{Coordinates, Strobe as _};
use super::lyapunov::Window;
use super::{Trajectory, map};
use crate::absorber::Clock;
use crate::engine::simulate::Outcome;
use crate::error::Invalid;
use crate::run::side_by_side::{is_set, one_more};

/// The order in which the values of a parameter are gone through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// From the first one to the last one.
    Up,
    /// From the last one to the first one.
    Down,
}

/// The state at the end of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strobe<T> {
    /// All numbers of the state.
    pub at: T,
    /// Number of listed impacts in the cycle.
    pub impacts: u64,
}

/// The strobes for one value of the parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Column<T> {
    /// The strobes after the cycles left out, in order of time.
    pub strobes: Vec<Strobe<T>>,
    /// How the last cycle ended. If it did not finish, there are fewer strobes, and the next value begins from its own start.
    pub outcome: Outcome,
}

/// A trajectory from the state with these numbers in another scene. Where a gap is too narrow for them, the absorber is
/// put on the wall; `None` if the numbers are not in range.
fn put<S: Coordinates + Clone>(
    trajectory: &Trajectory<S>,
    at: &S::Strobe,
) -> Option<Trajectory<S>> {
    let Trajectory { system, cycle, .. } = trajectory;
    let mut numbers = at.numbers().to_vec();
    for (place, absorber) in system.gaps() {
        let clearance = system.clearance_of(absorber);
        numbers[place] = numbers[place].clamp(-clearance, clearance);
    }
    let start = system.start_at_strobe(&S::Strobe::with(&numbers))?;
    let state = system.begin_at(&start, Clock::new(cycle.begin));
    Some(trajectory.from(&state))
}

/// The columns of a bifurcation diagram, in the order of the trajectories: one for each value of the parameter. The first value of
/// the direction begins from the state of its trajectory. Once cancelled, the rest has no strobes.
/// `done` counts the columns.
///
/// The values depend on each other, so that they are run one after the other; a diagram upwards and one downwards do not.
///
/// # Errors
/// [`Invalid`] if a cycle has no length or begins before time zero.
pub fn diagram<S: Coordinates + Clone>(
    trajectories: &[Trajectory<S>],
    direction: Direction,
    window: Window,
    cancel: Option<&AtomicBool>,
    done: Option<&AtomicU64>,
) -> Result<Vec<Column<S::Strobe>>, Invalid> {
    for trajectory in trajectories {
        trajectory.limits()?;
    }
    let mut columns = Vec::with_capacity(trajectories.len());
    let mut last: Option<S::Strobe> = None;
    for step in 0..trajectories.len() {
        let trajectory = match direction {
            Direction::Up => &trajectories[step],
            Direction::Down => &trajectories[trajectories.len() - 1 - step],
        };
        let begun = last.and_then(|at| put(trajectory, &at));
        let (column, end) = column(begun.unwrap_or_else(|| trajectory.clone()), window, cancel)?;
        last = end;
        columns.push(column);
        one_more(done);
    }
    if direction == Direction::Down {
        columns.reverse();
    }
    Ok(columns)
}

/// A column, and the state at its end if it finished.
type Ended<T> = (Column<T>, Option<T>);

/// One column.
fn column<S: Coordinates + Clone>(
    mut trajectory: Trajectory<S>,
    Window { discard, keep }: Window,
    cancel: Option<&AtomicBool>,
) -> Result<Ended<S::Strobe>, Invalid> {
    let mut strobes = vec![];
    for cycle in 0..discard.saturating_add(keep) {
        let image = map(&trajectory, false, cancel)?;
        if image.outcome != Outcome::Finished || is_set(cancel) {
            let outcome = if is_set(cancel) { Outcome::Cancelled } else { image.outcome };
            return Ok((Column { strobes, outcome }, None));
        }
        trajectory.state = image.state;
        if cycle >= discard {
            let at = trajectory.system.strobe(&image.state);
            strobes.push(Strobe { at, impacts: image.impacts });
        }
    }
    let end = trajectory.system.strobe(&trajectory.state);
    Ok((Column { strobes, outcome: Outcome::Finished }, Some(end)))
}
