//! Check of the sizes that a Parquet file and its pages state, before it is decoded.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

use parquet::basic::Type;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};

use super::check_rows;
use super::compact::Compact;
use crate::caught::DAMAGED;

/// Most bytes of a page header; that of a page of numbers takes about a hundred.
const MOST_HEAD: u64 = 1 << 16;
/// Bytes that a page may have beyond those of its values.
const BESIDE: i64 = 1 << 16;

/// Checks that all columns and pages of a Parquet file lie within it; returns the number of rows.
///
/// # Errors
/// A sentence that says what is wrong with it.
pub(crate) fn check(
    file: &mut File,
    metadata: &ParquetMetaData,
    columns: usize,
) -> Result<u64, String> {
    let size = file.metadata().map_err(|reason| format!("it cannot be read: {reason}"))?.len();
    let mut rows = 0u64;
    for group in metadata.row_groups() {
        let more = u64::try_from(group.num_rows()).map_err(|_| DAMAGED)?;
        rows = rows.saturating_add(more);
        check_rows(rows, columns)?;
        for column in group.columns() {
            check_column(file, column, group.num_rows(), size)?;
        }
    }
    if i64::try_from(rows) != Ok(metadata.file_metadata().num_rows()) {
        return Err(DAMAGED.to_owned());
    }
    Ok(rows)
}

/// Checks the pages of a column of a row group.
fn check_column(
    file: &mut File,
    column: &ColumnChunkMetaData,
    rows: i64,
    size: u64,
) -> Result<(), String> {
    let first = column.dictionary_page_offset().unwrap_or(column.data_page_offset());
    let number = |value: i64| u64::try_from(value).map_err(|_| DAMAGED);
    let (mut at, claimed) = (number(first)?, number(column.compressed_size())?);
    let end = at.checked_add(claimed).filter(|end| *end <= size);
    let end = end.ok_or_else(|| {
        format!("it claims {claimed} bytes of a column, but it has {size} bytes in all")
    })?;
    // A number takes eight bytes and at most as many for its levels; a text at most 256 bytes.
    let each = if column.column_type() == Type::BYTE_ARRAY { 256 } else { 16 };
    while at < end {
        let page = page(file, at, end).ok_or(DAMAGED)?;
        let most = page.values.saturating_mul(each).saturating_add(BESIDE);
        let fits = (0..=rows).contains(&page.values) && (0..=most).contains(&page.uncompressed);
        let next =
            u64::try_from(page.compressed).ok().and_then(|length| page.body.checked_add(length));
        match next {
            Some(next) if fits && next <= end => at = next,
            _ => return Err(DAMAGED.to_owned()),
        }
    }
    Ok(())
}

/// The sizes in the header of a page.
struct Page {
    /// Offset of the first byte after the header.
    body: u64,
    uncompressed: i64,
    compressed: i64,
    values: i64,
}

/// Reads the header of the page at the offset `at`, in a column that ends at `end`.
fn page(file: &mut File, at: u64, end: u64) -> Option<Page> {
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(at)).ok()?;
    Read::by_ref(file).take((end - at).min(MOST_HEAD)).read_to_end(&mut bytes).ok()?;
    let mut head = Compact::new(&bytes);
    let mut page = Page { body: 0, uncompressed: -1, compressed: -1, values: 0 };
    // Fields of PageHeader in parquet.thrift: 5 is a data page, 7 a dictionary page and 8 a data page of
    // version 2; field 1 of each is the number of values.
    head.structure(&mut |path, value| match path {
        [2] => page.uncompressed = value,
        [3] => page.compressed = value,
        [5 | 7 | 8, 1] => page.values = page.values.max(value),
        _ => {}
    })?;
    page.body = at + head.read() as u64;
    Some(page)
}
