//! Bifurcation diagrams over a field of a scene, in the user's units, see [`iva_core::orbit::diagram`].

use iva_core::error::{Invalid, number};
use iva_core::orbit::diagram::{self, Column, Strobe};
use iva_core::orbit::{Coordinates, Trajectory};

use super::family::{Family, OfMember, changeable, middled, with_member};
use super::starts::{Numbers, Startable};
use super::{Outcome, Tracker};
use crate::design::Spec;
use crate::slot::Slot;
use crate::sweep::SweepError;
use crate::workers::Workers;

pub use iva_core::orbit::diagram::Direction;
pub use iva_core::orbit::lyapunov::Window;

/// The strobes for one value of the field, in one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Strobes {
    /// The value.
    pub value: f64,
    /// The direction.
    pub direction: Direction,
    /// Displacement and velocity at each strobe, gap displacement and gap velocity of each absorber.
    pub states: Vec<Numbers>,
    /// Number of listed impacts in the cycle before each strobe.
    pub impacts: Vec<u64>,
    /// How the last cycle ended.
    pub outcome: Outcome,
}

/// The strobes for increasing values of a field, in each direction one after the other. The first value of a direction begins from
/// the start of the spec. Directions go on threads of their own.
///
/// # Errors
/// [`SweepError::Invalid`] as [`Family::new`], if the field is one of the start or of the run, or the values do not increase.
pub fn diagram(
    spec: &Spec,
    (over, values): (Slot, &[f64]),
    directions: &[Direction],
    window: Window,
    tracker: Tracker<'_>,
) -> Result<Vec<Strobes>, SweepError> {
    check(over, values)?;
    // Where a motion does not go on from the last value, it begins in the middle of the gap, which fits any clearance.
    let middle = middled(spec)?;
    let families = |from: &Spec, values: &[f64]| -> Result<Vec<Family>, Invalid> {
        values.iter().map(|value| Family::new(from, Some((over, *value)), 1)).collect()
    };
    let all = families(&middle, values)?;
    let one = |index: u64| -> Result<Vec<Strobes>, Invalid> {
        let direction = directions[index as usize];
        let first = if direction == Direction::Up { 0 } else { values.len() - 1 };
        let begin = Family::new(spec, Some((over, values[first])), 1)?;
        let mut all = all.clone();
        all[first] = begin;
        with_member!(&all[first].member, |it| strobes(
            (&all, it),
            values,
            direction,
            window,
            tracker
        ))
    };
    let parts = Workers::new(None)?.map(directions.len() as u64, one);
    let parts: Result<Vec<_>, Invalid> = parts.into_iter().collect();
    Ok(parts?.concat())
}

/// Checks the field and its values.
fn check(over: Slot, values: &[f64]) -> Result<(), Invalid> {
    changeable(over)?;
    if values.is_empty() {
        return Err(Invalid::missing(over.path(), "give at least one value"));
    }
    match values.windows(2).find(|pair| pair[0].is_nan() || pair[1].is_nan() || pair[0] >= pair[1])
    {
        Some(pair) => {
            Err(Invalid::new(over.path(), number(pair[1]), "give values in increasing order"))
        }
        None => Ok(()),
    }
}

/// The strobes of one direction.
fn strobes<S: OfMember + Startable>(
    (families, _): (&[Family], &Trajectory<S>),
    values: &[f64],
    direction: Direction,
    window: Window,
    Tracker { cancel, done }: Tracker<'_>,
) -> Result<Vec<Strobes>, Invalid> {
    let trajectories: Vec<_> = families.iter().filter_map(|it| S::of(it.member.clone())).collect();
    let columns = diagram::diagram(&trajectories, direction, window, Some(cancel), Some(done))?;
    let rows = columns.into_iter().zip(families.iter().zip(&trajectories)).zip(values);
    type Whole<'a, S> =
        ((Column<<S as Coordinates>::Strobe>, (&'a Family, &'a Trajectory<S>)), &'a f64);
    let shown = |((column, (family, trajectory)), value): Whole<'_, S>| {
        let Column { strobes, outcome } = column;
        let numbers = |it: &Strobe<S::Strobe>| family.numbers_at(&trajectory.system, &it.at);
        let states = strobes.iter().map(numbers).collect();
        let impacts = strobes.iter().map(|it| it.impacts).collect();
        Strobes { value: *value, direction, states, impacts, outcome }
    };
    Ok(rows.map(shown).collect())
}
