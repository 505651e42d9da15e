//! What can go wrong between a study file and its tables, and the exit code of each.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use iva_sweep::Invalid;
use iva_sweep::sweep::SweepError;

use crate::layout::WIDTH;
use crate::remedy::{COMMAND, Remedy, Words};
use crate::visible::visible;

/// Everything the command can fail with. `Display` is the message a user reads.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Something in a study file, with its place.
    #[error("{0}")]
    Study(Box<StudyError>),
    /// A value from elsewhere (the command line, a study built in a program).
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// A request that cannot be served as asked: one sentence with what to do instead.
    #[error("{0}")]
    Refused(String),
    /// A folder that cannot take a result as asked.
    #[error("{fault}; {}", .remedy.sentence(&COMMAND))]
    Folder {
        /// What is wrong with it.
        fault: String,
        /// What can be done.
        remedy: Remedy,
    },
    /// Reading or writing failed.
    #[error("cannot {action} {}: {source}", .path.display())]
    Io {
        /// What was attempted, for example `write`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Finished tables could not be moved into place.
    #[error("{reason}; {what} are kept in {}", .kept.display())]
    NotMoved {
        /// Why not.
        reason: Box<Error>,
        /// Which tables.
        what: &'static str,
        /// Where they are.
        kept: PathBuf,
    },
    /// A fault midway, with what became of the finished parts.
    #[error("{reason}; {kept}")]
    Incomplete {
        /// What went wrong.
        reason: Box<Error>,
        /// What is kept of the results.
        kept: Kept,
    },
    /// Ctrl-C, with what became of the results.
    #[error("interrupted: {0}")]
    Interrupted(Kept),
    /// A fault of this program or of the machine: a table that cannot be built, threads that do
    /// not start.
    #[error("internal fault: {0}")]
    Internal(String),
}

/// What is kept of a sweep that ended early.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kept {
    /// The folder of the sweep.
    pub dir: PathBuf,
    /// Points of complete parts.
    pub done: u64,
    /// Points of the sweep.
    pub points: u64,
    /// It was to replace earlier tables.
    pub replaced: bool,
}

impl Kept {
    /// Nothing: no part was complete.
    pub fn nothing() -> Self {
        Self { dir: PathBuf::new(), done: 0, points: 0, replaced: false }
    }

    /// One sentence, which says how to ask for the rest.
    pub fn sentence(&self, words: &Words) -> String {
        let Self { done, points, .. } = self;
        let resume = match self.replaced {
            true => format!("go on with {}", words.overwrite_and_resume),
            false => format!("go on with {}", words.resume),
        };
        let dir = self.dir.display();
        match (*done, self.replaced) {
            (0, _) => "nothing was finished, so nothing was written".to_owned(),
            (_, false) => format!("{done} of {points} points are written to {dir}; {resume}"),
            (_, true) => format!(
                "the earlier tables in {dir} are as they were, {done} of {points} points of the new \
                 ones are kept beside them; {resume}"
            ),
        }
    }
}

impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence(&COMMAND))
    }
}

impl Error {
    pub(crate) fn folder(fault: String, remedy: Remedy) -> Self {
        Self::Folder { fault, remedy }
    }

    /// The message in the words of a front.
    pub fn message(&self, words: &Words) -> String {
        match self {
            Error::Study(error) => error.message.clone(),
            Error::Folder { fault, remedy } => format!("{fault}; {}", remedy.sentence(words)),
            Error::NotMoved { reason, what, kept } => {
                format!("{}; {what} are kept in {}", reason.message(words), kept.display())
            }
            Error::Incomplete { reason, kept } => {
                format!("{}; {}", reason.message(words), kept.sentence(words))
            }
            Error::Interrupted(kept) => format!("interrupted: {}", kept.sentence(words)),
            other => other.to_string(),
        }
    }

    /// 2 for bad input, 1 for an I/O or internal fault, 130 for an interrupt.
    pub fn exit_code(&self) -> i32 {
        match self {
            Error::Study(_) | Error::Invalid(_) | Error::Refused(_) | Error::Folder { .. } => 2,
            Error::NotMoved { reason, .. } | Error::Incomplete { reason, .. } => reason.exit_code(),
            Error::Io { .. } | Error::Internal(_) => 1,
            Error::Interrupted(_) => 130,
        }
    }

    /// What a terminal shows, with colours; of an error in a study file also the line.
    pub fn report(&self) -> String {
        match self {
            Error::Study(error) => error.picture(),
            other => format!("error: {}", visible(&other.to_string())),
        }
    }

    /// An I/O error of an action on a path.
    pub(crate) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Error::Io { action, path: path.to_owned(), source }
    }
}

/// A fault in a study file: where it is, what is wrong and what is allowed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StudyError {
    /// The file, as named by the user.
    pub path: PathBuf,
    /// Where in the file; `None` if nothing in it is to blame (something is missing).
    pub place: Option<Place>,
    /// One sentence with field, value and what is allowed.
    pub message: String,
}

/// A stretch of one line of a study file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Line number from 1.
    pub line: usize,
    /// Column from 1, in characters.
    pub column: usize,
    /// The line, without its end.
    pub text: String,
    /// The bytes of `text` that are meant.
    pub span: Range<usize>,
}

impl StudyError {
    /// The message with the line it is about, the place underlined; with terminal colours.
    fn picture(&self) -> String {
        let path = visible(&self.path.display().to_string());
        let message = visible(&self.message);
        let Some(place) = &self.place else {
            let title = format!("{path}: {message}");
            return picture(&[Group::with_title(Level::ERROR.primary_title(title))]);
        };
        let snippet = Snippet::source(&place.text)
            .line_start(place.line)
            .path(path)
            .annotation(AnnotationKind::Primary.span(place.span.clone()));
        picture(&[Level::ERROR.primary_title(message.as_str()).element(snippet)])
    }
}

fn picture(report: &[Group<'_>]) -> String {
    Renderer::styled().term_width(WIDTH).render(report).to_string()
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.path.display())?;
        if let Some(place) = &self.place {
            write!(f, "{}:{}:", place.line, place.column)?;
        }
        write!(f, " {}", self.message)
    }
}

impl From<SweepError> for Error {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Invalid(invalid) => Error::Invalid(invalid),
            fault => Error::Internal(fault.to_string()),
        }
    }
}

impl From<StudyError> for Error {
    fn from(error: StudyError) -> Self {
        Error::Study(Box::new(error))
    }
}
