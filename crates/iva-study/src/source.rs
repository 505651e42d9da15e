//! The text of a study file and the places of its fields, to point at what an error is about.

use std::ops::Range;
use std::path::{Path, PathBuf};

use iva_sweep::Invalid;
use iva_sweep::fields::{FieldId, Part};
use iva_sweep::slot::Slot;
use iva_sweep::sweep::SweepError;

use crate::error::{Error, Place, StudyError};

/// A study file as read, with the place of every key that was understood.
#[derive(Debug, Clone)]
pub struct Source {
    path: PathBuf,
    text: String,
    places: Vec<(String, Range<usize>)>,
}

impl Source {
    /// A file's text under the name that messages show.
    pub fn new(path: &Path, text: &str) -> Self {
        Self { path: path.to_owned(), text: text.to_owned(), places: Vec::new() }
    }

    /// The file, as named by the user.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Notes where a name (`absorber.clearance`, `sweep.gap`, a section) stands.
    pub(crate) fn note(&mut self, name: String, span: Range<usize>) {
        self.places.push((name, span));
    }

    fn find(&self, name: &str) -> Option<Range<usize>> {
        self.places.iter().find(|(known, _)| known == name).map(|(_, span)| span.clone())
    }

    /// What stands at a place, as written, shortened to one line of 40 characters.
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

    /// An error about a field and the value written for it.
    pub(crate) fn bad_value(&self, field: &str, span: Range<usize>, allowed: &str) -> Error {
        let value = self.literal(&span);
        self.error(span, format!("{field} = {value}: {allowed}"))
    }

    /// An error about something that does not stand in the file.
    pub(crate) fn missing(&self, message: impl Into<String>) -> Error {
        StudyError { path: self.path.clone(), place: None, message: message.into() }.into()
    }

    /// Points an error found elsewhere (when all fields come together) at the line it is about:
    /// the field itself, the axis that sweeps it, an alternative of it, or its section.
    pub fn locate(&self, invalid: &Invalid) -> Error {
        let message = invalid.to_string();
        match self.blame(&invalid.field) {
            Some(span) => self.error(span, message),
            None => self.missing(message),
        }
    }

    /// [`Source::locate`] for what a sweep can fail with.
    pub fn locate_sweep(&self, error: SweepError) -> Error {
        match error {
            SweepError::Invalid(invalid) => self.locate(&invalid),
            other => Error::Internal(other.to_string()),
        }
    }

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

    // An axis replaces the base value of its field, so it is the one to blame.
    fn swept(&self, path: &str) -> Option<Range<usize>> {
        self.find(&format!("axis {path}"))
    }

    /// Notes where the axis over a field stands.
    pub(crate) fn note_axis(&mut self, slot: Slot, span: Range<usize>) {
        self.note(format!("axis {}", slot.path()), span);
    }
}

/// Text of a study on one line of at most 40 characters, fit for a terminal.
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

/// Line, column and extent of a byte range.
fn place(text: &str, span: Range<usize>) -> Place {
    let mut start = span.start.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    let before = &text[..start];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = text[line_start..].lines().next().unwrap_or_default();
    let line_end = line_start + line.len();
    // What lies between the \r and the \n of a line's end is meant at its end.
    let start = start.min(line_end);
    let end = span.end.clamp(start, line_end);
    Place {
        line: before.matches('\n').count() + 1,
        column: text[line_start..start].chars().count() + 1,
        text: line.to_owned(),
        span: start - line_start..end - line_start,
    }
}
