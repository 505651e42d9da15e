//! One run: its tables, and where their columns are in memory.

use std::sync::atomic::AtomicBool;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int8Type, Int64Type, UInt32Type};
use arrow_array::{Array, RecordBatch};
use iva_sweep::Invalid;
use iva_sweep::columns::Selection;
use iva_sweep::motion::trajectory;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{SweepError, Tables, run_inline};

use crate::json::{self, list, object, text};
use crate::scene::{Scene, refused};

/// The columns of a table as numbers, NaN where there is none.
pub type Columns = Vec<Vec<f64>>;

/// Runs a scene and describes its tables; the numbers are in the columns, which the description points to.
///
/// # Errors
/// [`Invalid`] for a scene that cannot be run.
pub fn run(scene: &Scene, samples: u32) -> Result<(String, Columns), Invalid> {
    let mut study = Study::single(scene.spec.clone());
    study.measures = Selection::all();
    study.errors = true;
    let tables = tables_of(&study)?;
    let motion = trajectory(&scene.spec, samples, &AtomicBool::new(false)).map_err(invalid)?;
    let mut columns = Columns::new();
    let mut parts = vec![("units", text(study.units()?.name()))];
    for (table, batch) in &tables {
        if *table != Table::Summary {
            parts.push((table.name(), described(batch, &mut columns)));
        }
    }
    if let Some(batch) = tables.get(&Table::Summary) {
        parts.push((Table::Summary.name(), first_row(batch)));
    }
    parts.push((Table::Trajectory.name(), described(&motion, &mut columns)));
    Ok((object(parts), columns))
}

/// The tables of a study of one point, by the event loop.
///
/// Many runs side by side would be no faster here: this machine has no wide vectors.
///
/// # Errors
/// [`Invalid`] for a scene that cannot be run, and for forces other than a single harmonic one.
pub fn tables_of(study: &Study) -> Result<Tables, Invalid> {
    run_inline(study, u64::MAX).map_err(invalid)?.ok_or_else(|| refused(&study.spec))
}

/// An error of a sweep as one of its scene.
fn invalid(error: SweepError) -> Invalid {
    match error {
        SweepError::Invalid(invalid) => invalid,
        other => Invalid::new("run", "", other.to_string()),
    }
}

/// The numbers of a table: for each column its name, its place in memory, and the number of its values.
fn described(batch: &RecordBatch, columns: &mut Columns) -> String {
    let schema = batch.schema();
    let named = schema.fields().iter().zip(batch.columns()).filter_map(|(field, array)| {
        let values = numbers(array.as_ref())?;
        let place = [values.as_ptr() as usize, values.len()].map(|it| it.to_string());
        columns.push(values);
        let [pointer, length] = place;
        Some((field.name().as_str(), list([pointer, length])))
    });
    let named: Vec<_> = named.collect();
    object(named)
}

/// The values of the only row of a table.
fn first_row(batch: &RecordBatch) -> String {
    let schema = batch.schema();
    let cells = schema.fields().iter().zip(batch.columns()).map(|(field, array)| {
        let array = array.as_ref();
        let word = array.as_string_opt::<i32>().filter(|words| words.is_valid(0));
        let value = match (word, numbers(array)) {
            (Some(words), _) => text(words.value(0)),
            (None, Some(values)) => {
                values.first().map_or("null".to_owned(), |it| json::number(*it))
            }
            (None, None) => "null".to_owned(),
        };
        (field.name().as_str(), value)
    });
    let cells: Vec<_> = cells.collect();
    object(cells)
}

/// The values of a column as numbers; `None` for a column of texts.
pub fn numbers(array: &dyn Array) -> Option<Vec<f64>> {
    let known = |k: usize| array.is_valid(k);
    let each = |value: &dyn Fn(usize) -> f64| {
        (0..array.len()).map(|k| if known(k) { value(k) } else { f64::NAN }).collect()
    };
    if let Some(values) = array.as_primitive_opt::<Float64Type>() {
        return Some(each(&|k| values.value(k)));
    }
    if let Some(values) = array.as_primitive_opt::<Int64Type>() {
        return Some(each(&|k| values.value(k) as f64));
    }
    if let Some(values) = array.as_primitive_opt::<UInt32Type>() {
        return Some(each(&|k| f64::from(values.value(k))));
    }
    if let Some(values) = array.as_primitive_opt::<Int8Type>() {
        return Some(each(&|k| f64::from(values.value(k))));
    }
    let flags = array.as_boolean_opt()?;
    Some(each(&|k| f64::from(u8::from(flags.value(k)))))
}
