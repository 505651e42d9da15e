//! Tables as text with commas, after RFC 4180: a row a line, a cell in quotes only where it must be, an empty
//! cell for a value that is missing. Columns have the types of the program's tables.

mod read;
mod records;
#[cfg(test)]
mod tests;
mod write;

pub(crate) use read::Reader;
pub(crate) use write::write_rows;
