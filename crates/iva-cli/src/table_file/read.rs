//! What is read back of table files.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use arrow_array::RecordBatch;
use arrow_csv::ReaderBuilder;
use arrow_ipc::reader::{FileReader, read_footer_length};
use arrow_ipc::root_as_footer;
use arrow_schema::{ArrowError, SchemaRef};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

use super::{Format, Style};
use crate::error::Error;

/// Rows handed out at once.
const BATCH_ROWS: usize = 8192;

/// Hands out the rows of a file that [`super::TableFile`] wrote, in portions.
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
    let open = || File::open(path).map_err(|reason| Error::io("read", path, reason));
    let batches: Box<dyn Iterator<Item = Result<RecordBatch, ArrowError>>> = match style.format {
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
            let builder = ReaderBuilder::new(schema).with_header(false);
            Box::new(builder.with_batch_size(BATCH_ROWS).build(file).map_err(failed)?)
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
