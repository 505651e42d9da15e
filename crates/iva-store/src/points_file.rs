//! Files of the points of a sweep: Parquet, Arrow IPC or CSV, by the ending of the name. Each row is a point,
//! each column a quantity with the key of an axis as its name.

use std::io::{BufReader, Seek};
use std::path::Path;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type,
    UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch};
use arrow_ipc::reader::FileReader;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use iva_sweep::sampling::Rows;
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::errors::ParquetError;

use crate::caught::{DAMAGED, caught};
use crate::claims::{self, check_rows};
use crate::csv;
use crate::directory::Directory;
use crate::error::Error;
use crate::regular_file;

/// Largest number of columns of a file, which is more than a study has quantities.
const MOST_COLUMNS: usize = 1000;

/// Number of rows of a batch of a CSV file.
const BATCH_ROWS: usize = 1024;

/// Columns of a file of points: the key of a quantity, and its value at each point.
pub type Columns = Vec<(String, Vec<f64>)>;

type Batches = Box<dyn Iterator<Item = Result<RecordBatch, ArrowError>>>;

/// Reads a file of points. The sizes that the file states are checked before memory is allocated, and a panic
/// of the decoder is returned as an error.
///
/// # Errors
/// A sentence for a file that is not a regular one, cannot be read, is damaged or of another kind, has no
/// rows, more than 2³² rows or 4 GB, too many columns or two of one name, or a cell that is not a number.
pub fn read_points(path: &Path) -> Result<Columns, String> {
    caught(|| read(path)).unwrap_or_else(|| Err(DAMAGED.to_owned()))
}

/// Reads a file of points; damaged files may make it panic.
fn read(path: &Path) -> Result<Columns, String> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let open = || regular_file::open(path).map_err(|reason| format!("it cannot be read: {reason}"));
    let (schema, rows, batches): (_, _, Batches) = match ending {
        "parquet" => {
            let mut file = open()?;
            let refused = |reason: ParquetError| first_line(&reason.to_string());
            let builder = ParquetRecordBatchReaderBuilder::try_new(file.try_clone().map_err(said)?)
                .map_err(refused)?;
            let schema = builder.schema().clone();
            check_columns(&schema)?;
            let rows =
                claims::parquet::check(&mut file, builder.metadata(), schema.fields().len())?;
            (schema, Some(rows), Box::new(builder.build().map_err(refused)?))
        }
        "arrow" => {
            let mut file = open()?;
            let schema = claims::arrow::schema(&mut file)?;
            check_columns(&schema)?;
            let rows = claims::arrow::check(&mut file, schema.fields().len())?;
            file.rewind().map_err(said)?;
            let reader = FileReader::try_new_buffered(file, None).map_err(broken)?;
            (Arc::new(schema), Some(rows), Box::new(reader))
        }
        "csv" => {
            let file = BufReader::new(open()?);
            let reader = csv::Reader::of_numbers(file, BATCH_ROWS).map_err(broken)?;
            let schema = reader.schema();
            check_columns(&schema)?;
            (schema, None, Box::new(reader))
        }
        _ => return Err("give a file whose name ends in .parquet, .arrow or .csv".to_owned()),
    };
    let mut columns = Columns::new();
    for field in schema.fields() {
        let mut values = Vec::new();
        if let Some(rows) = rows {
            values.try_reserve_exact(rows as usize).map_err(|_| no_room(rows))?;
        }
        columns.push((field.name().clone(), values));
    }
    for batch in batches {
        append(&mut columns, &batch.map_err(broken)?)?;
    }
    match columns.first() {
        Some((_, values)) if rows.is_some_and(|rows| rows != values.len() as u64) => {
            Err(format!("it claims {} rows, but {} are in it", rows.unwrap_or(0), values.len()))
        }
        Some((_, values)) if !values.is_empty() => Ok(columns),
        _ => Err("it has no rows: a row is a point, a column a quantity".to_owned()),
    }
}

/// Checks the number of columns, and that every column has numbers and a name of its own.
///
/// # Errors
/// A sentence with the number of columns or the name of the first bad one.
fn check_columns(schema: &Schema) -> Result<(), String> {
    let fields = schema.fields();
    if fields.len() > MOST_COLUMNS {
        return Err(format!("it has {} columns; give at most {MOST_COLUMNS}", fields.len()));
    }
    for (index, field) in fields.iter().enumerate() {
        let name = field.name();
        if fields[..index].iter().any(|other| other.name() == name) {
            return Err(format!("it has two columns `{name}`"));
        }
        if !is_number(field.data_type()) {
            return Err(format!("the column `{name}` is of {}, not of numbers", field.data_type()));
        }
    }
    Ok(())
}

fn is_number(kind: &DataType) -> bool {
    kind.is_integer() || matches!(kind, DataType::Float32 | DataType::Float64)
}

fn no_room(rows: u64) -> String {
    format!("there is not enough memory for its {rows} rows")
}

fn said(reason: std::io::Error) -> String {
    format!("it cannot be read: {reason}")
}

/// The first line of a decoder's message.
fn broken(reason: ArrowError) -> String {
    match reason {
        ArrowError::ParseError(reason) | ArrowError::CsvError(reason) => first_line(&reason),
        other => first_line(&other.to_string()),
    }
}

/// Appends the rows of a batch.
fn append(columns: &mut Columns, rows: &RecordBatch) -> Result<(), String> {
    let count = columns.len();
    for ((name, values), array) in columns.iter_mut().zip(rows.columns()) {
        let before = values.len();
        // The limit is checked again for the rows that are really read.
        check_rows(before as u64 + array.len() as u64, count)?;
        let numbers = numbers(array).ok_or_else(|| {
            format!("the column `{name}` is of {}, not of numbers", array.data_type())
        })?;
        if let Some(row) = (0..numbers.len()).find(|row| numbers.is_null(*row)) {
            return Err(format!("the column `{name}` has no number in row {}", before + row + 1));
        }
        values.try_reserve(numbers.len()).map_err(|_| no_room((before + numbers.len()) as u64))?;
        values.extend_from_slice(numbers.values());
    }
    Ok(())
}

/// A column of any numeric type, converted to double precision; `None` for another type.
fn numbers(array: &ArrayRef) -> Option<Float64Array> {
    Some(match array.data_type() {
        DataType::Float64 => array.as_primitive::<Float64Type>().clone(),
        DataType::Float32 => converted::<Float32Type>(array, f64::from),
        DataType::Int8 => converted::<Int8Type>(array, f64::from),
        DataType::Int16 => converted::<Int16Type>(array, f64::from),
        DataType::Int32 => converted::<Int32Type>(array, f64::from),
        DataType::Int64 => converted::<Int64Type>(array, |it| it as f64),
        DataType::UInt8 => converted::<UInt8Type>(array, f64::from),
        DataType::UInt16 => converted::<UInt16Type>(array, f64::from),
        DataType::UInt32 => converted::<UInt32Type>(array, f64::from),
        DataType::UInt64 => converted::<UInt64Type>(array, |it| it as f64),
        _ => return None,
    })
}

fn converted<T: ArrowPrimitiveType>(
    array: &ArrayRef,
    number: impl Fn(T::Native) -> f64,
) -> Float64Array {
    array.as_primitive::<T>().unary(number)
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().to_owned()
}

/// Writes points as a new Parquet file.
///
/// # Errors
/// [`Error::Io`] if it cannot be written.
pub(crate) fn write_points(folder: &Directory, name: &Path, rows: &Rows) -> Result<(), Error> {
    let path = folder.path().join(name);
    let failed = |reason: std::io::Error| Error::io("write", &path, reason);
    let fields: Vec<Field> =
        rows.axes().iter().map(|axis| Field::new(&axis.key, DataType::Float64, false)).collect();
    let schema = Arc::new(Schema::new(fields));
    let column = |values: &Vec<f64>| Arc::new(Float64Array::from(values.clone())) as ArrayRef;
    let columns = rows.axes().iter().map(|axis| column(&axis.values)).collect();
    let file = folder.create_file(name)?;
    let write = || {
        let mut writer = ArrowWriter::try_new(file, schema.clone(), None)?;
        writer.write(&RecordBatch::try_new(schema.clone(), columns)?)?;
        writer.into_inner()
    };
    let file = write().map_err(|reason| failed(std::io::Error::other(reason)))?;
    file.sync_all().map_err(failed)
}
