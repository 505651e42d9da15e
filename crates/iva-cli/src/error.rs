//! What can go wrong between a study file and its tables, and the exit code of each.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use iva_sweep::Invalid;
use iva_sweep::sweep::SweepError;

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
    /// Ctrl-C, with what became of the results.
    #[error("interrupted: {0}")]
    Interrupted(String),
    /// A fault of this program or of the machine: a table that cannot be built, threads that do
    /// not start.
    #[error("internal fault: {0}")]
    Internal(String),
}

impl Error {
    /// 2 for bad input, 1 for an I/O or internal fault, 130 for an interrupt.
    pub fn exit_code(&self) -> i32 {
        match self {
            Error::Study(_) | Error::Invalid(_) | Error::Refused(_) => 2,
            Error::Io { .. } | Error::Internal(_) => 1,
            Error::Interrupted(_) => 130,
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
    /// The line, without its end; of a long line the part around the column.
    pub text: String,
    /// Characters of `text` before the stretch.
    pub indent: usize,
    /// Number of characters the stretch covers, at least 1.
    pub width: usize,
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(place) = &self.place else {
            return write!(f, "{}: {}", self.path.display(), self.message);
        };
        let number = place.line.to_string();
        let margin = " ".repeat(number.len());
        // Tabs are kept so that the marks stand under the text they mark.
        let indent: String = place
            .text
            .chars()
            .take(place.indent)
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        writeln!(f, "{}:{}:{}: {}", self.path.display(), place.line, place.column, self.message)?;
        writeln!(f, " {margin} |")?;
        writeln!(f, " {number} | {}", place.text)?;
        write!(f, " {margin} | {indent}{}", "^".repeat(place.width))
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
