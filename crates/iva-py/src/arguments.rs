//! From Python arguments to a study.

use iva_sweep::Invalid;
use iva_sweep::columns::{Measures, SUMMARY};
use iva_sweep::design::Spec;
use iva_sweep::fields::{FieldId, Part, nearest};
use iva_sweep::study::{Axis, Study, Table};
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};

use crate::errors::invalid;

/// The spec of a dict `"part.field"` → number.
///
/// # Errors
/// `ValueError` for an unknown field or a value out of range.
pub fn spec(fields: &Bound<'_, PyDict>) -> PyResult<Spec> {
    let mut spec = Spec::default();
    for (path, value) in fields {
        let path: String = path.extract()?;
        let field = FieldId::all()
            .find(|id| id.path() == path)
            .ok_or_else(|| unknown(&path, FieldId::all().map(FieldId::path)))
            .map_err(invalid)?;
        spec.set(field, value.extract()?).map_err(invalid)?;
    }
    Ok(spec)
}

/// The part of that name.
///
/// # Errors
/// `ValueError` that lists the parts.
pub fn part(name: &str) -> PyResult<Part> {
    Part::ALL
        .into_iter()
        .find(|part| part.name() == name)
        .ok_or_else(|| invalid(one_of("part", name, Part::ALL.map(Part::name).iter())))
}

/// A study from a spec, named axes, table names and measure names (`None`: all).
///
/// # Errors
/// `ValueError` for an unknown name, an empty axis, or a value out of range.
pub fn study(
    spec: Spec,
    axes: Vec<(String, Vec<f64>)>,
    tables: &[String],
    measures: Option<&[String]>,
) -> PyResult<Study> {
    let axes = axes
        .into_iter()
        .map(|(key, values)| Axis::new(&key, values))
        .collect::<Result<Vec<_>, _>>()
        .map_err(invalid)?;
    Ok(Study {
        spec,
        axes,
        tables: self::tables(tables).map_err(invalid)?,
        measures: self::measures(measures).map_err(invalid)?,
    })
}

fn tables(names: &[String]) -> Result<Vec<Table>, Invalid> {
    let allowed = Table::SWEEP.map(Table::name);
    if names.is_empty() {
        return Err(one_of("tables", "()", allowed.iter()));
    }
    let mut tables: Vec<Table> = names
        .iter()
        .map(|name| {
            Table::SWEEP
                .into_iter()
                .find(|table| table.name() == name)
                .ok_or_else(|| one_of("tables", &format!("`{name}`"), allowed.iter()))
        })
        .collect::<Result<_, _>>()?;
    tables.sort_unstable();
    tables.dedup();
    Ok(tables)
}

fn measures(names: Option<&[String]>) -> Result<Measures, Invalid> {
    let Some(names) = names else {
        return Ok(Measures::all());
    };
    Measures::from_names(names.iter().map(String::as_str)).map_err(|name| {
        let allowed = SUMMARY.iter().map(|column| &column.name);
        one_of("measures", &format!("`{name}`"), allowed)
    })
}

/// A whole number from 1 to `most`.
///
/// # Errors
/// `TypeError` for anything but an integer, `ValueError` out of range.
pub fn whole(field: &str, value: &Bound<'_, PyAny>, most: u64) -> PyResult<u64> {
    let rule = "give a whole number, 1 or greater";
    let not_whole = || PyTypeError::new_err(format!("{field} = {value}: {rule}"));
    if value.is_instance_of::<PyBool>() {
        return Err(not_whole());
    }
    match value.extract::<i64>() {
        Ok(n) if n >= 1 && n.unsigned_abs() <= most => Ok(n.unsigned_abs()),
        Err(error) if !error.is_instance_of::<PyOverflowError>(value.py()) => Err(not_whole()),
        _ => Err(invalid(Invalid::new(field, value, format!("{rule}, at most {most}")))),
    }
}

fn unknown(name: &str, known: impl Iterator<Item = String>) -> Invalid {
    let known: Vec<String> = known.collect();
    let hint = nearest(name, known.iter().map(String::as_str))
        .map_or(String::new(), |near| format!("; did you mean `{near}`?"));
    Invalid::new("field", format!("`{name}`"), format!("no such field{hint}"))
}

fn one_of<'a>(
    field: &str,
    value: &str,
    allowed: impl Iterator<Item = &'a &'static str>,
) -> Invalid {
    let allowed: Vec<&str> = allowed.copied().collect();
    Invalid::new(field, value, format!("give some of {}", allowed.join(", ")))
}
