//! Splitting of text with commas into records, which are lines unless a line break stands in quotes.

use std::io::{self, BufRead};

/// The mark with which some programs begin a text in UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Fields of records, one after the other.
#[derive(Default)]
pub(super) struct Fields {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Fields {
    /// The bytes of each field.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u8]> {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, end)| &self.bytes[start..*end])
    }
}

/// Where in a record the next byte stands.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// Before the first byte of a record
    Start,
    /// Before the first byte of a field
    Field,
    /// In a field without quotes, or behind its quotes
    Plain,
    /// In quotes
    Quoted,
    /// Behind a quote in quotes: it ends them, or a second one stands for a quote
    Quote,
}

/// A reader of one record after the other. Any bytes are records: lines end with a line feed, a carriage
/// return or both, empty ones are passed over, and what follows the quotes of a field belongs to it.
pub(super) struct Records<R> {
    source: R,
    begun: bool,
}

impl<R: BufRead> Records<R> {
    /// A reader from the first byte of a source.
    pub(super) fn new(source: R) -> Self {
        Self { source, begun: false }
    }

    /// Appends the fields of the next record, of which at most `most` are kept, and returns how many it has;
    /// `None` at the end.
    ///
    /// # Errors
    /// If the source cannot be read.
    pub(super) fn next(&mut self, fields: &mut Fields, most: usize) -> io::Result<Option<usize>> {
        self.begin()?;
        let mut record = Record { fields, most, count: 0, place: Place::Start };
        loop {
            let piece = self.source.fill_buf()?;
            let (read, whole) = match piece {
                [] if record.place == Place::Start => return Ok(None),
                // The end of the source ends a record, in quotes too.
                [] => {
                    record.end_field();
                    (0, true)
                }
                _ => record.take(piece),
            };
            self.source.consume(read);
            if whole {
                return Ok(Some(record.count));
            }
        }
    }

    /// Passes over the byte order mark.
    fn begin(&mut self) -> io::Result<()> {
        if !self.begun && self.source.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
            self.source.consume(BYTE_ORDER_MARK.len());
        }
        self.begun = true;
        Ok(())
    }
}

/// A record while it is read.
struct Record<'f> {
    fields: &'f mut Fields,
    /// Number of fields that are kept.
    most: usize,
    /// Number of fields that have ended.
    count: usize,
    place: Place,
}

impl Record<'_> {
    /// Takes bytes up to the end of the record; returns how many, and whether the record has ended.
    fn take(&mut self, piece: &[u8]) -> (usize, bool) {
        let mut at = 0;
        while let Some(byte) = piece.get(at) {
            at += 1;
            self.place = match (self.place, byte) {
                (Place::Start, b'\r' | b'\n') => Place::Start,
                (Place::Start | Place::Field, b'"') => Place::Quoted,
                (Place::Quoted, b'"') => Place::Quote,
                (Place::Quoted, _) | (Place::Quote, b'"') => {
                    self.fields.bytes.push(*byte);
                    Place::Quoted
                }
                (_, b'\r' | b'\n') => {
                    self.end_field();
                    return (at, true);
                }
                (_, b',') => {
                    self.end_field();
                    Place::Field
                }
                _ => {
                    let begin = at - 1;
                    at += piece[at..].iter().take_while(|byte| !b",\r\n".contains(byte)).count();
                    self.fields.bytes.extend_from_slice(&piece[begin..at]);
                    Place::Plain
                }
            };
        }
        (at, false)
    }

    fn end_field(&mut self) {
        self.count += 1;
        if self.count <= self.most {
            self.fields.ends.push(self.fields.bytes.len());
        }
    }
}
