//! Reasons for refusing a folder.

use std::io;
use std::path::PathBuf;

use crate::folder::MANIFEST_FILE;

/// The reason for refusing a folder, with the paths concerned. `Display` gives one sentence without a full
/// stop; the advice to the user is a [`crate::remedy::Remedy`].
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The path of the output folder is that of a file.
    #[error("the output folder {} is a file", .0.display())]
    IsFile(PathBuf),
    /// The folder holds tables, and replacing them was not allowed.
    #[error("the output folder {} already holds tables", .0.display())]
    HoldsTables(PathBuf),
    /// The folder cannot be created or written into.
    #[error("cannot write into the folder {}: {reason}", .dir.display())]
    Unwritable {
        /// The folder.
        dir: PathBuf,
        /// Error of the operating system.
        reason: io::Error,
    },
    /// Another process holds the lock of the folder.
    #[error("another process is writing into {}", .0.display())]
    Taken(PathBuf),
    /// A file that the program did not write has the name of a file of the result.
    #[error("{} {what} and would be replaced", .path.display())]
    InTheWay {
        /// The file.
        path: PathBuf,
        /// Predicate of the message, for example `was not written by iva`.
        what: &'static str,
    },
    /// A link, folder or file has the name that something of another kind must have.
    #[error("{} {what}", .path.display())]
    OtherKind {
        /// Path of what was found.
        path: PathBuf,
        /// Predicate of the message, for example `is a folder where a file must go`.
        what: &'static str,
    },
    /// A hidden folder has the name of one of the program's and does not hold its mark.
    #[error("{} was not made by iva and would be used for unfinished files", .0.display())]
    Unmarked(PathBuf),
    /// The journal of an exchange of results cannot be read as one.
    #[error("{} is no list of files of a result", .0.display())]
    BadJournal(PathBuf),
    /// The manifest is invalid.
    #[error("{}: {reason}", .path.display())]
    BadManifest {
        /// Path of the manifest.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The folder holds another sweep than the one to resume.
    #[error("{} holds another sweep: {}", .dir.display(), .differences.join("; "))]
    OtherSweep {
        /// The folder.
        dir: PathBuf,
        /// Differences between the two sweeps, one sentence each.
        differences: Vec<String>,
    },
    /// The folder holds tables of another study, without a manifest that lists the complete ones.
    #[error("{} holds tables of another study and no {MANIFEST_FILE} to go on from", .0.display())]
    OtherTables(PathBuf),
}
