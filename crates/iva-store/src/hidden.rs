//! The hidden folders of the program in the folder of a result, which hold a mark in a file.

use std::io::ErrorKind;
use std::path::Path;

use crate::directory::{Directory, Kind};
use crate::error::Error;
use crate::fault::Fault;
use crate::folder::{MANIFEST_FILE, NEW, WORK};
use crate::remedy::Remedy;

/// Name of the file of the mark, which in the folder of unfinished files also serves as the lock.
pub(crate) const MARK_FILE: &str = "lock";
/// Contents of the file of the mark.
pub(crate) const MARK: &[u8] = b"Made by iva-dynamics for unfinished files; iva removes it.\n";

/// Opens the folder of unfinished files, which is created if it is absent.
///
/// # Errors
/// [`Error::Folder`] if a folder of that name has no mark, [`Error::Io`] if it cannot be created.
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

/// Opens the folder of a result that is to replace another, if there is one.
///
/// # Errors
/// [`Error::Folder`] if a folder of that name has no mark.
pub(crate) fn new_folder(dir: &Directory) -> Result<Option<Directory>, Error> {
    let Some(new) = dir.folder(Path::new(NEW))? else { return Ok(None) };
    refuse_unmarked(&new)?;
    Ok(Some(new))
}

/// Creates the folder of a result that is to replace another, and marks it.
///
/// # Errors
/// [`Error::Folder`] if a folder of that name has no mark, [`Error::Io`] if it cannot be created.
pub(crate) fn make_new_folder(dir: &Directory) -> Result<Directory, Error> {
    let new = dir.make_folder(Path::new(NEW))?;
    refuse_unmarked(&new)?;
    mark(&new)?;
    Ok(new)
}

/// Writes the mark into a folder.
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

/// Removes the folder of a result that was to replace another.
///
/// # Errors
/// [`Error::Folder`] if a folder of that name has no mark, [`Error::Io`] if it cannot be removed.
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

/// Removes the contents of a hidden folder but its mark.
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

/// Removes a hidden folder, with its mark last, so that the rest of a removal that is killed still has it. A
/// folder that stays, because a worker of a cluster has just put files into it, is marked again.
fn remove_hidden(dir: &Directory, hidden: &Directory, name: &Path) -> Result<(), Error> {
    empty(hidden)?;
    let mark = Path::new(MARK_FILE);
    hidden.remove_file(mark)?;
    dir.remove_if_empty(name);
    if dir.kind(name)?.is_none() {
        return Ok(());
    }
    match hidden.write_new(mark, MARK) {
        // Another process has marked or removed the folder meanwhile.
        Err(Error::Io { source, .. })
            if matches!(source.kind(), ErrorKind::AlreadyExists | ErrorKind::NotFound) =>
        {
            Ok(())
        }
        marked => marked,
    }
}

/// True if `.iva-new` holds a sweep that is to replace the result of the folder.
///
/// # Errors
/// As [`new_folder`].
pub(crate) fn holds_kept_sweep(dir: &Directory) -> Result<bool, Error> {
    let Some(new) = new_folder(dir)? else { return Ok(false) };
    Ok(new.kind(Path::new(MANIFEST_FILE))? == Some(Kind::File))
}

/// Refuses a hidden folder without the mark, unless it is empty or holds only the beginning of a mark, as
/// after a kill during its creation.
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
