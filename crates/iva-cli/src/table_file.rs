//! One part of a table as a file: the same rows always give the same bytes.

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_csv::WriterBuilder;
use arrow_ipc::reader::read_footer_length;
use arrow_ipc::root_as_footer;
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, FieldRef, Schema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;

use crate::error::Error;
use crate::output::PART_POINTS;

/// Rows of a row group: a constant, so that the bytes do not depend on the machine.
const ROW_GROUP_ROWS: usize = 1 << 20;

/// What tables are written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Format {
    /// Parquet: small, typed, with units in its metadata
    #[default]
    Parquet,
    /// Arrow IPC: larger, opened without decoding, with units in its metadata
    Arrow,
    /// Text with commas; numbers as short as they can be read back exactly
    Csv,
}

impl Format {
    /// Every format.
    pub const ALL: [Format; 3] = [Format::Parquet, Format::Arrow, Format::Csv];

    /// What file names end in, and what `--format` calls it.
    pub fn name(self) -> &'static str {
        match self {
            Format::Parquet => "parquet",
            Format::Arrow => "arrow",
            Format::Csv => "csv",
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// How tables are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Style {
    /// The kind of file.
    pub format: Format,
    /// In CSV files a second line with the unit of each column.
    pub units_row: bool,
}

/// The schema of a part: that of its table, with `iva.first_point` and `iva.part_points`, the points
/// that it covers.
pub fn part_schema(schema: &Schema, part: u64) -> SchemaRef {
    let mut metadata = schema.metadata().clone();
    let points = metadata.get("iva.points").and_then(|points| points.parse::<u64>().ok());
    let first = part * PART_POINTS;
    let count = points.map_or(0, |points| points.saturating_sub(first).min(PART_POINTS));
    metadata.insert("iva.first_point".to_owned(), first.to_string());
    metadata.insert("iva.part_points".to_owned(), count.to_string());
    Arc::new(Schema::new_with_metadata(schema.fields().clone(), metadata))
}

/// A file being written.
pub struct TableFile {
    path: PathBuf,
    schema: SchemaRef,
    writer: Writer,
}

enum Writer {
    Parquet(Box<ArrowWriter<File>>),
    Arrow(Box<FileWriter<BufWriter<File>>>),
    Csv(Box<arrow_csv::Writer<BufWriter<File>>>),
}

impl TableFile {
    /// Creates the file; without any rows it holds its schema only.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be created or written.
    pub fn create(path: &Path, schema: SchemaRef, style: Style) -> Result<Self, Error> {
        let file = File::create_new(path).map_err(|reason| Error::io("create", path, reason))?;
        let writer = match style.format {
            Format::Parquet => {
                let writer = parquet_writer(file, schema.clone());
                Writer::Parquet(Box::new(writer.map_err(|error| parquet_fault(path, error))?))
            }
            Format::Arrow => {
                let writer = FileWriter::try_new(BufWriter::new(file), &schema);
                Writer::Arrow(Box::new(writer.map_err(|error| arrow_fault(path, error))?))
            }
            Format::Csv => {
                let mut file = BufWriter::new(file);
                file.write_all(csv_head(&schema, style.units_row).as_bytes())
                    .map_err(|reason| Error::io("write", path, reason))?;
                Writer::Csv(Box::new(WriterBuilder::new().with_header(false).build(file)))
            }
        };
        Ok(Self { path: path.to_owned(), schema, writer })
    }

    /// Appends rows.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written.
    pub fn append(&mut self, rows: &RecordBatch) -> Result<(), Error> {
        let Self { path, schema, writer } = self;
        // The same columns, with the metadata of the part.
        let rows = rows.clone().with_schema(schema.clone()).map_err(|e| arrow_fault(path, e))?;
        match writer {
            Writer::Parquet(writer) => writer.write(&rows).map_err(|e| parquet_fault(path, e)),
            Writer::Arrow(writer) => writer.write(&rows).map_err(|e| arrow_fault(path, e)),
            Writer::Csv(writer) => writer.write(&rows).map_err(|e| arrow_fault(path, e)),
        }
    }

    /// Completes the file and sees it onto the disk; returns its size in bytes.
    ///
    /// # Errors
    /// [`Error::Io`] if that fails.
    pub fn finish(self) -> Result<u64, Error> {
        let Self { path, writer, .. } = self;
        let failed = |reason| Error::io("write", &path, reason);
        let unbuffered =
            |file: BufWriter<File>| file.into_inner().map_err(|error| failed(error.into_error()));
        let file = match writer {
            Writer::Parquet(writer) => {
                writer.into_inner().map_err(|error| parquet_fault(&path, error))?
            }
            Writer::Arrow(writer) => {
                unbuffered(writer.into_inner().map_err(|error| arrow_fault(&path, error))?)?
            }
            Writer::Csv(writer) => unbuffered(writer.into_inner())?,
        };
        file.sync_all().and_then(|()| file.metadata()).map(|found| found.len()).map_err(failed)
    }
}

/// The metadata of an Arrow file, which few readers of its columns show.
///
/// # Errors
/// [`Error::Io`] if it cannot be read or is no Arrow file.
pub fn metadata(path: &Path) -> Result<BTreeMap<String, String>, Error> {
    let read = || {
        let bytes = footer(path)?;
        // The reader of the library would also build the schema, and panic over a broken one.
        let footer = root_as_footer(&bytes).map_err(|_| io::ErrorKind::InvalidData)?;
        let pairs = footer.schema().and_then(|schema| schema.custom_metadata());
        let text = |value: Option<&str>| value.unwrap_or_default().to_owned();
        let pairs = pairs.into_iter().flatten();
        Ok(pairs.map(|pair| (text(pair.key()), text(pair.value()))).collect())
    };
    read().map_err(|reason: io::Error| {
        use io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
        let broken = matches!(reason.kind(), InvalidData | InvalidInput | UnexpectedEof);
        let said = "it is not an Arrow file, or not all of it";
        Error::io("read", path, if broken { io::Error::other(said) } else { reason })
    })
}

/// The end of an Arrow file, which describes the rest.
fn footer(path: &Path) -> io::Result<Vec<u8>> {
    // A length of four bytes, and the six letters of the format.
    const END: usize = 10;
    let mut file = File::open(path)?;
    let mut end = [0; END];
    file.seek(SeekFrom::End(-(END as i64)))?;
    file.read_exact(&mut end)?;
    let length = read_footer_length(end).map_err(|_| io::ErrorKind::InvalidData)?;
    file.seek(SeekFrom::End(-((END + length) as i64)))?;
    let mut footer = vec![0; length];
    file.read_exact(&mut footer)?;
    Ok(footer)
}

/// Bytes that rows take as a Parquet file; used for estimates.
///
/// # Errors
/// [`Error::Internal`] if they cannot be encoded.
pub fn encoded_size(schema: SchemaRef, batches: &[RecordBatch]) -> Result<u64, Error> {
    let memory = Path::new("memory");
    let fault = |error| parquet_fault(memory, error);
    let mut writer = parquet_writer(Vec::new(), schema).map_err(fault)?;
    for batch in batches {
        writer.write(batch).map_err(fault)?;
    }
    Ok(writer.into_inner().map_err(fault)?.len() as u64)
}

fn parquet_writer<W: Write + Send>(
    sink: W,
    schema: SchemaRef,
) -> Result<ArrowWriter<W>, ParquetError> {
    let properties = WriterProperties::builder()
        .set_created_by(concat!("iva-dynamics ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_compression(Compression::SNAPPY)
        .set_max_row_group_row_count(Some(ROW_GROUP_ROWS))
        .set_key_value_metadata(Some(key_values(&schema)))
        .build();
    ArrowWriter::try_new(sink, schema, Some(properties))
}

/// The schema metadata once more as Parquet keys, for readers that know no Arrow; sorted.
fn key_values(schema: &Schema) -> Vec<KeyValue> {
    let mut pairs: Vec<(String, String)> =
        schema.metadata().iter().map(|(key, value)| (key.clone(), value.clone())).collect();
    pairs.sort();
    pairs.into_iter().map(|(key, value)| KeyValue::new(key, value)).collect()
}

/// The first line of a CSV file, and the second if units are asked for. No name or unit has a comma.
fn csv_head(schema: &Schema, units_row: bool) -> String {
    let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
    let mut head = format!("{}\n", names.join(","));
    if units_row {
        let units = |field: &FieldRef| field.metadata().get("unit").cloned().unwrap_or_default();
        let units: Vec<String> = schema.fields().iter().map(units).collect();
        head.push_str(&units.join(","));
        head.push('\n');
    }
    head
}

fn arrow_fault(path: &Path, error: ArrowError) -> Error {
    match error {
        ArrowError::IoError(_, reason) => Error::io("write", path, reason),
        ArrowError::CsvError(reason) => Error::io("write", path, io::Error::other(reason)),
        other => Error::Internal(format!("{}: {other}", path.display())),
    }
}

fn parquet_fault(path: &Path, error: ParquetError) -> Error {
    match error {
        ParquetError::External(source) => match source.downcast::<io::Error>() {
            Ok(reason) => Error::io("write", path, *reason),
            Err(source) => Error::Internal(format!("{}: {source}", path.display())),
        },
        other => Error::Internal(format!("{}: {other}", path.display())),
    }
}
