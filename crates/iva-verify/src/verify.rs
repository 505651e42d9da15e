//! The true errors of a run: the run is repeated in numbers of twice the precision, and the rows are
//! compared.
//!
//! The second run is the same code with another number type ([`iva_core::real::twofold`]) and the same
//! doubles as input. A pendulum runs at full accuracy whatever tolerance was given. The errors of the second
//! run are some 1e-20, so the difference of the two is the error of the first, conversion of units included.
//! A mistake in the method would affect both; tests against independent programs would find it.

use std::sync::atomic::AtomicBool;

use iva_core::error::Invalid;
use iva_core::real::twofold::Twofold;
use iva_sweep::columns::columns;
use iva_sweep::engine::given::Given;
use iva_sweep::fields::FieldId;
use iva_sweep::listed::{Cell, Content, Rows, rows, rows_of_sweep, table};
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{SweepError, Tables};

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
    let first = rows_of_sweep(study, cancel)?;
    let second = in_twofold(study, cancel)?;
    let mut verification = Verification { errors: Tables::new(), findings: Vec::new() };
    for &of in study.tables.iter().filter(|table| Table::SWEEP.contains(table)) {
        let (first, second) = (rows_of(&first, of), rows_of(&second, of));
        let same = first.iter().zip(&second).take_while(|(a, b)| alike(of, a, b)).count();
        let rows = [first.len(), second.len()];
        let mut finding = Finding { table: of, rows, alike: same, largest: None };
        let mut errors = Vec::with_capacity(first.len());
        for (index, row) in first.iter().enumerate() {
            let truth = second.get(index).filter(|_| index < same);
            let cells = row.iter().enumerate().map(|(place, cell)| {
                let error = error(cell, truth.map(|truth| &truth[place]));
                if let Cell::Number(error) = error {
                    finding.take(error, place);
                }
                error
            });
            errors.push(cells.collect());
        }
        verification.errors.insert(of, table(study, of, &Content::Errors, errors)?);
        verification.findings.push(finding);
    }
    Ok(verification)
}

/// The rows of one table.
pub(crate) fn rows_of<R>(rows: &Rows<R>, table: Table) -> Vec<&[Cell<R>]> {
    rows.iter().filter(|row| row.0 == table).map(|row| &*row.1).collect()
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
pub(crate) fn alike(table: Table, a: &[Cell], b: &[Cell<Twofold>]) -> bool {
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

/// The rows of the run in numbers of twice the precision, at full accuracy.
fn in_twofold(study: &Study, cancel: &AtomicBool) -> Result<Rows<Twofold>, Invalid> {
    let mut spec = study.spec(0)?;
    if spec.get(FieldId::Tolerance).is_some() {
        spec.set(FieldId::Tolerance, 0.0)?;
    }
    rows(study, &Given::new(&spec).design()?, cancel, ())
}
