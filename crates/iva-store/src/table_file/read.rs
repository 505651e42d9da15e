//! Reading of the files of tables.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_ipc::reader::{FileReader, read_footer_length};
use arrow_ipc::root_as_footer;
use arrow_schema::{ArrowError, SchemaRef};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::file::metadata::ParquetMetaDataReader;

use super::{Format, Style};
use crate::caught::{DAMAGED, caught};
use crate::claims;
use crate::csv;
use crate::error::Error;
use crate::regular_file;

/// Number of rows of a batch.
const BATCH_ROWS: usize = 8192;

type Batches = Box<dyn Iterator<Item = Result<RecordBatch, ArrowError>>>;

/// Reads a file that [`super::TableFile`] wrote and passes its rows to `take`, in batches.
///
/// # Errors
/// [`Error::Io`] if it cannot be read.
pub fn read_rows(
    path: &Path,
    schema: SchemaRef,
    style: Style,
    take: &mut dyn FnMut(&RecordBatch),
) -> Result<(), Error> {
    let failed = |reason: ArrowError| Error::io("read", path, io::Error::other(reason));
    let open = || regular_file::open(path).map_err(|reason| Error::io("read", path, reason));
    let batches: Batches = match style.format {
        Format::Parquet => Box::new(
            ParquetRecordBatchReaderBuilder::try_new(open()?)
                .and_then(|builder| builder.with_batch_size(BATCH_ROWS).build())
                .map_err(|reason| Error::io("read", path, io::Error::other(reason)))?,
        ),
        Format::Arrow => Box::new(FileReader::try_new_buffered(open()?, None).map_err(failed)?),
        Format::Csv => {
            let mut file = BufReader::new(open()?);
            let heads = if style.units_row { 2 } else { 1 };
            for _ in 0..heads {
                skip_line(&mut file).map_err(|reason| Error::io("read", path, reason))?;
            }
            Box::new(csv::Reader::new(file, schema, BATCH_ROWS))
        }
    };
    for batch in batches {
        take(&batch.map_err(failed)?);
    }
    Ok(())
}

fn skip_line(file: &mut impl io::BufRead) -> io::Result<()> {
    file.skip_until(b'\n').map(drop)
}

/// The metadata of a Parquet or Arrow file; the extension tells the format.
///
/// # Errors
/// [`Error::Io`] if it cannot be read or is of another kind.
pub fn metadata(path: &Path) -> Result<BTreeMap<String, String>, Error> {
    let read = || if is_parquet(path) { parquet_metadata(path) } else { arrow_metadata(path) };
    caught(read).unwrap_or_else(|| Err(damaged(path)))
}

fn is_parquet(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == Format::Parquet.name())
}

fn damaged(path: &Path) -> Error {
    Error::io("read", path, io::Error::other(DAMAGED))
}

fn parquet_metadata(path: &Path) -> Result<BTreeMap<String, String>, Error> {
    let file = regular_file::open(path).map_err(|reason| Error::io("read", path, reason))?;
    let found = ParquetMetaDataReader::new().parse_and_finish(&file);
    let found = found.map_err(|reason| Error::io("read", path, io::Error::other(reason)))?;
    let pairs = found.file_metadata().key_value_metadata().into_iter().flatten();
    Ok(pairs.map(|pair| (pair.key.clone(), pair.value.clone().unwrap_or_default())).collect())
}

fn arrow_metadata(path: &Path) -> Result<BTreeMap<String, String>, Error> {
    let read = || {
        let bytes = footer(&mut regular_file::open(path)?)?;
        // The reader of the library would also build the schema, and panic over a damaged one.
        let footer = root_as_footer(&bytes).map_err(|_| io::ErrorKind::InvalidData)?;
        let pairs = footer.schema().and_then(|schema| schema.custom_metadata());
        let text = |value: Option<&str>| value.unwrap_or_default().to_owned();
        let pairs = pairs.into_iter().flatten();
        Ok(pairs.map(|pair| (text(pair.key()), text(pair.value()))).collect())
    };
    read().map_err(|reason: io::Error| {
        use io::ErrorKind::{InvalidData, UnexpectedEof};
        let broken = matches!(reason.kind(), InvalidData | UnexpectedEof);
        let said = "it is not an Arrow file, or not all of it";
        Error::io("read", path, if broken { io::Error::other(said) } else { reason })
    })
}

/// Schema and rows of a Parquet or Arrow file that may be damaged: the sizes that it states are checked first,
/// and a panic of the decoder is returned as an error.
///
/// # Errors
/// [`Error::Io`] if it cannot be read, is damaged, or has more than 2³² rows or 4 GB in memory.
pub fn read_table(path: &Path) -> Result<(SchemaRef, Vec<RecordBatch>), Error> {
    let read = || {
        let said = |reason: ArrowError| reason.to_string();
        let mut file = regular_file::open(path).map_err(|reason| reason.to_string())?;
        let (schema, batches): (_, Batches) = if is_parquet(path) {
            let copy = file.try_clone().map_err(|reason| reason.to_string())?;
            let builder = ParquetRecordBatchReaderBuilder::try_new(copy)
                .map_err(|reason| reason.to_string())?;
            let schema = builder.schema().clone();
            claims::parquet::check(&mut file, builder.metadata(), schema.fields().len())?;
            let reader = builder.with_batch_size(BATCH_ROWS).build();
            (schema, Box::new(reader.map_err(|reason| reason.to_string())?))
        } else {
            let schema = claims::arrow::schema(&mut file)?;
            claims::arrow::check(&mut file, schema.fields().len())?;
            file.rewind().map_err(|reason| reason.to_string())?;
            let reader = FileReader::try_new_buffered(file, None).map_err(said)?;
            (Arc::new(schema), Box::new(reader))
        };
        let batches: Vec<RecordBatch> = batches.collect::<Result<_, _>>().map_err(said)?;
        Ok((schema, batches))
    };
    caught(read).unwrap_or_else(|| Err(DAMAGED.to_owned())).map_err(|said: String| {
        let line = said.lines().next().unwrap_or_default().to_owned();
        Error::io("read", path, io::Error::other(line))
    })
}

/// The footer of an Arrow file, which describes its schema and batches.
pub(crate) fn footer(file: &mut File) -> io::Result<Vec<u8>> {
    // The file ends with the length of the footer in four bytes and the six letters of the format.
    const END: usize = 10;
    let mut end = [0; END];
    let whole = file.seek(SeekFrom::End(0))?;
    if whole < END as u64 {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    file.seek(SeekFrom::End(-(END as i64)))?;
    file.read_exact(&mut end)?;
    let length = read_footer_length(end).map_err(|_| io::ErrorKind::InvalidData)?;
    if (END + length) as u64 > whole {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    file.seek(SeekFrom::End(-((END + length) as i64)))?;
    let mut footer = vec![0; length];
    file.read_exact(&mut footer)?;
    Ok(footer)
}
