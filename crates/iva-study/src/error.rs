//! What can go wrong between a study file and the tables of its sweep.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::PathBuf;

use iva_store::folder::STUDY_FILE;
use iva_store::remedy::Words;
use iva_sweep::Invalid;
use iva_sweep::sweep::SweepError;

use crate::study_file::MOST_BYTES;

/// Everything that reading a study and running it into a folder can fail with. `Display` says what is wrong;
/// what the user can do about a folder, and what is kept of a sweep, a front says in its own words.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Something in a study file or in a file of a record, with its place.
    #[error("{0}")]
    Study(Box<StudyError>),
    /// A value from elsewhere, such as a study built in a program.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// A study file cannot be opened or read.
    #[error("cannot read the study file {}: {reason}", .path.display())]
    UnreadableStudy {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: io::Error,
    },
    /// A study file is larger than any is.
    #[error(
        "{} has {:.1} MB; a study file has at most {} MB: give many points as a file of points",
        .path.display(), *.bytes as f64 / 1e6, MOST_BYTES / 1_000_000
    )]
    LargeStudy {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// A study file is no text in UTF-8.
    #[error("{}: line {line} is not UTF-8 text; a study file is TOML in UTF-8", .path.display())]
    NotText {
        /// The file.
        path: PathBuf,
        /// The first line that is not, from 1.
        line: usize,
    },
    /// The resolved study would be larger than a study file may be.
    #[error(
        "the values of the sweep would take {:.1} MB in {STUDY_FILE}, and a study file has at most {} MB: \
         give the points one by one, as a frame or a file of points",
        *.bytes as f64 / 1e6, MOST_BYTES / 1_000_000
    )]
    LargeResolved {
        /// Its size.
        bytes: u64,
    },
    /// A file of a record cannot be opened or read.
    #[error("cannot read {}: {reason}", .path.display())]
    UnreadableRecord {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: io::Error,
    },
    /// A file of a record is larger than any is.
    #[error("{} is larger than 1 GiB; give a record of at most that size", .path.display())]
    LargeRecord {
        /// The file.
        path: PathBuf,
    },
    /// A folder that cannot take a result, or a file of one that cannot be read or written.
    #[error(transparent)]
    Store(#[from] iva_store::Error),
    /// A fault midway; what is kept of the finished parts is not part of `Display`.
    #[error("{reason}")]
    Incomplete {
        /// What went wrong.
        reason: Box<Error>,
        /// What is kept of the results.
        kept: Kept,
    },
    /// The sweep was cancelled; what is kept of it is not part of `Display`.
    #[error("interrupted")]
    Interrupted(Kept),
    /// A fault of this program or of the machine, such as threads that do not start.
    #[error("internal fault: {0}")]
    Internal(String),
}

impl Error {
    /// True if the user can mend it by asking for something else, false for a fault of reading or writing, a defect,
    /// and a sweep that was cancelled.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Error::Store(error) => error.is_bad_input(),
            Error::Incomplete { reason, .. } => reason.is_bad_input(),
            Error::UnreadableRecord { .. } | Error::Interrupted(_) | Error::Internal(_) => false,
            Error::Study(_)
            | Error::Invalid(_)
            | Error::UnreadableStudy { .. }
            | Error::LargeStudy { .. }
            | Error::NotText { .. }
            | Error::LargeResolved { .. }
            | Error::LargeRecord { .. } => true,
        }
    }

    /// True if the user ended it.
    pub fn is_interrupted(&self) -> bool {
        match self {
            Error::Interrupted(_) => true,
            Error::Incomplete { reason, .. } => reason.is_interrupted(),
            _ => false,
        }
    }
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

    /// One sentence, which says in the words of a front how to ask for the rest.
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
