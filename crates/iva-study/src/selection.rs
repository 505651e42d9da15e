//! What a study says of the file of a record: which columns are read, in which unit, at which sampling rate.

use std::fmt::Write;

use iva_sweep::fields::Allowed;
use iva_sweep::forces::{Column, Selection};
use toml::de::{DeTable, DeValue};

use crate::error::Error;
use crate::source::Source;
use crate::value::{Value, number};

/// The keys; `time` is a field of impulses as well.
pub(crate) const KEYS: [&str; 4] = ["column", "time", "unit", "sampling_hz"];

/// Reads the keys of a section of a force that names a record.
///
/// # Errors
/// At the place of the first invalid value.
pub(crate) fn read(source: &Source, section: &DeTable<'_>) -> Result<Selection, Error> {
    let value = |key: &str| section.get_key_value(key).map(|(_, value)| value);
    let unit = |value: &Value<'_>| match value.get_ref() {
        DeValue::String(unit) => Ok(unit.to_string()),
        _ => Err(source.bad_value("force.unit", value.span(), "give a unit, in quotes")),
    };
    let hz = |value| number(source, "force.sampling_hz", value, Allowed::Positive);
    Ok(Selection {
        column: value("column").map(|it| column(source, "force.column", it)).transpose()?,
        time: value("time").map(|it| column(source, "force.time", it)).transpose()?,
        unit: value("unit").map(unit).transpose()?,
        sampling_hz: value("sampling_hz").map(hz).transpose()?,
    })
}

/// Reads the name or the index of a column.
fn column(source: &Source, field: &str, value: &Value<'_>) -> Result<Column, Error> {
    let index = match value.get_ref() {
        DeValue::String(name) => return Ok(Column::Named(name.to_string())),
        DeValue::Integer(index) => usize::from_str_radix(index.as_str(), index.radix()).ok(),
        _ => None,
    };
    let rule = "give the name of a column, in quotes, or its index from 0";
    index.map(Column::At).ok_or_else(|| source.bad_value(field, value.span(), rule))
}

/// Writes the keys into the text of a resolved study.
pub(crate) fn write(text: &mut String, selection: &Selection) {
    let Selection { column, time, unit, sampling_hz } = selection;
    let shown = |column: &Column| match column {
        Column::Named(name) => toml::Value::from(name.as_str()).to_string(),
        Column::At(index) => index.to_string(),
    };
    let unit = unit.as_ref().map(|unit| toml::Value::from(unit.as_str()).to_string());
    let hz = sampling_hz.map(|hz| format!("{hz:?}"));
    let values = [column.as_ref().map(shown), time.as_ref().map(shown), unit, hz];
    for (key, value) in KEYS.iter().zip(values) {
        if let Some(value) = value {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{key} = {value}");
        }
    }
}
