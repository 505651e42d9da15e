//! Hidden folders of this program in the folder of a result, told by a mark that stands in them.

use std::io::ErrorKind;
use std::path::Path;

use crate::directory::{Directory, Kind};
use crate::error::Error;
use crate::fault::Fault;
use crate::folder::{MANIFEST_FILE, NEW, WORK};
use crate::remedy::Remedy;

/// The file of the mark. In the folder of unfinished files it is locked by the process that writes there.
pub(crate) const MARK_FILE: &str = "lock";
/// What stands in it.
pub(crate) const MARK: &[u8] = b"Made by iva-dynamics for unfinished files; iva removes it.\n";

/// The folder of unfinished files, made if there is none.
///
/// # Errors
/// [`Error::Folder`] if a folder of that name is not ours, [`Error::Io`] if it cannot be made.
pub(crate) fn work_folder(dir: &Directory) -> Result<Directory, Error> {
    let name = Path::new(WORK);
    // A worker of a cluster may put files into a new folder before it is marked.
    let is_new = dir.make_absent_folder(name)?;
    let work = dir.make_folder(name)?;
    if !is_new {
        refuse_unmarked(&work)?;
    }
    Ok(work)
}

/// The folder of a result that is to replace another, if there is one.
///
/// # Errors
/// [`Error::Folder`] if a folder of that name is not ours.
pub(crate) fn new_folder(dir: &Directory) -> Result<Option<Directory>, Error> {
    let Some(new) = dir.folder(Path::new(NEW))? else { return Ok(None) };
    refuse_unmarked(&new)?;
    Ok(Some(new))
}

/// Makes the folder of a result that is to replace another, and marks it.
///
/// # Errors
/// As [`work_folder`].
pub(crate) fn make_new_folder(dir: &Directory) -> Result<Directory, Error> {
    let new = dir.make_folder(Path::new(NEW))?;
    refuse_unmarked(&new)?;
    mark(&new)?;
    Ok(new)
}

/// Marks a folder as ours.
///
/// # Errors
/// [`Error::Io`] if the mark cannot be written.
pub(crate) fn mark(folder: &Directory) -> Result<(), Error> {
    let name = Path::new(MARK_FILE);
    if folder.read(name, MARK.len() as u64)?.as_deref() == Some(MARK) {
        return Ok(());
    }
    folder.remove_file(name)?;
    folder.write_new(name, MARK)
}

/// Removes the result that was to replace another.
///
/// # Errors
/// [`Error::Folder`] if a folder of that name is not ours, [`Error::Io`] if it cannot be removed.
pub(crate) fn remove_new_folder(dir: &Directory) -> Result<(), Error> {
    match new_folder(dir)? {
        Some(new) => remove_hidden(dir, &new, Path::new(NEW)),
        None => Ok(()),
    }
}

/// Removes the folder of unfinished files.
///
/// # Errors
/// As [`remove_new_folder`].
pub(crate) fn remove_work_folder(dir: &Directory) -> Result<(), Error> {
    match dir.folder(Path::new(WORK))? {
        Some(work) => {
            refuse_unmarked(&work).and_then(|()| remove_hidden(dir, &work, Path::new(WORK)))
        }
        None => Ok(()),
    }
}

/// Removes what is in a hidden folder but its mark.
///
/// # Errors
/// [`Error::Io`] if something cannot be removed.
pub(crate) fn empty(hidden: &Directory) -> Result<(), Error> {
    for name in hidden.names()?.iter().filter(|name| *name != MARK_FILE).map(Path::new) {
        match hidden.kind(name)? {
            Some(Kind::Folder) => hidden.remove_folder(name)?,
            _ => hidden.remove_file(name)?,
        }
    }
    Ok(())
}

/// The mark goes last, so that what a kill leaves of the folder can still be told as ours. If the folder stays,
/// because a worker of a cluster has just put files into it, it is marked again.
fn remove_hidden(dir: &Directory, hidden: &Directory, name: &Path) -> Result<(), Error> {
    empty(hidden)?;
    let mark = Path::new(MARK_FILE);
    hidden.remove_file(mark)?;
    dir.remove_if_empty(name);
    if dir.kind(name)?.is_none() {
        return Ok(());
    }
    match hidden.write_new(mark, MARK) {
        // Another process has taken the folder meanwhile, or removed it.
        Err(Error::Io { source, .. })
            if matches!(source.kind(), ErrorKind::AlreadyExists | ErrorKind::NotFound) =>
        {
            Ok(())
        }
        marked => marked,
    }
}

/// True if parts of a sweep that is to replace another have been kept.
///
/// # Errors
/// As [`new_folder`].
pub(crate) fn holds_kept_sweep(dir: &Directory) -> Result<bool, Error> {
    let Some(new) = new_folder(dir)? else { return Ok(false) };
    Ok(new.kind(Path::new(MANIFEST_FILE))? == Some(Kind::File))
}

/// A folder is ours that holds the mark; or nothing, or an empty mark alone, as after a kill in its first
/// moment.
fn refuse_unmarked(folder: &Directory) -> Result<(), Error> {
    let mark = folder.read(Path::new(MARK_FILE), 1 << 12)?;
    let ours = match mark.as_deref() {
        Some(MARK) => true,
        Some(begun) if MARK.starts_with(begun) => folder.names()? == [MARK_FILE],
        Some(_) => false,
        None => folder.names()?.is_empty(),
    };
    match ours {
        true => Ok(()),
        false => {
            let fault = Fault::Unmarked(folder.path().to_owned());
            Err(Error::folder(fault, Remedy::MoveOrOtherFolder))
        }
    }
}
