//! The rows of one run as cells, in any number: for what compares runs cell by cell.

use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use iva_core::real::Real;
pub use iva_core::run::observed::{Beside, Closeness};
use iva_core::run::side_by_side::Tier;

pub use crate::cells::Cell;
pub use crate::engine::point::{Estimates, Observes, ObservesAny};
pub use crate::engine::rows::Estimate;
pub use crate::tables::Content;

use crate::engine::design::Design;
use crate::engine::point::{Request, run};
use crate::engine::rows::summary_row;
use crate::error::Invalid;
use crate::side_by_side;
use crate::study::{Study, Table};
use crate::sweep::SweepError;
use crate::tables::{TableBuilder, schema_of};

/// Rows with the tables that they are of; those of one table are in order.
pub type Rows<R> = Vec<(Table, Vec<Cell<R>>)>;

/// The rows of the first point of a study, by the event loop.
///
/// # Errors
/// [`Invalid`] if the core refuses the design.
pub fn rows<R: Real>(
    study: &Study,
    design: &Design<R>,
    cancel: &AtomicBool,
    beside: impl ObservesAny<R>,
) -> Result<Rows<R>, Invalid> {
    let (mut rows, request) = (Vec::new(), Request::new(study));
    let ended = run(study, 0, design, &request, cancel, beside, &mut |table, cells| {
        rows.push((table, cells.collect()));
    })?;
    if request.summary {
        rows.push((Table::Summary, summary_row(study, 0, design, &ended, &request.columns)));
    }
    Ok(rows)
}

/// As [`rows`] in doubles, compiled here.
///
/// # Errors
/// As [`rows`].
pub fn rows_in_doubles(
    study: &Study,
    design: &Design,
    cancel: &AtomicBool,
    beside: Beside<'_>,
) -> Result<Rows<f64>, Invalid> {
    rows(study, design, cancel, beside)
}

/// The rows of the first point of a study as a sweep has them, from its tier.
///
/// # Errors
/// [`Invalid`] for an invalid design.
pub fn rows_of_sweep(study: &Study, cancel: &AtomicBool) -> Result<Rows<f64>, Invalid> {
    let (design, request) = (study.design(0)?, Request::new(study));
    let fast = design.tier == Tier::Fast && !request.lists();
    let designs = if fast { std::slice::from_ref(&design) } else { &[] };
    let Some((ended, _)) = side_by_side::run(designs, &request, cancel)?.pop().flatten() else {
        return rows(study, &design, cancel, Beside::default());
    };
    Ok(vec![(Table::Summary, summary_row(study, 0, &design, &ended, &request.columns))])
}

/// A table of errors or derivatives.
///
/// # Errors
/// [`SweepError`] for lengths in two units, or a row that does not fit the columns.
pub fn table(
    study: &Study,
    table: Table,
    content: &Content,
    rows: impl IntoIterator<Item = Vec<Cell>>,
) -> Result<RecordBatch, SweepError> {
    let mut builder = TableBuilder::new(schema_of(study, table, content)?, 1);
    rows.into_iter().for_each(|row| builder.row(row));
    Ok(builder.finish()?)
}
