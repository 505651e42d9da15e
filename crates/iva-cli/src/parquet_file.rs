//! One Parquet file: the same rows always give the same bytes.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use arrow_array::RecordBatch;
use arrow_schema::{Schema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;

use crate::error::Error;
use crate::output::PART_POINTS;

/// Rows of a row group: a constant, so that the bytes do not depend on the machine.
const ROW_GROUP_ROWS: usize = 1 << 20;

/// A Parquet file being written.
pub struct ParquetFile {
    path: PathBuf,
    writer: ArrowWriter<File>,
}

impl ParquetFile {
    /// Creates the file of a part; without any rows it holds its schema only.
    ///
    /// Parquet keys besides those of the schema: `iva.first_point` and `iva.part_points`, the
    /// points that the part covers.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be created or written.
    pub fn create(path: &Path, schema: SchemaRef) -> Result<Self, Error> {
        let file = File::create_new(path).map_err(|reason| Error::io("create", path, reason))?;
        let mut writer = writer(file, schema.clone()).map_err(|error| fault(path, error))?;
        for pair in covered(path, &schema).into_iter().flatten() {
            writer.append_key_value_metadata(pair);
        }
        Ok(Self { path: path.to_owned(), writer })
    }

    /// Appends rows.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written.
    pub fn append(&mut self, rows: &RecordBatch) -> Result<(), Error> {
        self.writer.write(rows).map_err(|error| fault(&self.path, error))
    }

    /// Completes the file and sees it onto the disk; returns its size in bytes.
    ///
    /// # Errors
    /// [`Error::Io`] if that fails.
    pub fn finish(self) -> Result<u64, Error> {
        let Self { path, writer } = self;
        let file = writer.into_inner().map_err(|error| fault(&path, error))?;
        file.sync_all()
            .and_then(|()| file.metadata())
            .map(|metadata| metadata.len())
            .map_err(|reason| Error::io("write", &path, reason))
    }
}

/// Bytes that rows take as a Parquet file; used for estimates.
///
/// # Errors
/// [`Error::Internal`] if they cannot be encoded.
pub fn encoded_size(schema: SchemaRef, batches: &[RecordBatch]) -> Result<u64, Error> {
    let memory = Path::new("memory");
    let mut writer = writer(Vec::new(), schema).map_err(|error| fault(memory, error))?;
    for batch in batches {
        writer.write(batch).map_err(|error| fault(memory, error))?;
    }
    let bytes = writer.into_inner().map_err(|error| fault(memory, error))?;
    Ok(bytes.len() as u64)
}

fn writer<W: Write + Send>(sink: W, schema: SchemaRef) -> Result<ArrowWriter<W>, ParquetError> {
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

/// Which points a part covers, from the number in its name: a renamed part is found out.
fn covered(path: &Path, schema: &Schema) -> Option<[KeyValue; 2]> {
    let part: u64 = path.file_stem()?.to_str()?.strip_prefix("part-")?.parse().ok()?;
    let points: u64 = schema.metadata().get("iva.points")?.parse().ok()?;
    let first = part * PART_POINTS;
    let count = points.saturating_sub(first).min(PART_POINTS);
    Some([
        KeyValue::new("iva.first_point".to_owned(), first.to_string()),
        KeyValue::new("iva.part_points".to_owned(), count.to_string()),
    ])
}

fn fault(path: &Path, error: ParquetError) -> Error {
    match error {
        ParquetError::External(source) => match source.downcast::<std::io::Error>() {
            Ok(reason) => Error::io("write", path, *reason),
            Err(source) => Error::Internal(format!("{}: {source}", path.display())),
        },
        other => Error::Internal(format!("{}: {other}", path.display())),
    }
}
