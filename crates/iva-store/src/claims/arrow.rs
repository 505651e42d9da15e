//! Check of the sizes that an Arrow file states, before it is decoded.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use arrow_ipc::convert::fb_to_schema;
use arrow_ipc::{Block, Footer, root_as_footer, root_as_message};
use arrow_schema::Schema;

use super::check_rows;
use crate::table_file::footer;

/// Message for a file that is damaged, cut short or of another format.
const DAMAGED: &str = "it is not an Arrow file, or not all of it";
/// Message for a file with compressed buffers, which are not read.
const COMPRESSED: &str = "it is compressed; write it without compression, or as Parquet";
/// Continuation marker in front of the length of a message, which files of older versions lack.
const CONTINUATION: [u8; 4] = [0xff; 4];

/// The schema of an Arrow file.
///
/// # Errors
/// A sentence for a file that is not an Arrow file or cannot be read.
pub(crate) fn schema(file: &mut File) -> Result<Schema, String> {
    let bytes = footer(file).map_err(said)?;
    let footer = root_as_footer(&bytes).map_err(|_| DAMAGED)?;
    Ok(fb_to_schema(footer.schema().ok_or(DAMAGED)?))
}

/// Checks that all batches and buffers of an Arrow file lie within it; returns the number of rows.
///
/// # Errors
/// A sentence that says what is wrong with it.
pub(crate) fn check(file: &mut File, columns: usize) -> Result<u64, String> {
    let size = file.metadata().map_err(said)?.len();
    let bytes = footer(file).map_err(said)?;
    let footer = root_as_footer(&bytes).map_err(|_| DAMAGED)?;
    let mut rows = 0u64;
    for block in blocks(&footer)? {
        rows = rows.saturating_add(rows_of(file, block, size)?);
        check_rows(rows, columns)?;
    }
    Ok(rows)
}

/// The blocks of the record batches; files with dictionaries are refused.
fn blocks<'a>(footer: &Footer<'a>) -> Result<impl Iterator<Item = &'a Block>, String> {
    if footer.dictionaries().is_some_and(|blocks| !blocks.is_empty()) {
        return Err("it has columns of words out of a list; write them as plain columns".to_owned());
    }
    Ok(footer.recordBatches().into_iter().flatten())
}

/// The number of rows of a batch, after a check that the batch lies within the file and its buffers within
/// the batch.
fn rows_of(file: &mut File, block: &Block, size: u64) -> Result<u64, String> {
    let number = |value: i64| u64::try_from(value).map_err(|_| DAMAGED);
    let start = number(block.offset())?;
    let head = number(block.metaDataLength().into())?;
    let body = number(block.bodyLength())?;
    let end = start.checked_add(head).and_then(|end| end.checked_add(body));
    if end.is_none_or(|end| end > size) {
        return Err(format!("it claims {body} bytes of numbers, but it has {size} bytes in all"));
    }
    let mut bytes = vec![0; head as usize];
    file.seek(SeekFrom::Start(start)).and_then(|_| file.read_exact(&mut bytes)).map_err(said)?;
    let skipped = if bytes.starts_with(&CONTINUATION) { 8 } else { 4 };
    let message = root_as_message(bytes.get(skipped..).ok_or(DAMAGED)?).map_err(|_| DAMAGED)?;
    let batch = message.header_as_record_batch().ok_or(DAMAGED)?;
    if batch.compression().is_some() {
        return Err(COMPRESSED.to_owned());
    }
    let rows = number(batch.length())?;
    for node in batch.nodes().into_iter().flatten() {
        if node.length() != batch.length() {
            return Err(DAMAGED.to_owned());
        }
    }
    for buffer in batch.buffers().into_iter().flatten() {
        let end = number(buffer.offset())?.checked_add(number(buffer.length())?);
        if end.is_none_or(|end| end > body) {
            return Err(DAMAGED.to_owned());
        }
    }
    // A row takes at least one bit.
    if rows / 8 > body {
        return Err(format!("it claims {rows} rows, but it has {size} bytes in all"));
    }
    Ok(rows)
}

/// The message for an I/O error.
fn said(reason: io::Error) -> String {
    use io::ErrorKind::{InvalidData, UnexpectedEof};
    match reason.kind() {
        InvalidData | UnexpectedEof => DAMAGED.to_owned(),
        _ => format!("it cannot be read: {reason}"),
    }
}
