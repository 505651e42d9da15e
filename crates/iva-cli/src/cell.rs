//! Single cells of a result table, as numbers or text for the terminal.

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int8Type, Int32Type, Int64Type, UInt32Type, UInt64Type};
use arrow_array::{Array, RecordBatch};
use arrow_schema::DataType;

/// The numeric value of a cell; `None` for null, for text and for an unknown column.
pub(crate) fn number(rows: &RecordBatch, column: &str, row: usize) -> Option<f64> {
    let array = rows.column_by_name(column)?;
    if row >= array.len() || array.is_null(row) {
        return None;
    }
    match array.data_type() {
        DataType::Float64 => Some(array.as_primitive::<Float64Type>().value(row)),
        DataType::UInt64 => Some(array.as_primitive::<UInt64Type>().value(row) as f64),
        DataType::Int64 => Some(array.as_primitive::<Int64Type>().value(row) as f64),
        DataType::UInt32 => Some(array.as_primitive::<UInt32Type>().value(row).into()),
        DataType::Int32 => Some(array.as_primitive::<Int32Type>().value(row).into()),
        DataType::Int8 => Some(array.as_primitive::<Int8Type>().value(row).into()),
        _ => None,
    }
}

/// The text of a cell, `yes` or `no` for a flag; `None` for null, for numbers and for an unknown column.
pub(crate) fn text<'a>(rows: &'a RecordBatch, column: &str, row: usize) -> Option<&'a str> {
    let array = rows.column_by_name(column)?;
    if row >= array.len() || array.is_null(row) {
        return None;
    }
    match array.data_type() {
        DataType::Utf8 => Some(array.as_string::<i32>().value(row)),
        DataType::LargeUtf8 => Some(array.as_string::<i64>().value(row)),
        DataType::Utf8View => Some(array.as_string_view().value(row)),
        DataType::Boolean => Some(if array.as_boolean().value(row) { "yes" } else { "no" }),
        _ => None,
    }
}

/// A number rounded to a count of significant digits, without zeros at its end.
pub(crate) fn short(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    match text.split_once('e') {
        Some((mantissa, exponent)) => format!("{}e{exponent}", trim_zeros(mantissa)),
        None => trim_zeros(&text).to_owned(),
    }
}

/// The numbers of one column, all with the fewest decimals that every one of them needs.
pub(crate) fn aligned(values: &[f64], digits: usize) -> Vec<String> {
    let texts: Vec<String> = values.iter().map(|value| short(*value, digits)).collect();
    if texts.iter().any(|text| text.contains('e')) {
        return texts;
    }
    let decimals = texts
        .iter()
        .map(|text| text.split_once('.').map_or(0, |(_, decimals)| decimals.len()))
        .max()
        .unwrap_or(0);
    values.iter().map(|value| format!("{value:.decimals$}")).collect()
}

/// A number rounded to a count of significant digits, with zeros at its end so that columns line up.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = digits.max(1);
    // The exponent is that of the rounded number (9.9996 → 10.00).
    let scientific = format!("{value:.*e}", digits - 1);
    let exponent: i32 =
        scientific.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    if exponent < -4 || exponent >= digits.max(7) as i32 {
        return scientific;
    }
    let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
    format!("{value:.decimals$}")
}

fn trim_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// A time rounded for reading, with its unit.
pub(crate) fn duration(seconds: f64) -> String {
    if seconds < 1e-3 {
        "less than 1 ms".to_owned()
    } else if seconds < 1.0 {
        format!("about {:.0} ms", seconds * 1e3)
    } else if seconds < 10.0 {
        format!("about {seconds:.1} s")
    } else if seconds < 120.0 {
        format!("about {seconds:.0} s")
    } else if seconds < 7200.0 {
        format!("about {:.0} min", seconds / 60.0)
    } else if seconds < 172_800.0 {
        format!("about {:.1} h", seconds / 3600.0)
    } else {
        format!("about {:.1} days", seconds / 86_400.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_they_can_be() {
        assert_eq!(short(0.1 + 0.2, 6), "0.3");
        assert_eq!(short(12.0, 6), "12");
        assert_eq!(short(1e-6, 6), "1e-6");
        assert_eq!(short(-1234567.0, 6), "-1234567");
        assert_eq!(short(1.23456789e12, 6), "1.23457e12");
        assert_eq!(short(0.0, 6), "0");
    }

    #[test]
    fn a_column_has_the_same_decimals_throughout() {
        assert_eq!(aligned(&[1.0, 0.1 + 0.2, 1.25], 6), ["1.00", "0.30", "1.25"]);
        assert_eq!(aligned(&[10.0, 2.0], 6), ["10", "2"]);
        assert_eq!(aligned(&[1e-6, 0.5], 6), ["1e-6", "0.5"]);
    }

    #[test]
    fn significant_digits_survive_rounding_up() {
        assert_eq!(significant(9.9996, 4), "10.00");
        assert_eq!(significant(39.2112, 4), "39.21");
        assert_eq!(significant(0.012345, 4), "0.01235");
        assert_eq!(significant(0.1 - 0.1, 4), "0");
    }
}
