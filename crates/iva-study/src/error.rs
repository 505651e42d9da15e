//! Errors of reading a study and of running it into a folder.

use std::fmt;
use std::io;
use std::ops::Range;
use std::path::PathBuf;

use iva_store::folder::STUDY_FILE;
use iva_store::remedy::Words;
use iva_sweep::Invalid;
use iva_sweep::sweep::SweepError;

use crate::study_file::MOST_BYTES;

/// A failure of reading a study or of running it into a folder. `Display` says what is wrong; a front adds the
/// advice about a folder and what is kept of a sweep, in its own option names.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The contents of a study file or of a file of a record are invalid.
    #[error("{0}")]
    Study(Box<StudyError>),
    /// A value without a place in a file is invalid, for example one of a study made in a program.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// A study file cannot be opened or read.
    #[error("cannot read the study file {}: {reason}", .path.display())]
    UnreadableStudy {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        reason: io::Error,
    },
    /// A study file is larger than the limit.
    #[error(
        "{} has {:.1} MB; a study file has at most {} MB: give many points as a file of points",
        .path.display(), *.bytes as f64 / 1e6, MOST_BYTES / 1_000_000
    )]
    LargeStudy {
        /// The file.
        path: PathBuf,
        /// Size of the file in bytes.
        bytes: u64,
    },
    /// A study file is not text in UTF-8.
    #[error("{}: line {line} is not UTF-8 text; a study file is TOML in UTF-8", .path.display())]
    NotText {
        /// The file.
        path: PathBuf,
        /// Number of the first line that is not UTF-8, from 1.
        line: usize,
    },
    /// The resolved study would be larger than a study file may be.
    #[error(
        "the values of the sweep would take {:.1} MB in {STUDY_FILE}, and a study file has at most {} MB: \
         give the points one by one, as a frame or a file of points",
        *.bytes as f64 / 1e6, MOST_BYTES / 1_000_000
    )]
    LargeResolved {
        /// Size of its text in bytes.
        bytes: u64,
    },
    /// A file of a record cannot be opened or read.
    #[error("cannot read {}: {reason}", .path.display())]
    UnreadableRecord {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        reason: io::Error,
    },
    /// A file of a record is larger than the limit.
    #[error("{} is larger than 1 GiB; give a record of at most that size", .path.display())]
    LargeRecord {
        /// The file.
        path: PathBuf,
    },
    /// A file with other contents stands where an example would be written.
    #[error("{} is there and has other contents; give another folder, or move it away", .path.display())]
    OtherContents {
        /// The file.
        path: PathBuf,
    },
    /// A folder cannot take a result, or a file of a result cannot be read or written.
    #[error(transparent)]
    Store(#[from] iva_store::Error),
    /// A sweep failed midway; `Display` does not say what is kept of it.
    #[error("{reason}")]
    Incomplete {
        /// Error that ended the sweep.
        reason: Box<Error>,
        /// Complete parts that are kept.
        kept: Kept,
    },
    /// A sweep was cancelled; `Display` does not say what is kept of it.
    #[error("interrupted")]
    Interrupted(Kept),
    /// A fault of this program or of the machine, such as threads that do not start.
    #[error("internal fault: {0}")]
    Internal(String),
}

impl Error {
    /// True if another request of the user can avoid the error, false for I/O errors, internal faults and a sweep
    /// that was cancelled.
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
            | Error::LargeRecord { .. }
            | Error::OtherContents { .. } => true,
        }
    }

    /// True if the sweep was cancelled.
    pub fn is_interrupted(&self) -> bool {
        match self {
            Error::Interrupted(_) => true,
            Error::Incomplete { reason, .. } => reason.is_interrupted(),
            _ => false,
        }
    }
}

/// The complete parts that are kept of a sweep that ended early.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kept {
    /// The folder of the sweep.
    pub dir: PathBuf,
    /// Number of points of complete parts.
    pub done: u64,
    /// Number of points of the sweep.
    pub points: u64,
    /// True if the sweep was to replace earlier tables.
    pub replaced: bool,
}

impl Kept {
    /// The value for a sweep without complete parts.
    pub fn nothing() -> Self {
        Self { dir: PathBuf::new(), done: 0, points: 0, replaced: false }
    }

    /// One sentence on what is kept and how to resume the sweep, in the option names of a front.
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

/// An error in a study file or a file of a record, with its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StudyError {
    /// Path of the file, as named by the user.
    pub path: PathBuf,
    /// Place in the file; `None` if something is missing.
    pub place: Option<Place>,
    /// One sentence with the field, its value and the allowed values.
    pub message: String,
}

/// A range of characters in one line of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Line number from 1.
    pub line: usize,
    /// Column from 1, in characters.
    pub column: usize,
    /// Text of the line, without its end.
    pub text: String,
    /// Range of bytes in `text`.
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
