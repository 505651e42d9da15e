//! What can go wrong with a folder of results and the files in it.

use std::io;
use std::path::{Path, PathBuf};

use iva_sweep::Invalid;
use iva_sweep::sweep::SweepError;

use crate::fault::Fault;
use crate::remedy::{Remedy, Words};

/// A failure of writing or reading results. `Display` says what is wrong, and [`Error::message`] also what the
/// user can do about it, with the option names of a front.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A study without units or with values that cannot be used.
    #[error(transparent)]
    Invalid(#[from] Invalid),
    /// A folder that cannot take a result as asked.
    #[error("{fault}")]
    Folder {
        /// Reason for the refusal.
        fault: Fault,
        /// Advice to the user.
        remedy: Remedy,
    },
    /// A part was computed by another version of the program.
    #[error(
        "a worker runs iva-dynamics {theirs:?}, this is {ours}: install the same version on all of them"
    )]
    OtherVersion {
        /// The version of the process that ran the part.
        theirs: String,
        /// The version of this process.
        ours: String,
    },
    /// The report of a worker about a part contradicts the sweep.
    #[error("what a worker said of part {part} does not fit the sweep")]
    UnfitPart {
        /// The number of the part.
        part: u64,
    },
    /// The files of a part differ from the report of the worker that ran it.
    #[error("the files of part {part} are not what its worker said")]
    ChangedPart {
        /// The number of the part.
        part: u64,
    },
    /// Reading or writing failed.
    #[error("cannot {action} {}: {source}", .path.display())]
    Io {
        /// Verb for the attempted action, for example `write`.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Finished tables could not be moved into place.
    #[error("{reason}; {what} are kept in {}", .kept.display())]
    NotMoved {
        /// Failure that prevented the move.
        reason: Box<Error>,
        /// Name of the tables concerned, for example `the new tables`.
        what: &'static str,
        /// Folder that holds the tables now.
        kept: PathBuf,
    },
    /// A fault of this program or of the machine, such as a table that cannot be encoded.
    #[error("internal fault: {0}")]
    Internal(String),
}

impl Error {
    /// An [`Error::Folder`] from its reason and the advice to the user.
    pub fn folder(fault: Fault, remedy: Remedy) -> Self {
        Self::Folder { fault, remedy }
    }

    /// The message with advice to the user, in the option names of a front.
    pub fn message(&self, words: &Words) -> String {
        match self {
            Error::Folder { fault, remedy } => format!("{fault}; {}", remedy.sentence(words)),
            Error::NotMoved { reason, what, kept } => {
                format!("{}; {what} are kept in {}", reason.message(words), kept.display())
            }
            other => other.to_string(),
        }
    }

    /// True if another request of the user can avoid the error, false for I/O errors and internal faults.
    pub fn is_bad_input(&self) -> bool {
        match self {
            Error::Invalid(_)
            | Error::Folder { .. }
            | Error::OtherVersion { .. }
            | Error::UnfitPart { .. }
            | Error::ChangedPart { .. } => true,
            Error::NotMoved { reason, .. } => reason.is_bad_input(),
            Error::Io { .. } | Error::Internal(_) => false,
        }
    }

    /// An I/O error of an action on a path.
    pub(crate) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Error::Io { action, path: path.to_owned(), source }
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
