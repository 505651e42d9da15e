//! What a file of Parquet or Arrow claims to hold, compared with its size before it is decoded: decoders
//! make room for what is claimed, and a process without memory ends.

pub(crate) mod arrow;
mod compact;
pub(crate) mod parquet;

use iva_sweep::sampling::MAX_POINTS;

/// Bytes that the cells of a file may take in memory: as many as the tables of a sweep.
const MOST_BYTES: u64 = 4_000_000_000;

/// Checks that so many rows can be read.
///
/// # Errors
/// A sentence with what they would take.
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
