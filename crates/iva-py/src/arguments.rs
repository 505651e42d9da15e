//! Conversion of Python arguments into a study.

use std::collections::BTreeMap;
use std::sync::Arc;

use iva_sweep::axis::Axis;
use iva_sweep::choices::{Choices, Kind};
use iva_sweep::columns::{SUMMARY, Selection};
use iva_sweep::cube::Method;
use iva_sweep::design::Spec;
use iva_sweep::fields::{FieldId, Part, nearest};
use iva_sweep::forces::ForceSpec;
use iva_sweep::restitution_table;
use iva_sweep::sampling::{Rows, Sample, Sampling};
use iva_sweep::slot::Slot;
use iva_sweep::structure::{Entry, SECTION, Structure};
use iva_sweep::study::{Study, Table};
use iva_sweep::variable::Variable;
use iva_sweep::{Invalid, number};
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString, PyTuple};

use crate::errors::invalid;
use crate::record::PyRecord;

/// The spec of a dict `"part.field"` → number, or word where the field is a choice (the kind of
/// absorber comes before the other choices), or the list of points of a table of the restitution, or in the start a list with a number for
/// each absorber or unit; under `"forces"` it has the list of forces, under `"structure"` the entries of
/// a structure with several modes. The fields of several absorbers are `"part.number.field"`.
///
/// # Errors
/// `ValueError` for an unknown field or a value out of range.
pub fn spec(fields: &Bound<'_, PyDict>) -> PyResult<Spec> {
    let mut absorbers = vec![Choices::default()];
    for (path, word) in fields {
        if let Ok(word) = word.extract::<String>() {
            let path: String = path.extract()?;
            let (before, name) = path.rsplit_once('.').unwrap_or_default();
            let number = before.rsplit_once('.').and_then(|(_, number)| number.parse().ok());
            let number = number.unwrap_or(0).min(absorbers.len());
            if number == absorbers.len() {
                absorbers.push(Choices::default());
            }
            absorbers[number].choose(name, &word).map_err(invalid)?;
        }
    }
    let mut spec = Spec::several(&absorbers).map_err(invalid)?;
    if let Some(entries) = fields.get_item(SECTION)? {
        spec = spec.with_structure(Arc::new(structure(&entries.cast_into::<PyDict>()?)?));
    }
    let mut lists = Vec::new();
    for (path, value) in fields {
        let path: String = path.extract()?;
        if path == FORCES || path == SECTION || value.is_instance_of::<PyString>() {
            continue;
        }
        if let Some(absorber) = of_table(&path) {
            let points: Vec<[f64; 2]> = value.extract()?;
            spec.set_restitution_table(absorber, &points).map_err(invalid)?;
            continue;
        }
        let slot = slot(&path).map_err(invalid)?;
        match value.extract::<f64>() {
            Ok(number) => spec.set(slot, number).map_err(invalid)?,
            Err(_) => lists.push((slot.field, value.extract::<Vec<f64>>()?)),
        }
    }
    // The units of the absorbers are known now.
    for (field, numbers) in lists {
        spec.set_starts(field, &numbers).map_err(invalid)?;
    }
    if let Some(list) = fields.get_item(FORCES)? {
        forces(&list.extract::<Vec<Bound<'_, PyDict>>>()?, &mut spec)?;
    }
    Ok(spec)
}

/// The structure of a dict of its entries.
///
/// # Errors
/// `ValueError` naming the entry that does not fit.
pub fn structure(entries: &Bound<'_, PyDict>) -> PyResult<Structure> {
    let mut all = Vec::with_capacity(entries.len());
    for (name, value) in entries {
        let name: String = name.extract()?;
        let entry = if let Ok(one) = value.extract::<String>() {
            Entry::Name(one)
        } else if let Ok(mode) = value.extract::<usize>() {
            Entry::Mode(mode)
        } else if let Ok(named) = value.cast::<PyDict>() {
            let named = named.iter().map(|(name, value)| Ok((name.extract()?, value.extract()?)));
            Entry::Named(named.collect::<PyResult<_>>()?)
        } else if let Ok(names) = value.extract::<Vec<String>>() {
            if names.is_empty() { Entry::Numbers(Vec::new()) } else { Entry::Names(names) }
        } else if let Ok(numbers) = value.extract::<Vec<f64>>() {
            Entry::Numbers(numbers)
        } else {
            Entry::Rows(value.extract()?)
        };
        all.push((name, entry));
    }
    Structure::new(all).map_err(invalid)
}

/// The number of the absorber whose table of the restitution is at a path; `None` for another path.
fn of_table(path: &str) -> Option<usize> {
    let number = path.strip_prefix("absorber.")?.strip_suffix(restitution_table::NAME)?;
    if number.is_empty() { Some(0) } else { number.strip_suffix('.')?.parse().ok() }
}

/// Checks the table of a restitution beside the numbers given for its absorber.
///
/// # Errors
/// [`Invalid`] for a point that does not fit, and for a number that sets the restitution as well.
pub fn check_table(points: &[[f64; 2]], values: &[(String, f64)]) -> Result<(), Invalid> {
    let mut spec = Spec::default();
    for (name, value) in values {
        // What a table may contradict is of masses and pendulums.
        let shared = |field: &FieldId| field.info().kinds.contains(&Kind::Siva);
        if let Some(field) = FieldId::find(Part::Absorber, name).filter(shared) {
            spec.set(field, *value)?;
        }
    }
    spec.set_restitution_table(0, points)?;
    spec.distinct()
}

/// The place of `"part.field"`, or `"part.number.field"` for several absorbers.
fn slot(path: &str) -> Result<Slot, Invalid> {
    if path.matches('.').count() == 2 {
        return Slot::from_key(path);
    }
    let field = FieldId::all().find(|id| id.path() == path);
    let found = field.ok_or_else(|| Invalid::new("field", format!("`{path}`"), "no such field"));
    found.map(Slot::from)
}

/// Key of the list of forces in the dict of a spec.
pub const FORCES: &str = "forces";

/// Adds forces to a spec; each is a dict of field → number and, for a recorded force, `"record"` → the record.
fn forces(list: &[Bound<'_, PyDict>], spec: &mut Spec) -> PyResult<()> {
    for force in list {
        let record = match force.get_item(RECORD)? {
            Some(record) => Some(record.cast_into::<PyRecord>()?),
            None => None,
        };
        spec.add_force(ForceSpec::new(record.map(|record| record.get().recorded())));
    }
    for (number, force) in list.iter().enumerate() {
        for (name, value) in force {
            let name: String = name.extract()?;
            if name == RECORD {
                continue;
            }
            let field = FieldId::find(Part::Force, &name).ok_or_else(|| {
                invalid(Invalid::new("field", format!("`force.{name}`"), "no such field"))
            })?;
            let slot = Slot::of_force(field, number, list.len());
            spec.set(slot, value.extract()?).map_err(invalid)?;
        }
    }
    Ok(())
}

/// Key of the record in the dict of a recorded force.
pub const RECORD: &str = "record";

/// The part with a name.
///
/// # Errors
/// `ValueError` that lists the parts.
pub fn part(name: &str) -> PyResult<Part> {
    Part::ALL
        .into_iter()
        .find(|part| part.name() == name)
        .ok_or_else(|| invalid(one_of("part", name, &Part::ALL.map(Part::name))))
}

/// Checks the fields given for one part: their ranges, and that no two set the same quantity.
///
/// # Errors
/// The first unknown field or value out of range, then the first of two alternatives.
pub fn check(part: Part, values: &[(String, f64)]) -> Result<(), Invalid> {
    let mut given = Vec::with_capacity(values.len());
    for (name, value) in values {
        let field = FieldId::find(part, name).ok_or_else(|| {
            Invalid::new(format!("{}.{name}", part.name()), value, "no such field")
        })?;
        given.push((field, field.check(*value)?));
    }
    for (index, (field, value)) in given.iter().enumerate() {
        let same = |other: &&(FieldId, f64)| other.0.same_quantity(*field);
        if let Some((other, _)) = given[..index].iter().find(same) {
            return Err(Invalid::new(
                field.path(),
                number(*value),
                format!("{} is given as well; give one of them", other.path()),
            ));
        }
    }
    Ok(())
}

/// A study from a spec, points, table names and measure names (`None`: all).
///
/// # Errors
/// `ValueError` for an unknown name or invalid points.
pub fn study(
    spec: Spec,
    sampling: Sampling,
    tables: &[String],
    measures: Option<&[String]>,
    errors: bool,
) -> PyResult<Study> {
    Ok(Study {
        spec,
        sampling,
        tables: self::tables(tables).map_err(invalid)?,
        measures: self::measures(measures).map_err(invalid)?,
        errors,
    })
}

/// Swept keys, each with its values.
type Columns = Vec<(String, Vec<f64>)>;

/// The points of `("grid", columns)`, `("rows", columns, number of the first point)` or
/// `("sample", variables, method, count, seed, scramble)`; a variable is key, distribution and its
/// numbers.
///
/// # Errors
/// `ValueError` for an unknown key, no values, a value out of range, columns of unequal lengths, or
/// what makes no distribution or sample.
pub fn sampling(sampling: &Bound<'_, PyTuple>) -> PyResult<Sampling> {
    let kind: String = sampling.get_item(0)?.extract()?;
    let axes = |item: Bound<'_, PyAny>| -> PyResult<Vec<Axis>> {
        let columns: Columns = item.extract()?;
        let axes = columns.into_iter().map(|(key, values)| Axis::new(&key, values));
        axes.collect::<Result<Vec<_>, _>>().map_err(invalid)
    };
    match kind.as_str() {
        "grid" => Ok(Sampling::Grid(axes(sampling.get_item(1)?)?)),
        "rows" => {
            let first = sampling.get_item(2)?.extract()?;
            Ok(Sampling::Rows(Rows::new(axes(sampling.get_item(1)?)?, first).map_err(invalid)?))
        }
        "sample" => {
            let given: Vec<(String, String, BTreeMap<String, f64>)> =
                sampling.get_item(1)?.extract()?;
            let variables =
                given.iter().map(|(key, name, numbers)| Variable::new(key, name, numbers));
            let variables = variables.collect::<Result<Vec<_>, _>>().map_err(invalid)?;
            let name: String = sampling.get_item(2)?.extract()?;
            let method = Method::from_name(&name).ok_or_else(|| {
                invalid(one_of("sampling", &name, &Method::ALL.map(Method::name)))
            })?;
            let (count, seed, scramble) = (
                sampling.get_item(3)?.extract()?,
                sampling.get_item(4)?.extract()?,
                sampling.get_item(5)?.extract()?,
            );
            let sample = Sample::new(method, count, seed, scramble, variables);
            Ok(Sampling::Sample(sample.map_err(invalid)?))
        }
        other => Err(invalid(one_of("sampling", other, &["grid", "rows", "sample"]))),
    }
}

fn tables(names: &[String]) -> Result<Vec<Table>, Invalid> {
    let allowed = Table::SWEEP.map(Table::name);
    if names.is_empty() {
        return Err(one_of("tables", "()", &allowed));
    }
    let mut tables: Vec<Table> = names
        .iter()
        .map(|name| {
            Table::SWEEP
                .into_iter()
                .find(|table| table.name() == name)
                .ok_or_else(|| unknown("tables", name, &allowed))
        })
        .collect::<Result<_, _>>()?;
    tables.sort_unstable();
    tables.dedup();
    Ok(tables)
}

fn measures(names: Option<&[String]>) -> Result<Selection, Invalid> {
    let Some(names) = names else {
        return Ok(Selection::default());
    };
    Selection::from_names(names.iter().map(String::as_str)).map_err(|name| {
        let allowed: Vec<&str> = SUMMARY.iter().map(|column| column.name).collect();
        unknown("measures", &name, &allowed)
    })
}

/// A whole number from 1 to `most`.
///
/// # Errors
/// `TypeError` for anything but an integer, `ValueError` out of range.
pub fn whole(field: &str, value: &Bound<'_, PyAny>, most: u64) -> PyResult<u64> {
    let rule = "give a whole number, 1 or greater";
    let not_whole = || PyTypeError::new_err(format!("{field} = {}: {rule}", shown(value)));
    if value.is_instance_of::<PyBool>() {
        return Err(not_whole());
    }
    match value.extract::<i64>() {
        Ok(n) if n >= 1 && n.unsigned_abs() <= most => Ok(n.unsigned_abs()),
        Err(error) if !error.is_instance_of::<PyOverflowError>(value.py()) => Err(not_whole()),
        _ => Err(invalid(Invalid::new(field, shown(value), format!("{rule}, at most {most}")))),
    }
}

/// A Python value as text for a message, cut after 60 characters.
fn shown(value: &Bound<'_, PyAny>) -> String {
    // `str` of a huge int raises.
    let text = value.str().map_or_else(|_| "a huge number".to_owned(), |text| text.to_string());
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

/// The error for an unknown name, with the nearest known name, or with all of them if none is near.
fn unknown(field: &str, name: &str, known: &[&str]) -> Invalid {
    match nearest(name, known.iter().copied()) {
        Some(near) => {
            let rule = format!("no such name; did you mean `{near}`?");
            Invalid::new(field, format!("`{name}`"), rule)
        }
        None => one_of(field, &format!("`{name}`"), known),
    }
}

fn one_of(field: &str, value: &str, allowed: &[&str]) -> Invalid {
    Invalid::new(field, value, format!("give some of {}", allowed.join(", ")))
}
