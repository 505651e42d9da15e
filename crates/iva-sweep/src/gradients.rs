//! Derivatives of results with respect to a given number, by a run in numbers with a derivative
//! ([`iva_core::real::dual`]).
//!
//! Every number of every row comes with its derivative, in the user's units: for event times by the implicit
//! function theorem, for states across impacts with the jump of their rates (the saltation matrix, which here
//! follows from differentiating the code), for summed chatters and measures by their formulas. A measure that
//! jumps (a settling time, where the last crossing moves to another half cycle) has the derivative of its
//! current branch.
//!
//! The values of that run have the same bits as those of the run in doubles, so both have the same events.
//! From the first impact whose estimated error reaches 10⁻³/ωn on, all derivatives are null.

use std::sync::atomic::AtomicBool;

use iva_core::absorber::Absorber;
use iva_core::impact::Impact;
use iva_core::observe::{Contact, Events, Observer};
use iva_core::propagation::Errors;
use iva_core::real::dual::Dual;
use iva_core::simulate::simulate_from;

use crate::cells::Cell;
use crate::choices::Kind;
use crate::columns::columns;
use crate::design::{Design, Spec};
use crate::engine::given::Given;
use crate::engine::point::{Estimates, Request, run};
use crate::engine::rows::{Estimate, summary_row};
use crate::engine::scene::with_system;
use crate::error::Invalid;
use crate::fields::{Allowed, FieldId, Part, Quantity};
use crate::slot::Slot;
use crate::study::{Study, Table};
use crate::sweep::{SweepError, Tables};
use crate::tables::{Content, TableBuilder, schema_of};

/// Relative change of the parameter (absolute for a parameter of 0) that must be able to turn an impact into
/// a grazing, to first order, for the impact to count as close to one.
const GRAZING: f64 = 1e-3;

/// Estimated error of an impact time, in 1/ωn, from which on the motion is too sensitive for derivatives:
/// beyond it rounding decides which impacts follow.
const SENSITIVE: f64 = 1e-3;

/// Fields that decide when a run stops or what it lists: results are not differentiated with respect to them.
const NOT_PHYSICAL: [FieldId; 5] = [
    FieldId::MaxImpacts,
    FieldId::MaxWork,
    FieldId::Tolerance,
    FieldId::ChatterFloor,
    FieldId::Discard,
];

/// Fields that are 0 where a scene is of another kind, which a run does not have: without friction or dashpot, or with an
/// impulse that is part of the start.
const OTHER_AT_ZERO: [FieldId; 4] =
    [FieldId::Friction, FieldId::GapDamping, FieldId::GapDampingRatio, FieldId::ImpulseTime];

/// The tables of a study without axes, with derivatives in place of numbers. All else is as in the run,
/// except `near_grazing` of the impacts, which is true from the first impact on that is close to a grazing.
/// The summary has the additional column `sensitive_from`: the instant from which on derivatives are null
/// because the motion is too sensitive.
///
/// `key` names the parameter as in a sweep.
///
/// # Errors
/// [`SweepError`] for an unknown key, a parameter that is not given and has no default, or an invalid
/// design.
pub fn gradients(study: &Study, key: &str, cancel: &AtomicBool) -> Result<Tables, SweepError> {
    let slot =
        Slot::from_key(key).map_err(|error| Invalid { field: "gradients".to_owned(), ..error })?;
    let mut spec = study.spec(0)?;
    let value = given(study, &mut spec, slot)?;
    if value == 0.0 && OTHER_AT_ZERO.contains(&slot.field) {
        let rule = "at 0 it has no derivative, as the scene is of another kind; give a number above 0, or sweep it";
        return Err(Invalid::new("gradients", format!("`{}`", slot.path()), rule).into());
    }
    let design = Given::<Dual>::differentiated(&spec, slot).design()?;
    let request = Request::new(study);
    let plain = spec.design()?;
    let sensitive = sensitive_from(&plain, cancel)?.map(|time| plain.scale.time(time));
    let period = plain.scale.time(std::f64::consts::TAU);
    let grazings = Grazings::new(value);
    let content = Content::Derivatives { by: slot, key: key.to_owned() };
    let mut builders = Vec::new();
    for &table in study.tables.iter().filter(|table| Table::SWEEP.contains(table)) {
        builders.push((table, TableBuilder::new(schema_of(study, table, &content)?, 1)));
    }
    let mut take = |table, cells: &mut dyn Iterator<Item = Cell<Dual>>| {
        if let Some((_, builder)) = builders.iter_mut().find(|it| it.0 == table) {
            let cells: Vec<Cell<Dual>> = cells.collect();
            let known = |index: usize| {
                sensitive.is_none_or(|from| is_known(table, &cells, index, from, period))
            };
            let derivatives = cells.iter().enumerate().map(|(index, cell)| match cell {
                Cell::Number(_) if !known(index) => Cell::Null,
                cell => derivative(cell.clone()),
            });
            let last = (table == Table::Summary).then(|| Cell::number(sensitive, |time| time));
            builder.row(derivatives.chain(last));
        }
    };
    let ended = run(study, 0, &design, &request, cancel, grazings, &mut take)?;
    let row = summary_row(study, 0, &design, &ended, &request.columns);
    take(Table::Summary, &mut row.into_iter());
    builders.into_iter().map(|(table, builder)| Ok((table, builder.finish()?))).collect()
}

/// The instant of the first impact that is too sensitive, in 1/ωn; `None` if there is none.
fn sensitive_from(design: &Design, cancel: &AtomicBool) -> Result<Option<f64>, Invalid> {
    let mut observers = (Errors::default(), Events::default());
    let (limits, cancel) = (&design.limits, Some(cancel));
    with_system!(&design.scene, |it| {
        simulate_from(&it.system, &it.start, design.begin, limits, cancel, &mut observers)
            .map(|_| ())
    })?;
    let (errors, events) = observers;
    let sensitive = |time: Option<f64>| time.is_none_or(|error| error >= SENSITIVE);
    let first = errors.impacts.iter().position(|error| sensitive(error.time));
    Ok(first.and_then(|index| Some(events.impacts.get(index)?.time)))
}

/// True if a number of a row is decided before the instant from which on the motion is too sensitive.
fn is_known(table: Table, row: &[Cell<Dual>], index: usize, from: f64, period: f64) -> bool {
    let columns = columns(table);
    // The first cell is `point`, which has no column.
    let before = |index: usize| match (&row[index], columns[index - 1].quantity) {
        (Cell::Number(time), Quantity::Time) => time.value < from,
        _ => true,
    };
    match (table, columns[index - 1].name) {
        (Table::Summary, "settling_time_10" | "settling_time_5" | "settling_time_2") => {
            before(index)
        }
        (Table::Summary, "energy_initial" | "gravity") => true,
        (Table::Summary, "damping_ratio_energy") => period < from,
        // All others depend on the whole run.
        (Table::Summary | Table::Absorbers, _) => false,
        // An event is known if all its instants are.
        _ => (1..row.len()).all(before),
    }
}

/// The value of the parameter; if it was not given, its default is set in the spec.
fn given(study: &Study, spec: &mut Spec, slot: Slot) -> Result<f64, Invalid> {
    let refused = |rule: &str| Invalid::new("gradients", format!("`{}`", slot.path()), rule);
    if NOT_PHYSICAL.contains(&slot.field) {
        return Err(refused("the motion does not depend on it"));
    }
    if slot.info().part != Part::Force {
        spec.check(slot).map_err(|rule| refused(&rule))?;
    }
    if matches!(slot.info().allowed, Allowed::Units | Allowed::Exponent) {
        return Err(refused("it has values apart from each other; sweep it"));
    }
    let found =
        spec.given().find(|(other, _)| other.field == slot.field && other.same_quantity(slot));
    // The derivative at 0 does not exist: with any inclination the absorber starts elsewhere.
    let inclines = slot.field.same_quantity(FieldId::Inclination);
    let rubs = spec.get_of(0, FieldId::Friction).is_some_and(|friction| friction != 0.0);
    let weighs = slot.field == FieldId::Gravity && spec.choices().kind == Kind::Siva && !rubs;
    if (inclines || weighs) && !study.rises() {
        return Err(refused("the line of motion is level; give one that rises"));
    }
    if let Some((_, value)) = found {
        return Ok(value);
    }
    if let Some((other, _)) = spec.given().find(|(other, _)| other.same_quantity(slot)) {
        return Err(refused(&format!("{} is given in its place; give that name", other.path())));
    }
    match study.default(slot.field).filter(|_| slot.info().part != Part::Force) {
        Some(value) => spec.set(slot, value).map(|()| value),
        None => Err(refused("it is not given")),
    }
}

fn derivative(cell: Cell<Dual>) -> Cell {
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

/// An observer that finds impacts close to grazings.
struct Grazings {
    /// The small change of the parameter.
    change: f64,
    /// D̈ just before the current impact, 0 unless it bends the path away from the wall.
    curvature: Option<f64>,
    /// True once an impact was close to a grazing.
    met: bool,
    /// For each listed impact: absorber, approach speed, and whether it or an earlier one was close to a grazing.
    impacts: Vec<(u8, f64, bool)>,
}

impl Grazings {
    fn new(value: f64) -> Self {
        let change = GRAZING * if value == 0.0 { 1.0 } else { value.abs() };
        Self { change, curvature: None, met: false, impacts: Vec::new() }
    }
}

impl<S: Absorber<Real = Dual>> Observer<S> for Grazings {
    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State, Dual>) {
        let Contact { states: [before, _], summed, .. } = contact;
        if !summed {
            self.curvature = Some(system.distance(before).curvature.value.max(0.0));
        }
    }

    fn impact(&mut self, _system: &S, impact: &Impact<Dual>) {
        let speed = impact.approach_speed().value;
        if let Some(curvature) = self.curvature.take() {
            // The distance changes by w dτ; a change of w²/(2|D̈|) turns the impact into a grazing.
            let [slope] = impact.time.slopes;
            let near = 2.0 * curvature * (slope * self.change).abs() >= speed;
            self.met |= near || !slope.is_finite();
        }
        self.impacts.push((impact.absorber, speed, self.met));
    }

    fn unlist(&mut self, absorber: u8, first: u64, floor: Dual) {
        let mut index = 0;
        self.impacts.retain(|(of, speed, _)| {
            let mine = *of == absorber;
            index += u64::from(mine);
            !mine || index <= first || *speed > floor
        });
    }
}

impl<S: Absorber<Real = Dual>> Estimates<S> for Grazings {
    fn of_impact(&self, index: usize) -> Estimate<Dual> {
        Estimate { time: None, near_grazing: self.impacts.get(index).map(|(.., met)| *met) }
    }
}
