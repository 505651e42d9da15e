//! Reading of files of recorded forces and base motions.
//!
//! `columns` reads lines of a time and a value, or `dt = …` and values; `at2` reads PEER's format of
//! accelerograms, which is recognised by the extension `.at2` or by the header; `head` finds the names and units
//! above columns; `selected` reads what a study says of a file, of which `table` knows the columns; `recognised` and `series`
//! know what is none of these. Every error names the file, and line and column unless something is missing.

mod at2;
mod columns;
mod head;
mod recognised;
mod selected;
mod series;
mod table;

use std::io::Read;
use std::ops::Range;
use std::path::Path;

use iva_store::regular_file;
use iva_sweep::forces::Selection;

use crate::error::Error;
use crate::source::{Source, shortened};

pub use recognised::{FileKind, kind_of_file};

/// Largest size of a file in bytes; a minute at 1 kHz takes about 1 MB.
const MOST_BYTES: u64 = 1 << 30;

/// A recorded history of at least two points: increasing times with one value each, all finite.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordFile {
    /// Strictly increasing times, in the file's unit; those of PEER AT2 are in seconds from 0.
    pub times: Vec<f64>,
    /// Values at the times, in [`RecordFile::unit`].
    pub values: Vec<f64>,
    /// Unit of the values.
    pub unit: RecordUnit,
}

/// The unit of the values of a record, as far as the file states it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordUnit {
    /// The file states no unit, or it was not looked for.
    Unstated,
    /// The file says that the values are in the unit of the study.
    OfStudy,
    /// The values are accelerations in m/s², converted from the unit that the file states.
    MetresPerSecondSquared,
    /// The values are forces in N, converted from the unit that the file states.
    Newtons,
}

/// Reads a file of a recorded history; values in columns are taken as they stand.
///
/// # Errors
/// [`Error::UnreadableRecord`] if it cannot be read, [`Error::LargeRecord`] if it is larger than 1 GiB, and
/// [`Error::Study`], with line and column where there are any, for invalid contents.
pub fn read_record(path: &Path) -> Result<RecordFile, Error> {
    parse_record(path, &bytes_of(path)?)
}

/// Why what is selected of a file of a record cannot be read.
#[derive(Debug)]
pub enum Unread {
    /// Something is wrong in the file.
    File(Error),
    /// Something is wrong with a key of the section of the force.
    Key {
        /// The key.
        key: &'static str,
        /// One sentence with the field, its value and what is allowed.
        message: String,
    },
}

impl From<Error> for Unread {
    fn from(error: Error) -> Self {
        Self::File(error)
    }
}

/// Reads what is selected of a file of a recorded history, and converts it from the units that its head or the
/// selection names.
///
/// # Errors
/// [`Unread::File`] as [`read_record`], and for a unit of something else; [`Unread::Key`] for a selection that the
/// file does not have.
pub fn read_record_in_si(path: &Path, selection: &Selection) -> Result<RecordFile, Unread> {
    parse_record_in_si(path, &bytes_of(path)?, selection)
}

/// The contents of a file of at most 1 GiB.
fn bytes_of(path: &Path) -> Result<Vec<u8>, Error> {
    let fault = |reason| Error::UnreadableRecord { path: path.to_owned(), reason };
    let file = regular_file::open(path).map_err(fault)?;
    let mut size = file.metadata().map_err(fault)?.len();
    let mut bytes = Vec::new();
    if size <= MOST_BYTES {
        // The file may grow while it is read.
        file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(fault)?;
        size = bytes.len() as u64;
    }
    if size > MOST_BYTES {
        return Err(Error::LargeRecord { path: path.to_owned() });
    }
    Ok(bytes)
}

/// Reads the bytes of a recorded history. The extension of `path` may tell the format; otherwise `path` is only
/// the name in messages.
///
/// # Errors
/// [`Error::Study`], with line and column where there are any, for invalid contents.
pub fn parse_record(path: &Path, bytes: &[u8]) -> Result<RecordFile, Error> {
    let text = text_of(path, bytes)?;
    readable(path, text).and_then(|()| parse(path, text)).map_err(|fault| fault.located(path, text))
}

/// Reads what is selected of the bytes of a recorded history, and converts it from the units that its head or the
/// selection names.
///
/// # Errors
/// As [`read_record_in_si`], for invalid contents.
pub fn parse_record_in_si(
    path: &Path,
    bytes: &[u8],
    selection: &Selection,
) -> Result<RecordFile, Unread> {
    let text = text_of(path, bytes)?;
    let read =
        readable(path, text).and_then(|()| match selected::is_needed(path, text, selection) {
            true => selected::read(path, text, selection),
            false => parse(path, text).and_then(|record| head::in_si(text, record)),
        });
    read.map_err(|fault| match fault.key {
        Some(key) => Unread::Key { key, message: fault.message },
        None => fault.located(path, text).into(),
    })
}

/// Refuses a text of another kind than these that are read.
fn readable(path: &Path, text: &str) -> Result<(), Fault> {
    if at2::is_at2(path, text) || columns::is_stepped(text) {
        return Ok(());
    }
    series::refuse(text)
}

/// The text that bytes hold, unless they are those of another kind of file.
fn text_of<'b>(path: &Path, bytes: &'b [u8]) -> Result<&'b str, Error> {
    recognised::refuse(bytes).map_err(|fault| fault.located(path, ""))?;
    if bytes.contains(&0) {
        let message = "a binary file or text in UTF-16; give a record as text in UTF-8";
        return Err(Source::new(path, "").missing(message));
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.strip_prefix('\u{feff}').unwrap_or(text)),
        Err(error) => {
            let end = error.valid_up_to();
            let valid = String::from_utf8_lossy(&bytes[..end]);
            let message = "not UTF-8 text; give a record as text in UTF-8";
            Err(Source::new(path, &valid).error(end..end, message))
        }
    }
}

fn parse(path: &Path, text: &str) -> Result<RecordFile, Fault> {
    if text.trim().is_empty() {
        return Err(Fault::missing("the file is empty; give times and values"));
    }
    long_enough(if at2::is_at2(path, text) { at2::read(text)? } else { columns::read(text)? })
}

/// A record, unless it has too few points.
fn long_enough(record: RecordFile) -> Result<RecordFile, Fault> {
    match record.values.len() {
        0 => Err(Fault::missing("no numbers in it; a record needs at least 2 points")),
        1 => Err(Fault::missing("1 point in it; a record needs at least 2")),
        _ => Ok(record),
    }
}

/// An error in a text, with the range of its bytes, or without a range if something is missing; or in a key of the
/// section that names the file.
struct Fault {
    place: Option<Range<usize>>,
    key: Option<&'static str>,
    message: String,
}

impl Fault {
    /// An error without a place.
    fn missing(message: impl Into<String>) -> Self {
        Self { place: None, key: None, message: message.into() }
    }

    /// An error in a key of the section that names the file.
    fn of_key(key: &'static str, message: String) -> Self {
        Self { place: None, key: Some(key), message }
    }

    /// The error with the place in the file.
    fn located(self, path: &Path, text: &str) -> Error {
        let source = Source::new(path, text);
        match self.place {
            Some(place) => source.error(place, self.message),
            None => source.missing(self.message),
        }
    }

    /// An error at the place of `part`, which is a slice of `text`.
    fn at(text: &str, part: &str, message: impl Into<String>) -> Self {
        let start = part.as_ptr().addr().saturating_sub(text.as_ptr().addr());
        Self { place: Some(start..start + part.len()), key: None, message: message.into() }
    }
}

/// The number that a word stands for, also with Fortran's exponent (`-.5D-3`).
fn number(word: &str) -> Option<f64> {
    word.parse().or_else(|_| word.replace(['D', 'd'], "E").parse()).ok()
}

/// Reads a finite number from `word`, which is a slice of `text`.
fn finite(text: &str, word: &str) -> Result<f64, Fault> {
    let what = match number(word) {
        Some(number) if number.is_finite() => return Ok(number),
        Some(_) => "is not finite",
        None => "is not a number",
    };
    let message = format!("\"{}\" {what}; give finite numbers such as -0.5e-3", shortened(word));
    Err(Fault::at(text, word, message))
}

/// The times k·`dt`, k = 0 … `count` − 1.
fn even_times(dt: f64, count: usize) -> Vec<f64> {
    (0..count).map(|step| step as f64 * dt).collect()
}

#[cfg(test)]
mod tests;
