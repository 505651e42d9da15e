//! The tables of one point of a study, run for a moment: where the run is labelled finished, they hold
//! numbers only.

use std::sync::atomic::AtomicBool;

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::Float64Type;
use arrow_schema::DataType;
use iva_study::{Error, StudyFile};
use iva_sweep::design::Spec;
use iva_sweep::fields::FieldId;
use iva_sweep::motion::{samples, trajectory};
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Control, SweepError, Workers, sweep};
use iva_verify::{gradients, verify};

/// At most so many impacts, and segments.
const WORK: f64 = 200.0;
/// A trajectory of more rows is left out.
const ROWS: u64 = 1000;

/// Runs the first point of a study and judges its tables.
///
/// # Errors
/// Whatever is refused.
pub fn judge(file: &StudyFile) -> Result<(), Error> {
    let located = |error| match error {
        SweepError::Invalid(invalid) => file.source.locate(&invalid),
        fault => fault.into(),
    };
    let spec = limited(file).map_err(located)?;
    let study = Study { errors: file.study.errors, ..Study::single(spec) };
    let (workers, cancel) = (Workers::new(Some(1))?, AtomicBool::new(false));
    let control = Control { workers: &workers, chunk: None, cancel: &cancel, progress: &|_| {} };
    let tables = sweep(&study, 0..1, &control).map_err(located)?;
    if !tables.get(&Table::Summary).is_some_and(is_finished) {
        return Ok(());
    }
    for (table, rows) in &tables {
        judge_rows(*table, rows);
    }
    let duration = study.design(0).map_err(|invalid| file.source.locate(&invalid))?.limits.duration;
    if samples(duration, file.samples_per_period).is_ok_and(|count| count <= ROWS) {
        let rows = trajectory(&study.spec, file.samples_per_period, &cancel).map_err(located)?;
        judge_rows(Table::Trajectory, &rows);
    }
    if study.errors {
        second_opinion(&study, &cancel).map_err(located)?;
    }
    Ok(())
}

/// The same run in the two other kinds of numbers; they take long, and are asked where errors are. (A
/// derivative may be without bound, at a grazing.)
fn second_opinion(study: &Study, cancel: &AtomicBool) -> Result<(), SweepError> {
    let verification = verify(study, cancel)?;
    for (table, rows) in &verification.errors {
        judge_rows(*table, rows);
    }
    gradients(study, "restitution", cancel)?;
    Ok(())
}

/// The first point, with a limit on its work.
fn limited(file: &StudyFile) -> Result<Spec, SweepError> {
    let mut spec = file.study.spec(0)?;
    for limit in [FieldId::MaxImpacts, FieldId::MaxWork] {
        spec.replace(limit, spec.get(limit).unwrap_or(WORK).min(WORK))?;
    }
    Ok(spec)
}

fn is_finished(summary: &RecordBatch) -> bool {
    let outcome = summary.column_by_name("outcome");
    outcome.is_some_and(|outcome| outcome.as_string::<i32>().value(0) == "finished")
}

/// Every number that is not null must be one.
fn judge_rows(table: Table, rows: &RecordBatch) {
    for (field, column) in rows.schema().fields().iter().zip(rows.columns()) {
        if *field.data_type() == DataType::Float64 {
            for number in column.as_primitive::<Float64Type>().iter().flatten() {
                let name = field.name();
                assert!(number.is_finite(), "{table}.{name} = {number} in a run labelled finished");
            }
        }
    }
}
