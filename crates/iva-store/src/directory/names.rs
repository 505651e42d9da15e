//! Components of names below a folder, and the evaluation of errors and metadata of the system.

use std::ffi::OsStr;
use std::io::{self, ErrorKind};
use std::path::{Component, Path};

use crate::directory::Directory;
use crate::error::Error;

/// The components of a name below a folder.
///
/// # Errors
/// [`Error::Io`] for a name with a root, a prefix, `.` in front or `..`.
pub(super) fn components<'a>(folder: &Directory, name: &'a Path) -> Result<Vec<&'a OsStr>, Error> {
    let plain = |component| match component {
        Component::Normal(name) => Ok(name),
        _ => {
            let reason = io::Error::other("it is no plain name below the folder");
            Err(Error::io("use", &folder.path().join(name), reason))
        }
    };
    name.components().map(plain).collect()
}

/// True if the error says that there is no entry of a name.
pub(super) fn is_absent(reason: &io::Error) -> bool {
    matches!(reason.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
}

/// Treats the removal of an absent file or folder as a success.
pub(super) fn absent_is_fine(removed: Result<(), Error>) -> Result<(), Error> {
    match removed {
        Err(Error::Io { source, .. }) if source.kind() == ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

/// True if both metadata are those of one folder.
#[cfg(unix)]
pub(super) fn is_same(one: &cap_std::fs::Metadata, other: &cap_std::fs::Metadata) -> bool {
    use cap_std::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

/// True if both metadata may be those of one folder: without inode numbers any two may be.
#[cfg(not(unix))]
pub(super) fn is_same(_one: &cap_std::fs::Metadata, other: &cap_std::fs::Metadata) -> bool {
    other.is_dir()
}
