//! Writing of rows as text with commas.

use std::fmt::Display;
use std::io::{self, Write};

use arrow_array::cast::AsArray;
use arrow_array::types::{ArrowPrimitiveType, Float64Type, Int8Type, Int64Type, UInt32Type};
use arrow_array::{Array, RecordBatch};
use arrow_schema::DataType;

/// Number of bytes that are gathered before they are written.
const PIECE: usize = 1 << 13;

/// Appends the text of the value in a row, which is not missing.
type Cell<'a> = Box<dyn Fn(usize, &mut Vec<u8>) -> io::Result<()> + 'a>;

/// Writes rows, without a header, and flushes the file.
///
/// # Errors
/// If they cannot be written; [`io::ErrorKind::Unsupported`] if a column has a type that no table has.
pub(crate) fn write_rows(file: &mut impl Write, rows: &RecordBatch) -> io::Result<()> {
    let columns = rows.columns().iter().map(|column| Ok((column, cell(column)?)));
    let columns: Vec<_> = columns.collect::<io::Result<_>>()?;
    let mut text = Vec::with_capacity(2 * PIECE);
    for row in 0..rows.num_rows() {
        let start = text.len();
        for (index, (column, cell)) in columns.iter().enumerate() {
            if index > 0 {
                text.push(b',');
            }
            if column.is_valid(row) {
                cell(row, &mut text)?;
            }
        }
        if text.len() == start {
            // An empty line would be no row.
            text.extend_from_slice(b"\"\"");
        }
        text.push(b'\n');
        if text.len() >= PIECE {
            file.write_all(&text)?;
            text.clear();
        }
    }
    file.write_all(&text)?;
    file.flush()
}

/// How the values of a column are written.
fn cell(column: &dyn Array) -> io::Result<Cell<'_>> {
    Ok(match column.data_type() {
        DataType::Float64 => {
            let values = column.as_primitive::<Float64Type>();
            Box::new(|row, text| number(values.value(row), text))
        }
        DataType::Int64 => whole::<Int64Type>(column),
        DataType::Int8 => whole::<Int8Type>(column),
        DataType::UInt32 => whole::<UInt32Type>(column),
        DataType::Boolean => {
            let values = column.as_boolean();
            Box::new(|row, text| write!(text, "{}", values.value(row)))
        }
        DataType::Utf8 => {
            let values = column.as_string::<i32>();
            Box::new(|row, text| quoted(values.value(row), text))
        }
        other => {
            let said = format!("a column of {other} cannot be written as text with commas");
            return Err(io::Error::new(io::ErrorKind::Unsupported, said));
        }
    })
}

fn whole<T: ArrowPrimitiveType<Native: Display>>(column: &dyn Array) -> Cell<'_> {
    let values = column.as_primitive::<T>();
    Box::new(|row, text| write!(text, "{}", values.value(row)))
}

/// Appends a number with the fewest digits that read back as the same, with an exponent below 1e-5 and from
/// 1e16 on.
fn number(value: f64, text: &mut Vec<u8>) -> io::Result<()> {
    let mut buffer = zmij::Buffer::new();
    // The sign of a positive exponent is left out.
    buffer.format(value).split('+').try_for_each(|part| text.write_all(part.as_bytes()))
}

/// Appends a text, in quotes if it has a comma, a quote or a line break.
fn quoted(value: &str, text: &mut Vec<u8>) -> io::Result<()> {
    if value.contains([',', '"', '\r', '\n']) {
        write!(text, "\"{}\"", value.replace('"', "\"\""))
    } else {
        text.write_all(value.as_bytes())
    }
}
