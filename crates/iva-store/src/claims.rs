//! Checks of the sizes that a Parquet or Arrow file states against its length, before it is decoded: decoders
//! allocate the stated sizes, and a process that runs out of memory is ended.

pub(crate) mod arrow;
mod compact;
pub(crate) mod parquet;

use iva_sweep::sampling::MAX_POINTS;

/// Most bytes that the cells of a file may take in memory.
const MOST_BYTES: u64 = 4_000_000_000;

/// Checks that a table of this size fits the limits on rows and memory.
///
/// # Errors
/// A sentence with the size and the limit.
pub(crate) fn check_rows(rows: u64, columns: usize) -> Result<(), String> {
    if rows > MAX_POINTS {
        return Err(format!("it has {rows} rows; at most 2^32 are read"));
    }
    let bytes = rows.saturating_mul(8 * columns as u64);
    if bytes > MOST_BYTES {
        return Err(format!(
            "its {rows} rows of {columns} columns would take {:.1} GB in memory; at most {:.1} GB are \
             read",
            bytes as f64 / 1e9,
            MOST_BYTES as f64 / 1e9
        ));
    }
    Ok(())
}
