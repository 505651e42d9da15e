//! Single runs for a program that shows them: their rows as plain columns of numbers, from one pass over the run.
//!
//! They have the rows of the tables that a study of one point writes, and its trajectory.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use iva_core::absorber::Point;
use iva_core::error::Invalid;
use iva_core::propagation::Errors;
use iva_core::run::observed::Beside;
use iva_core::run::side_by_side::Tier;
use iva_core::simulate::Outcome;

use crate::cells::Cell;
use crate::columns::columns;
use crate::design::Design;
use crate::engine::point::{Request, run};
use crate::engine::rows::summary_row;
use crate::fields::FieldId;
use crate::motion;
use crate::study::{Study, Table};

/// Names and columns of a table, all of one length; NaN where there is no number, 1 and 0 for true and false.
pub type Columns = Vec<(&'static str, Vec<f64>)>;

/// A value of the summary.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A word.
    Text(Cow<'static, str>),
    /// Not defined in this run.
    Missing,
}

/// A run with its motion.
#[derive(Debug, Clone)]
pub struct Watched {
    /// The measures, those that were asked for.
    pub summary: Vec<(&'static str, Value)>,
    /// The tables of its events, and its trajectory.
    pub tables: BTreeMap<Table, Columns>,
    /// Energy of structure and absorber at each row of the trajectory, in the user's unit.
    pub energies: Vec<f64>,
    /// The points of a structure with several modes; none of one that moves as one.
    pub points: Points,
}

/// The motion of the points of a structure at the samples that are no events.
#[derive(Debug, Clone, Default)]
pub struct Points {
    /// Instants, in the user's unit.
    pub times: Vec<f64>,
    /// The name of each point with its displacements and velocities.
    pub motions: Vec<(String, [Vec<f64>; 2])>,
}

/// Checks that a design is run here: in the exact tier.
///
/// # Errors
/// [`Invalid`] for a tolerance.
pub fn check(design: &Design) -> Result<(), Invalid> {
    if design.tier == Tier::Exact {
        return Ok(());
    }
    let rule = "the explorer shows the exact motion; leave it out";
    Err(Invalid::new(FieldId::Tolerance.path(), "greater than 0", rule))
}

/// Runs a study of one point; its trajectory has so many samples in a period 2π/ωn.
///
/// # Errors
/// [`Invalid`] for an invalid scene or sampling, and as [`check`].
pub fn watched(study: &Study, samples_per_period: u32) -> Result<Watched, Invalid> {
    study.spec.distinct()?;
    let design = study.design(0)?;
    check(&design)?;
    let empty = |table: &Table| {
        let named = columns(*table).iter().map(|column| (column.name, Vec::new()));
        (*table, named.collect())
    };
    let shown = study.tables.iter().filter(|table| **table != Table::Summary);
    let mut tables: BTreeMap<Table, Columns> = shown.map(empty).collect();
    let request = Request::new(study);
    let mut sampler = motion::sampler(&design, samples_per_period)?;
    sampler.modes = design.scene.has_modes().then(Vec::new);
    let observed: Beside<'_> =
        (study.errors.then(Box::<Errors>::default), (Some(&mut sampler), None));
    let mut take = |table, cells: &mut dyn Iterator<Item = Cell>| {
        if let Some(columns) = tables.get_mut(&table) {
            put(columns, cells);
        }
    };
    let cancel = &AtomicBool::new(false);
    let ended = run(study, 0, &design, &request, cancel, observed, &mut take)?;
    let modes = sampler.modes.take().unwrap_or_default();
    let points = points(&design, &motion::times(&design, samples_per_period)?, &modes);
    let states = motion::in_order(sampler);
    let (_, mut trajectory) = empty(&Table::Trajectory);
    for state in &states {
        put(&mut trajectory, motion::row(&design, design.scale.time(state.time), Some(state)));
    }
    tables.insert(Table::Trajectory, trajectory);
    let energies = states.iter().map(|state| design.scale.energy(state.energy)).collect();
    let row = summary_row(study, 0, &design, &ended, &request.columns);
    let names = columns(Table::Summary).iter().map(|column| column.name);
    let summary = names.zip(row.into_iter().skip(1).map(value)).collect();
    Ok(Watched { summary, tables, energies, points })
}

/// The motion of all points of a structure at these instants, by q and q̇ of its modes there.
fn points(design: &Design, times: &[f64], modes: &[Vec<Point<f64>>]) -> Points {
    let Some(structure) = design.scene.modes() else { return Points::default() };
    let scale = &design.scale;
    let motions = structure.points().map(|name| {
        let shapes = structure.shapes(name).unwrap_or_default();
        let at = |of: fn(&Point<f64>) -> f64| {
            let sum = |all: &Vec<Point<f64>>| shapes.iter().zip(all).map(|(s, q)| s * of(q)).sum();
            modes.iter().map(sum).collect::<Vec<f64>>()
        };
        let speeds = at(|q| q.v).into_iter().map(|v| scale.velocity(v));
        (name.to_owned(), [at(|q| q.x), speeds.collect()])
    });
    let times = times.iter().zip(modes).map(|(time, _)| scale.time(*time));
    Points { times: times.collect(), motions: motions.collect() }
}

/// The value of one measure at all points of a study, NaN where it is not defined and where the run ended early, so that no
/// value is that of a part of a run.
///
/// # Errors
/// [`Invalid`] for an invalid point, and as [`check`].
pub fn measured(study: &Study, name: &str) -> Result<Vec<f64>, Invalid> {
    study.spec.distinct()?;
    study.sampling.check(&study.spec)?;
    let study = &Study { tables: vec![Table::Summary], ..study.clone() };
    let request = Request::new(study);
    let column = 1
        + study.sampling.keys().count()
        + request.columns.iter().position(|column| column.name() == name).unwrap_or(0);
    let mut designer = study.designer();
    let cancel = &AtomicBool::new(false);
    let mut values = Vec::new();
    for point in 0..study.points()? {
        let design = designer.design(point)?;
        check(&design)?;
        let beside = Beside::default();
        let ended = run(study, point, &design, &request, cancel, beside, &mut |_, _| {})?;
        let row = summary_row(study, point, &design, &ended, &request.columns);
        let whole = ended.tally.outcome == Outcome::Finished;
        let cell = row.into_iter().nth(column).filter(|_| whole);
        values.push(cell.map_or(f64::NAN, number));
    }
    Ok(values)
}

/// Adds a row, which begins with its point, to the columns of a table.
fn put(columns: &mut Columns, cells: impl Iterator<Item = Cell>) {
    for ((_, column), cell) in columns.iter_mut().zip(cells.skip(1)) {
        column.push(number(cell));
    }
}

/// A cell as a number. Adding +0 makes 0 of −0, as in the tables.
fn number(cell: Cell) -> f64 {
    match cell {
        Cell::Number(value) => value + 0.0,
        Cell::Point(value) => f64::from(value),
        Cell::Count(value) => value as f64,
        Cell::Side(value) => f64::from(value),
        Cell::Flag(value) => f64::from(u8::from(value)),
        Cell::Text(_) | Cell::Null => f64::NAN,
    }
}

fn value(cell: Cell) -> Value {
    match cell {
        Cell::Text(word) => Value::Text(word),
        Cell::Null => Value::Missing,
        other => Value::Number(number(other)),
    }
}
