//! Points of a sweep from a file: Parquet, Arrow IPC or CSV, by the ending of its name. Each row is a
//! point, each column a quantity, named like an axis.

use std::fs::File;
use std::io::{BufReader, Seek};
use std::path::Path;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    ArrowPrimitiveType, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type,
    UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch};
use arrow_csv::reader::Format as CsvFormat;
use arrow_csv::{ReaderBuilder, reader::BufReader as CsvReader};
use arrow_ipc::reader::FileReader;
use arrow_schema::{ArrowError, DataType, Field, Schema};
use iva_sweep::sampling::{MAX_POINTS, Rows};
use parquet::arrow::ArrowWriter;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

use crate::directory::Directory;
use crate::error::Error;
use crate::table_file::metadata;

/// Keys with a value for each point.
pub type Columns = Vec<(String, Vec<f64>)>;

/// Reads the points of a file.
///
/// # Errors
/// A sentence for a file that cannot be read or is of another kind, that has no rows or two columns of
/// one name, and for a cell that is no number.
pub fn read_points(path: &Path) -> Result<Columns, String> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let broken = |reason: ArrowError| match reason {
        ArrowError::ParseError(reason) | ArrowError::CsvError(reason) => first_line(&reason),
        other => first_line(&other.to_string()),
    };
    let open = || File::open(path).map_err(|reason| format!("it cannot be read: {reason}"));
    type Batches = Box<dyn Iterator<Item = Result<RecordBatch, ArrowError>>>;
    let batches: Batches = match ending {
        "parquet" => Box::new(
            ParquetRecordBatchReaderBuilder::try_new(open()?)
                .and_then(|builder| builder.build())
                .map_err(|reason| first_line(&reason.to_string()))?,
        ),
        "arrow" if metadata(path).is_err() && open().is_ok() => {
            return Err("it is not an Arrow file, or not all of it".to_owned());
        }
        "arrow" => Box::new(FileReader::try_new_buffered(open()?, None).map_err(broken)?),
        "csv" => Box::new(csv(open()?).map_err(broken)?),
        _ => return Err("give a file whose name ends in .parquet, .arrow or .csv".to_owned()),
    };
    let mut columns = Columns::new();
    for batch in batches {
        append(&mut columns, &batch.map_err(broken)?)?;
    }
    match columns.first() {
        Some((_, values)) if !values.is_empty() => Ok(columns),
        _ => Err("it has no rows: a row is a point, a column a quantity".to_owned()),
    }
}

fn csv(mut file: File) -> Result<CsvReader<BufReader<File>>, ArrowError> {
    // Only the names are wanted: every column must be of numbers.
    let (heading, _) = CsvFormat::default().with_header(true).infer_schema(&file, Some(0))?;
    file.rewind()?;
    let field = |field: &Arc<Field>| Field::new(field.name().trim(), DataType::Float64, true);
    let fields: Vec<Field> = heading.fields().iter().map(field).collect();
    let builder = ReaderBuilder::new(Arc::new(Schema::new(fields))).with_header(true);
    builder.build_buffered(BufReader::new(file))
}

fn append(columns: &mut Columns, rows: &RecordBatch) -> Result<(), String> {
    let schema = rows.schema();
    if columns.is_empty() {
        for field in schema.fields() {
            if columns.iter().any(|(name, _)| name == field.name()) {
                return Err(format!("it has two columns `{}`", field.name()));
            }
            columns.push((field.name().clone(), Vec::new()));
        }
    }
    for ((name, values), array) in columns.iter_mut().zip(rows.columns()) {
        let before = values.len();
        if before as u64 + rows.num_rows() as u64 > MAX_POINTS {
            return Err("it has more than 2^32 rows".to_owned());
        }
        let numbers = numbers(array).ok_or_else(|| {
            format!("the column `{name}` is of {}, not of numbers", array.data_type())
        })?;
        if let Some(row) = (0..numbers.len()).find(|row| numbers.is_null(*row)) {
            return Err(format!("the column `{name}` has no number in row {}", before + row + 1));
        }
        values.extend_from_slice(numbers.values());
    }
    Ok(())
}

/// A column of numbers of any kind.
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
