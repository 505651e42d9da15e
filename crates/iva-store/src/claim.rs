//! A folder taken by one process: as long as a claim lives, no other process writes results into it.

use std::fs::{File, TryLockError};
use std::io::{self, Write};
use std::path::Path;

use crate::created::CreatedFolders;
use crate::directory::Directory;
use crate::error::Error;
use crate::exchange;
use crate::fault::Fault;
use crate::folder::unwritable;
use crate::hidden::{MARK, MARK_FILE, empty, remove_work_folder, work_folder};
use crate::remedy::Remedy;

/// A folder that is ours, with a place for unfinished files. When it is let go the unfinished files go,
/// and so do folders that were made and hold nothing.
#[derive(Debug)]
pub(crate) struct Claim {
    dir: Directory,
    work: Directory,
    // Dropped in this order: the lock is held until all is removed.
    _created: CreatedFolders,
    lock: File,
}

impl Claim {
    /// Takes a folder, and ends an exchange of tables that a killed process began.
    ///
    /// # Errors
    /// [`Error::Folder`] if it cannot be written, or another process has it.
    pub(crate) fn take(path: &Path) -> Result<Self, Error> {
        let unwritable = |reason: io::Error| unwritable(path, reason);
        let created = CreatedFolders::create(path).map_err(unwritable)?;
        let dir = Directory::open(path).map_err(unwritable)?;
        let work = work_folder(&dir).map_err(|error| refused(path, error))?;
        let lock = lock(path, &work)?;
        let claim = Self { dir, work, _created: created, lock };
        claim.mark()?;
        empty(&claim.work)?;
        exchange::finish(&claim.dir)?;
        Ok(claim)
    }

    /// Writes the mark into the locked file, which must stay the one that it is.
    fn mark(&self) -> Result<(), Error> {
        let name = Path::new(MARK_FILE);
        if self.work.read(name, MARK.len() as u64)?.as_deref() == Some(MARK) {
            return Ok(());
        }
        let mut lock = &self.lock;
        let written = lock.set_len(0).and_then(|()| lock.write_all(MARK));
        written.map_err(|reason| Error::io("write", &self.work.path().join(name), reason))
    }

    /// The folder.
    pub(crate) fn dir(&self) -> &Directory {
        &self.dir
    }

    /// Where unfinished files are.
    pub(crate) fn work(&self) -> &Directory {
        &self.work
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // What cannot be removed now is removed by the next process that takes the folder.
        let _ = remove_work_folder(&self.dir);
    }
}

/// Ends an exchange of tables in a folder that a killed process began, if there is one.
///
/// # Errors
/// As [`Claim::take`], if there is one.
pub(crate) fn end_exchange(path: &Path) -> Result<(), Error> {
    match Directory::find(path)? {
        Some(dir) if exchange::is_begun(&dir)? => Claim::take(path).map(drop),
        _ => Ok(()),
    }
}

/// A failure to write is the user's to mend: another folder can be chosen.
fn refused(path: &Path, error: Error) -> Error {
    match error {
        Error::Io { source, .. } => unwritable(path, source),
        other => other,
    }
}

/// Locks the mark of the folder of unfinished files, until this process ends, however it ends. Where the
/// file system knows no locks the folder is taken on trust.
fn lock(path: &Path, work: &Directory) -> Result<File, Error> {
    let taken = || Error::folder(Fault::Taken(path.to_owned()), Remedy::WaitOrOtherFolder);
    let name = Path::new(MARK_FILE);
    let file = match work.open_or_create_file(name) {
        // The process that had it has just removed the folder.
        Err(Error::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
            return Err(taken());
        }
        other => other.map_err(|error| refused(path, error))?,
    };
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(taken()),
        // Between opening and locking the process that had it may have removed it.
        _ if is_still(&file, work)? => Ok(file),
        _ => Err(taken()),
    }
}

#[cfg(unix)]
fn is_still(file: &File, work: &Directory) -> Result<bool, Error> {
    use std::os::unix::fs::MetadataExt;
    let there = work.open_file(Path::new(MARK_FILE))?.map(|there| there.metadata());
    Ok(match (file.metadata(), there) {
        (Ok(ours), Some(Ok(there))) => (ours.dev(), ours.ino()) == (there.dev(), there.ino()),
        _ => false,
    })
}

#[cfg(not(unix))]
fn is_still(_file: &File, work: &Directory) -> Result<bool, Error> {
    Ok(work.kind(Path::new(MARK_FILE))?.is_some())
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;

    use super::*;
    use crate::folder::WORK;

    /// A worker of a cluster does not know that the sweep was interrupted, and goes on to put the files of its part
    /// into the folder of unfinished files while that is removed.
    #[test]
    fn a_folder_that_a_late_worker_writes_into_can_be_taken_again() {
        let home = tempfile::tempdir().unwrap();
        let (dir, ended) = (home.path().join("out"), AtomicBool::new(false));
        fs::create_dir(&dir).unwrap();
        thread::scope(|scope| {
            let work = scope.spawn(|| {
                let mut made = 0;
                while !ended.load(Ordering::Relaxed) {
                    let Ok(work) = Directory::open(&dir.join(WORK)) else { continue };
                    let Ok((name, folder)) = work.make_new_folder("part-of-0") else { continue };
                    made += u32::from(folder.write_new(Path::new("summary"), b"rows").is_ok());
                    let _ = work.remove_folder(Path::new(&name));
                }
                made
            });
            // The thread ends before a failure is told.
            let failure = (0..2000).find_map(|_| Claim::take(&dir).map(drop).err());
            ended.store(true, Ordering::Relaxed);
            let made = work.join().unwrap();
            assert!(failure.is_none(), "{failure:?}");
            assert!(made > 0, "the worker never met the folder");
        });
    }
}
