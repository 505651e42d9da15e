//! The text of a study file and the places of its keys, for errors with line and column.

use std::ops::Range;
use std::path::{Path, PathBuf};

use iva_store::folder::HEADER;
use iva_sweep::Invalid;
use iva_sweep::fields::{FieldId, Part};
use iva_sweep::slot::Slot;
use iva_sweep::sweep::SweepError;

use crate::error::{Error, Place, StudyError};

/// The text of a study file, with the places of the keys read so far.
#[derive(Debug, Clone)]
pub struct Source {
    path: PathBuf,
    text: String,
    places: Vec<(String, Range<usize>)>,
}

impl Source {
    /// The text of a file, with the name for messages.
    pub fn new(path: &Path, text: &str) -> Self {
        Self { path: path.to_owned(), text: text.to_owned(), places: Vec::new() }
    }

    /// True if the package has written the file beside its results.
    pub(crate) fn is_resolved(&self) -> bool {
        self.text.starts_with(HEADER)
    }

    /// Path of the file, as named by the user.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Records the place of a key (`absorber.clearance`, `sweep.gap`) or section.
    pub(crate) fn note(&mut self, name: String, span: Range<usize>) {
        self.places.push((name, span));
    }

    /// The recorded place of a name.
    fn find(&self, name: &str) -> Option<Range<usize>> {
        self.places.iter().find(|(known, _)| known == name).map(|(_, span)| span.clone())
    }

    /// The text at a place, shortened to one line of at most 40 characters.
    pub(crate) fn literal(&self, span: &Range<usize>) -> String {
        let whole = self.text.get(span.clone()).unwrap_or_default();
        shortened(whole)
    }

    /// An error at a place of the file.
    pub(crate) fn error(&self, span: Range<usize>, message: impl Into<String>) -> Error {
        StudyError {
            path: self.path.clone(),
            place: Some(place(&self.text, span)),
            message: message.into(),
        }
        .into()
    }

    /// An error at the place of a value, with the field, the value and the `allowed` values.
    pub(crate) fn bad_value(&self, field: &str, span: Range<usize>, allowed: &str) -> Error {
        let value = self.literal(&span);
        self.error(span, format!("{field} = {value}: {allowed}"))
    }

    /// An error without a place, for something missing in the file.
    pub(crate) fn missing(&self, message: impl Into<String>) -> Error {
        StudyError { path: self.path.clone(), place: None, message: message.into() }.into()
    }

    /// The error of an invalid value that was found after reading, at the place of the axis that sweeps its field,
    /// of the field, of another field for the same quantity, or of its section.
    pub fn locate(&self, invalid: &Invalid) -> Error {
        let message = invalid.to_string();
        match self.blame(&invalid.field) {
            Some(span) => self.error(span, message),
            None => self.missing(message),
        }
    }

    /// The error of a sweep, with a place for an invalid value as in [`Source::locate`].
    pub fn locate_sweep(&self, error: SweepError) -> Error {
        match error {
            SweepError::Invalid(invalid) => self.locate(&invalid),
            other => Error::Internal(other.to_string()),
        }
    }

    /// The place that caused an invalid value of a field.
    fn blame(&self, field: &str) -> Option<Range<usize>> {
        let name = field.split('[').next().unwrap_or(field);
        let exact = self.swept(name).or_else(|| self.find(name));
        let alternative = || {
            let (part, bare) = name.split_once('.')?;
            let part = Part::ALL.into_iter().find(|known| known.name() == part)?;
            let blamed = FieldId::find(part, bare)?;
            FieldId::all()
                .filter(|id| id.same_quantity(blamed))
                .find_map(|id| self.swept(&id.path()).or_else(|| self.find(&id.path())))
        };
        let enclosing = || {
            let (outer, _) = name.rsplit_once('.')?;
            self.find(outer)
        };
        exact.or_else(alternative).or_else(enclosing)
    }

    /// The place of the axis over a field, which replaces the base value of the field.
    fn swept(&self, path: &str) -> Option<Range<usize>> {
        self.find(&format!("axis {path}"))
    }

    /// Records the place of the axis over a field.
    pub(crate) fn note_axis(&mut self, slot: Slot, span: Range<usize>) {
        self.note(format!("axis {}", slot.path()), span);
    }
}

/// The first line of a text, cut to 40 characters and with control characters replaced.
pub(crate) fn shortened(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    let visible = |c: char| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c };
    let short: String = line.chars().take(40).map(visible).collect();
    if line.chars().nth(40).is_some() || line.len() < text.len() {
        format!("{short}…")
    } else {
        short
    }
}

/// Line, column and extent of the range `span` of bytes, as far as it lies in its first line.
fn place(text: &str, span: Range<usize>) -> Place {
    let mut start = span.start.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    let before = &text[..start];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = text[line_start..].lines().next().unwrap_or_default();
    let line_end = line_start + line.len();
    // A position between \r and \n counts as the end of the line.
    let start = start.min(line_end);
    let end = span.end.clamp(start, line_end);
    Place {
        line: before.matches('\n').count() + 1,
        column: text[line_start..start].chars().count() + 1,
        text: line.to_owned(),
        span: start - line_start..end - line_start,
    }
}
