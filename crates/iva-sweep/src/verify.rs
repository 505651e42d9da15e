//! The true errors of a run: the run is repeated in numbers of twice the precision, and the rows are
//! compared.
//!
//! The second run is the same code with another number type ([`iva_core::real::twofold`]) and the same
//! doubles as input. A pendulum runs at full accuracy whatever tolerance was given. The errors of the second
//! run are some 1e-20, so the difference of the two is the error of the first, conversion of units included.
//! A mistake in the method would affect both; tests against independent programs would find it.

use std::sync::atomic::AtomicBool;

use crate::cells::Cell;
use crate::columns::columns;
use crate::engine::design::Design;
use crate::engine::given::Given;
use crate::engine::point::{Estimates, Request, run};
use crate::engine::rows::summary_row;
use crate::error::Invalid;
use crate::fields::FieldId;
use crate::side_by_side;
use crate::study::{Study, Table};
use crate::sweep::{SweepError, Tables};
use crate::tables::{Content, TableBuilder, schema_of};
use iva_core::absorber::Absorber;
use iva_core::real::Real;
use iva_core::real::twofold::Twofold;
use iva_core::run::side_by_side::Tier;

/// The results of a verification.
#[derive(Debug, Clone)]
pub struct Verification {
    /// The tables of the run with the errors of their numbers in place of the numbers: value minus truth;
    /// null where there is no number, or where the two runs no longer have the same events. All other cells
    /// are those of the run.
    pub errors: Tables,
    /// One finding for each of these tables.
    pub findings: Vec<Finding>,
}

/// The results of a verification for one table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finding {
    /// The table.
    pub table: Table,
    /// Number of its rows in the run, and in the second run.
    pub rows: [usize; 2],
    /// Number of rows, from the first on, that describe the same events in both runs.
    pub alike: usize,
    /// The largest error in these rows, and its column.
    pub largest: Option<(f64, &'static str)>,
}

impl Finding {
    /// True if both runs have the same rows, apart from the errors of their numbers.
    pub fn agrees(&self) -> bool {
        self.rows == [self.alike; 2]
    }
}

/// Runs a study without axes twice.
///
/// # Errors
/// [`SweepError`] for an invalid design.
pub fn verify(study: &Study, cancel: &AtomicBool) -> Result<Verification, SweepError> {
    let first = in_doubles(study, cancel)?;
    let second = in_twofold(study, cancel)?;
    let mut verification = Verification { errors: Tables::new(), findings: Vec::new() };
    for &table in study.tables.iter().filter(|table| Table::SWEEP.contains(table)) {
        let mut builder = TableBuilder::new(schema_of(study, table, &Content::Errors)?, 1);
        let first: Vec<_> = first.iter().filter(|row| row.0 == table).map(|row| &row.1).collect();
        let second: Vec<_> = second.iter().filter(|row| row.0 == table).map(|row| &row.1).collect();
        let same = first.iter().zip(&second).take_while(|(a, b)| alike(table, a, b)).count();
        let mut finding =
            Finding { table, rows: [first.len(), second.len()], alike: same, largest: None };
        for (index, row) in first.iter().enumerate() {
            let truth = second.get(index).filter(|_| index < same);
            builder.row(row.iter().enumerate().map(|(place, cell)| {
                let error = error(cell, truth.map(|truth| &truth[place]));
                if let Cell::Number(error) = error {
                    finding.take(error, place);
                }
                error
            }));
        }
        verification.errors.insert(table, builder.finish()?);
        verification.findings.push(finding);
    }
    Ok(verification)
}

impl Finding {
    fn take(&mut self, error: f64, place: usize) {
        // The first cell is `point`, which has no column.
        let name = columns(self.table)[place - 1].name;
        if self.largest.is_none_or(|(largest, _)| error.abs() > largest) {
            self.largest = Some((error.abs(), name));
        }
    }
}

/// The error of a number; any other cell unchanged.
fn error(cell: &Cell, truth: Option<&Cell<Twofold>>) -> Cell {
    match (cell, truth) {
        (Cell::Number(value), Some(Cell::Number(truth))) => {
            Cell::Number(f64::from(*value - *truth))
        }
        (Cell::Number(_), _) => Cell::Null,
        (other, _) => other.clone(),
    }
}

/// True if two rows describe the same events: their cells have the same types and nulls, and are equal unless
/// they are numbers. The column `tier` may differ, because the second run is always exact.
fn alike(table: Table, a: &[Cell], b: &[Cell<Twofold>]) -> bool {
    let is_tier = |place: usize| place > 0 && columns(table)[place - 1].name == "tier";
    a.iter().zip(b).enumerate().all(|(place, cells)| match cells {
        _ if is_tier(place) => true,
        (Cell::Number(_), Cell::Number(_)) | (Cell::Null, Cell::Null) => true,
        (Cell::Point(a), Cell::Point(b)) => a == b,
        (Cell::Count(a), Cell::Count(b)) => a == b,
        (Cell::Side(a), Cell::Side(b)) => a == b,
        (Cell::Text(a), Cell::Text(b)) => a == b,
        (Cell::Flag(a), Cell::Flag(b)) => a == b,
        _ => false,
    })
}

type Rows<R> = Vec<(Table, Vec<Cell<R>>)>;

fn in_doubles(study: &Study, cancel: &AtomicBool) -> Result<Rows<f64>, Invalid> {
    let (design, request) = (study.design(0)?, Request::new(study));
    let fast = design.tier == Tier::Fast && !request.lists();
    let designs = if fast { std::slice::from_ref(&design) } else { &[] };
    let Some((ended, _)) = side_by_side::run(designs, &request, cancel)?.pop().flatten() else {
        return rows(study, &design, cancel);
    };
    Ok(vec![(Table::Summary, summary_row(study, 0, &design, &ended, &request.columns))])
}

fn in_twofold(study: &Study, cancel: &AtomicBool) -> Result<Rows<Twofold>, Invalid> {
    let mut spec = study.spec(0)?;
    if spec.get(FieldId::Tolerance).is_some() {
        spec.set(FieldId::Tolerance, 0.0)?;
    }
    rows(study, &Given::new(&spec).design()?, cancel)
}

fn rows<R: Real>(
    study: &Study,
    design: &Design<R>,
    cancel: &AtomicBool,
) -> Result<Rows<R>, Invalid> {
    let (mut rows, request) = (Vec::new(), Request::new(study));
    let ended = run(study, 0, design, &request, cancel, (), &mut |table, cells| {
        rows.push((table, cells.collect()));
    })?;
    if request.summary {
        rows.push((Table::Summary, summary_row(study, 0, design, &ended, &request.columns)));
    }
    Ok(rows)
}

impl<S: Absorber> Estimates<S> for () {}
