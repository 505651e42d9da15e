//! Derivatives of results by what is given: a run in numbers with a derivative ([`crate::dual`]).
//!
//! Every number of every row comes with its derivative, in the user's units: of event times through
//! the implicit function theorem, of states through impacts with the jump of their rates (the saltation
//! matrix, here a consequence of plain differentiation), of summed chatters and measures by their
//! formulas. A measure that jumps (a settling time, where the last crossing moves to another half cycle) has
//! the derivative of the branch it is on.

use std::sync::atomic::AtomicBool;

use iva_core_dual::impact::Impact;
use iva_core_dual::observe::{Jump, Observer};
use iva_core_dual::system::System;

use crate::dual;
use crate::dual::point::{Estimates, Request, run};
use crate::dual::rows::Cell as DualCell;
use crate::dual::scale::Scale;
use crate::error::Invalid;
use crate::fields::{FieldId, Part};
use crate::slot::Slot;
use crate::study::{Study, Table};
use crate::sweep::{SweepError, Tables};
use crate::tables::{Cell, Content, TableBuilder, schema_of};

/// An impact is close to a grazing if so small a relative change of the parameter could make it one, to
/// first order (of a parameter that is 0, an absolute change).
const GRAZING: f64 = 1e-3;

/// Numbers that decide when a run stops or what it lists: nothing is differentiated by them.
const NOT_PHYSICAL: [FieldId; 5] = [
    FieldId::MaxImpacts,
    FieldId::MaxWork,
    FieldId::Tolerance,
    FieldId::ChatterFloor,
    FieldId::Discard,
];

/// The tables of a study without axes with derivatives in the places of numbers; all else is as in the
/// run, but for `near_grazing` of the impacts: true from the first impact on that is close to a grazing.
///
/// `key` names the parameter as a sweep would.
///
/// # Errors
/// [`SweepError`] for an unknown key, a parameter that is not given and has no default, or an invalid
/// design.
pub fn gradients(study: &Study, key: &str, cancel: &AtomicBool) -> Result<Tables, SweepError> {
    let slot =
        Slot::from_key(key).map_err(|error| Invalid { field: "gradients".to_owned(), ..error })?;
    let mut spec = study.spec(0)?;
    let value = given(&mut spec, slot)?;
    let design = dual::given::Given::differentiated(&spec, slot).design()?;
    let request = Request::new(study);
    let grazings = Grazings::new(value);
    let content = Content::Derivatives { by: slot, key: key.to_owned() };
    let mut builders = Vec::new();
    for &table in study.tables.iter().filter(|table| Table::SWEEP.contains(table)) {
        builders.push((table, TableBuilder::new(schema_of(study, table, &content)?, 1)));
    }
    run(study, 0, &design, &request, cancel, grazings, &mut |table, cells| {
        if let Some((_, builder)) = builders.iter_mut().find(|it| it.0 == table) {
            builder.row(cells.map(derivative));
        }
    })?;
    builders.into_iter().map(|(table, builder)| Ok((table, builder.finish()?))).collect()
}

/// The value of what is differentiated by; a default is filled in.
fn given(spec: &mut crate::design::Spec, slot: Slot) -> Result<f64, Invalid> {
    let refused = |rule: &str| Invalid::new("gradients", format!("`{}`", slot.path()), rule);
    if NOT_PHYSICAL.contains(&slot.field) {
        return Err(refused("the motion does not depend on it"));
    }
    let found =
        spec.given().find(|(other, _)| other.field == slot.field && other.same_quantity(slot));
    if let Some((_, value)) = found {
        return Ok(value);
    }
    if let Some((other, _)) = spec.given().find(|(other, _)| other.same_quantity(slot)) {
        return Err(refused(&format!("{} is given in its place; give that name", other.path())));
    }
    match slot.field.default().filter(|_| slot.info().part != Part::Force) {
        Some(value) => spec.set(slot, value).map(|()| value),
        None => Err(refused("it is not given")),
    }
}

fn derivative(cell: DualCell) -> Cell {
    match cell {
        Cell::Point(point) => Cell::Point(point),
        Cell::Number(number) => {
            let [slope] = number.slopes;
            if slope.is_finite() { Cell::Number(slope) } else { Cell::Null }
        }
        Cell::Count(count) => Cell::Count(count),
        Cell::Side(side) => Cell::Side(side),
        Cell::Text(text) => Cell::Text(text),
        Cell::Flag(flag) => Cell::Flag(flag),
        Cell::Null => Cell::Null,
    }
}

/// Watches how close impacts come to grazings.
struct Grazings {
    /// The change of the parameter that counts as small.
    change: f64,
    /// D̈ before the impact under way, where it bends the path away from the wall.
    curvature: Option<f64>,
    /// One has been met.
    met: bool,
    /// Of each listed impact: approach speed, and whether one was met until then.
    impacts: Vec<(f64, bool)>,
}

impl Grazings {
    fn new(value: f64) -> Self {
        let change = GRAZING * if value == 0.0 { 1.0 } else { value.abs() };
        Self { change, curvature: None, met: false, impacts: Vec::new() }
    }
}

impl<S: System> Observer<S> for Grazings {
    fn jump(&mut self, system: &S, jump: &Jump<'_, S::State>) {
        if let Jump::Impact { before, .. } = jump {
            self.curvature = Some(system.distance(before).curvature.value.max(0.0));
        }
    }

    fn impact(&mut self, _system: &S, impact: &Impact) {
        let speed = impact.approach_speed().value;
        if let Some(curvature) = self.curvature.take() {
            // The distance moves by w dτ; it makes a grazing of the impact from w²/(2|D̈|) on.
            let [slope] = impact.time.slopes;
            let near = 2.0 * curvature * (slope * self.change).abs() >= speed;
            self.met |= near || !slope.is_finite();
        }
        self.impacts.push((speed, self.met));
    }

    fn unlist(&mut self, first: u64, floor: iva_core_dual::real::Real) {
        let mut index = 0;
        self.impacts.retain(|(speed, _)| {
            index += 1;
            index <= first || *speed > floor
        });
    }
}

impl<S: System> Estimates<S> for Grazings {
    fn of_impact(&self, index: usize, _scale: &Scale) -> [DualCell; 2] {
        let near = self.impacts.get(index).map_or(Cell::Null, |(_, met)| Cell::Flag(*met));
        [Cell::Null, near]
    }
    fn of_run(&self) -> [DualCell; 2] {
        [Cell::Null, Cell::Null]
    }
}
