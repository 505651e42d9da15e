//! The file of one part of a table; the same rows always give the same bytes.

mod read;

use std::collections::BTreeMap;
use std::fmt;
use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;

use arrow_array::RecordBatch;
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, DataType, FieldRef, Schema, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::schema::types::ColumnPath;

use sha2::{Digest, Sha256};

use crate::csv;
use crate::directory::Directory;
use crate::error::Error;
use crate::regular_file;

pub(crate) use read::footer;
pub use read::{metadata, read_rows, read_table};

/// Rows of a row group of Parquet, a constant so that the bytes do not depend on the machine.
const ROW_GROUP_ROWS: usize = 1 << 16;

/// File format of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
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

    /// Name of the format, which is also the extension of its files.
    pub fn name(self) -> &'static str {
        match self {
            Format::Parquet => "parquet",
            Format::Arrow => "arrow",
            Format::Csv => "csv",
        }
    }

    /// The format of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Format and options of the files of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub struct Style {
    /// File format.
    pub format: Format,
    /// True if CSV files have a second line with the unit of each column.
    pub units_row: bool,
}

/// The schema of a part: that of its table, with the first point and the number of points of the part in the
/// metadata `iva.first_point` and `iva.part_points`.
pub fn part_schema(schema: &Schema, points: &Range<u64>) -> SchemaRef {
    let mut metadata = schema.metadata().clone();
    metadata.insert("iva.first_point".to_owned(), points.start.to_string());
    metadata.insert("iva.part_points".to_owned(), (points.end - points.start).to_string());
    Arc::new(Schema::new_with_metadata(schema.fields().clone(), metadata))
}

/// Size and checksum of a finished file.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Contents {
    /// Number of rows.
    pub rows: u64,
    /// Size of the file in bytes.
    pub bytes: u64,
    /// SHA-256 of the file in hexadecimal digits, as `sha256sum` prints it.
    pub sha256: String,
}

impl Contents {
    /// True if a file has this size and checksum. `go_on` is called between pieces of it.
    ///
    /// # Errors
    /// If it cannot be read; [`io::ErrorKind::Interrupted`] if `go_on` returned false.
    pub fn are_in(&self, mut file: File, go_on: &dyn Fn() -> bool) -> io::Result<bool> {
        if file.metadata()?.len() != self.bytes {
            return Ok(false);
        }
        let mut hash = Sha256::new();
        let mut piece = vec![0; 1 << 20];
        loop {
            match file.read(&mut piece)? {
                0 => return Ok(hexadecimal(hash) == self.sha256),
                _ if !go_on() => return Err(io::ErrorKind::Interrupted.into()),
                read => hash.update(&piece[..read]),
            }
        }
    }
}

/// Index of the first file in the list that is missing or differs from its size and checksum. Files are read on
/// as many threads as there are cores; `go_on` is called between pieces of them.
///
/// # Errors
/// The index of a file that exists and cannot be opened, or fails as in [`Contents::are_in`], with the reason.
pub fn first_damaged(
    files: &[(PathBuf, Contents)],
    go_on: &(dyn Fn() -> bool + Sync),
) -> Result<Option<usize>, (usize, io::Error)> {
    let next = AtomicUsize::new(0);
    let found: Mutex<BTreeMap<usize, Option<io::Error>>> = Mutex::default();
    let clean = || found.lock().is_ok_and(|found| found.is_empty());
    let check = || {
        // Files are taken in order, so all before the first fault are checked.
        while clean() {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some((path, contents)) = files.get(number) else { break };
            let whole = match regular_file::open(path) {
                Err(reason) if reason.kind() == io::ErrorKind::NotFound => Ok(false),
                other => other.and_then(|file| contents.are_in(file, go_on)),
            };
            let fault = match whole {
                Ok(true) => continue,
                Ok(false) => None,
                Err(reason) => Some(reason),
            };
            if let Ok(mut found) = found.lock() {
                found.insert(number, fault);
            }
        }
    };
    let threads = thread::available_parallelism().map_or(1, usize::from).min(files.len());
    thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(check);
        }
        check();
    });
    match found.into_inner().unwrap_or_default().pop_first() {
        Some((number, Some(reason))) => Err((number, reason)),
        other => Ok(other.map(|(number, _)| number)),
    }
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A file with the count and hash of the bytes written into it.
struct Hashing {
    file: File,
    hash: Sha256,
    bytes: u64,
}

impl Write for Hashing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.hash.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// The file of a part of a table while it is written.
pub struct TableFile {
    path: PathBuf,
    schema: SchemaRef,
    writer: Writer,
    rows: u64,
}

/// The encoder of each format.
enum Writer {
    Parquet(Box<ArrowWriter<Hashing>>),
    Arrow(Box<FileWriter<BufWriter<Hashing>>>),
    Csv(BufWriter<Hashing>),
}

impl TableFile {
    /// Creates the file in a folder; without rows it holds the schema only.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be created or written.
    pub(crate) fn create(
        folder: &Directory,
        name: &Path,
        schema: SchemaRef,
        style: Style,
    ) -> Result<Self, Error> {
        let path = &folder.path().join(name);
        let file = folder.create_file(name)?;
        let file = Hashing { file, hash: Sha256::new(), bytes: 0 };
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
                Writer::Csv(file)
            }
        };
        Ok(Self { path: path.to_owned(), schema, writer, rows: 0 })
    }

    /// Appends rows.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written.
    pub fn append(&mut self, rows: &RecordBatch) -> Result<(), Error> {
        let Self { path, schema, writer, rows: count } = self;
        *count += rows.num_rows() as u64;
        // The columns are the same; the schema of the part has more metadata.
        let rows = rows.clone().with_schema(schema.clone()).map_err(|e| arrow_fault(path, e))?;
        match writer {
            Writer::Parquet(writer) => writer.write(&rows).map_err(|e| parquet_fault(path, e)),
            Writer::Arrow(writer) => writer.write(&rows).map_err(|e| arrow_fault(path, e)),
            Writer::Csv(file) => {
                csv::write_rows(file, &rows).map_err(|reason| Error::io("write", path, reason))
            }
        }
    }

    /// Completes, syncs and closes the file; returns its size and checksum.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub fn finish(self) -> Result<Contents, Error> {
        let Self { path, writer, rows, .. } = self;
        let failed = |reason| Error::io("write", &path, reason);
        let unbuffered = |file: BufWriter<Hashing>| {
            file.into_inner().map_err(|error| failed(error.into_error()))
        };
        let file = match writer {
            Writer::Parquet(writer) => {
                writer.into_inner().map_err(|error| parquet_fault(&path, error))?
            }
            Writer::Arrow(writer) => {
                unbuffered(writer.into_inner().map_err(|error| arrow_fault(&path, error))?)?
            }
            Writer::Csv(file) => unbuffered(file)?,
        };
        file.file.sync_all().map_err(failed)?;
        Ok(Contents { rows, bytes: file.bytes, sha256: hexadecimal(file.hash) })
    }
}

/// Size in bytes of rows as a Parquet file, for estimates.
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
    let mut properties = WriterProperties::builder()
        .set_created_by(concat!("iva-dynamics ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_compression(Compression::SNAPPY)
        .set_max_row_group_row_count(Some(ROW_GROUP_ROWS))
        .set_key_value_metadata(Some(key_values(&schema)));
    let swept = schema.metadata().get("iva.swept").map_or("", String::as_str);
    for field in schema.fields().iter().filter(|field| *field.data_type() == DataType::Float64) {
        // A dictionary saves space for the few values of an axis, not for results that all differ.
        if !swept.split(',').any(|key| key == field.name()) {
            let column = ColumnPath::new(vec![field.name().clone()]);
            properties = properties.set_column_dictionary_enabled(column, false);
        }
    }
    ArrowWriter::try_new(sink, schema, Some(properties.build()))
}

/// The metadata of the schema as sorted Parquet keys, for readers that do not know Arrow.
fn key_values(schema: &Schema) -> Vec<KeyValue> {
    let mut pairs: Vec<(String, String)> =
        schema.metadata().iter().map(|(key, value)| (key.clone(), value.clone())).collect();
    pairs.sort();
    pairs.into_iter().map(|(key, value)| KeyValue::new(key, value)).collect()
}

/// The header of a CSV file: a line of names and, with `units_row`, one of units. No name or unit has a comma.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_damaged_file_is_found() {
        let folder = tempfile::tempdir().unwrap();
        // SHA-256 of "abc", from FIPS 180-2, appendix B.1.
        let sha256 = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad".to_owned();
        let contents = Contents { rows: 0, bytes: 3, sha256 };
        let files: Vec<_> =
            (0..20).map(|n| (folder.path().join(n.to_string()), contents.clone())).collect();
        for (path, _) in &files {
            std::fs::write(path, "abc").unwrap();
        }
        assert_eq!(first_damaged(&files, &|| true).unwrap(), None);
        std::fs::write(&files[17].0, "abd").unwrap();
        std::fs::remove_file(&files[5].0).unwrap();
        assert_eq!(first_damaged(&files, &|| true).unwrap(), Some(5));
        std::fs::create_dir(&files[5].0).unwrap();
        assert_eq!(first_damaged(&files, &|| true).unwrap_err().0, 5);
        assert_eq!(first_damaged(&files, &|| false).unwrap_err().0, 0);
    }
}
