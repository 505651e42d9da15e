//! Why a folder cannot take a result as asked.

use std::io;
use std::path::PathBuf;

use crate::folder::MANIFEST_FILE;

/// What is wrong with a folder, with the names that it concerns. `Display` says it in one sentence without a
/// stop; what can be done is a [`crate::remedy::Remedy`].
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The folder is a file.
    #[error("the output folder {} is a file", .0.display())]
    IsFile(PathBuf),
    /// The folder holds tables, and nothing says that they may be replaced.
    #[error("the output folder {} already holds tables", .0.display())]
    HoldsTables(PathBuf),
    /// Nothing can be written into the folder.
    #[error("cannot write into the folder {}: {reason}", .dir.display())]
    Unwritable {
        /// The folder.
        dir: PathBuf,
        /// What the system said.
        reason: io::Error,
    },
    /// Another process has taken the folder.
    #[error("another process is writing into {}", .0.display())]
    Taken(PathBuf),
    /// A file of others stands where one of a result must go.
    #[error("{} {what} and would be replaced", .path.display())]
    InTheWay {
        /// The file.
        path: PathBuf,
        /// What it is, or is not.
        what: &'static str,
    },
    /// A link, folder or file stands where something of another kind must go.
    #[error("{} {what}", .path.display())]
    OtherKind {
        /// What stands there.
        path: PathBuf,
        /// What it is, and what must go there.
        what: &'static str,
    },
    /// A hidden folder has the name of one of ours and no mark.
    #[error("{} was not made by iva and would be used for unfinished files", .0.display())]
    Unmarked(PathBuf),
    /// The list of files that are to be moved cannot be understood.
    #[error("{} is no list of files of a result", .0.display())]
    BadJournal(PathBuf),
    /// The manifest cannot be understood.
    #[error("{}: {reason}", .path.display())]
    BadManifest {
        /// The manifest.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The folder holds a sweep that is not the one to go on with.
    #[error("{} holds another sweep: {}", .dir.display(), .differences.join("; "))]
    OtherSweep {
        /// The folder.
        dir: PathBuf,
        /// What differs, one sentence each.
        differences: Vec<String>,
    },
    /// The folder holds tables of another study, and nothing says which of them are complete.
    #[error("{} holds tables of another study and no {MANIFEST_FILE} to go on from", .0.display())]
    OtherTables(PathBuf),
}
