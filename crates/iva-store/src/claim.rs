//! The lock on the folder of a result: as long as a claim lives, no other process writes results into it.

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

/// A locked folder with its folder of unfinished files. Drop removes the unfinished files, the folders that
/// were created and are empty, and the lock.
#[derive(Debug)]
pub(crate) struct Claim {
    dir: Directory,
    work: Directory,
    // Fields drop in this order: the lock is held until everything is removed.
    _created: CreatedFolders,
    lock: File,
}

impl Claim {
    /// Creates and locks a folder, and completes or undoes an exchange of results that a killed process began.
    ///
    /// # Errors
    /// [`Error::Folder`] if it cannot be written or another process has locked it, [`Error::NotMoved`] if the
    /// exchange cannot be ended.
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

    /// Writes the mark into the locked file, which must not be replaced by another.
    fn mark(&self) -> Result<(), Error> {
        let name = Path::new(MARK_FILE);
        if self.work.read(name, MARK.len() as u64)?.as_deref() == Some(MARK) {
            return Ok(());
        }
        let mut lock = &self.lock;
        let written = lock.set_len(0).and_then(|()| lock.write_all(MARK));
        written.map_err(|reason| Error::io("write", &self.work.path().join(name), reason))
    }

    /// The folder of the result.
    pub(crate) fn dir(&self) -> &Directory {
        &self.dir
    }

    /// The folder of unfinished files.
    pub(crate) fn work(&self) -> &Directory {
        &self.work
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // The next process that locks the folder removes the rest.
        let _ = remove_work_folder(&self.dir);
    }
}

/// Completes or undoes an exchange of results that a killed process began in a folder, if there is one.
///
/// # Errors
/// As [`Claim::take`], and [`Error::Io`] if the folder cannot be read.
pub(crate) fn end_exchange(path: &Path) -> Result<(), Error> {
    match Directory::find(path)? {
        Some(dir) if exchange::is_begun(&dir)? => Claim::take(path).map(drop),
        _ => Ok(()),
    }
}

/// An I/O error as a refusal of the folder, since the user can choose another one.
fn refused(path: &Path, error: Error) -> Error {
    match error {
        Error::Io { source, .. } => unwritable(path, source),
        other => other,
    }
}

/// Opens and locks the file of the mark in the folder of unfinished files; the system releases the lock with
/// the process. On a file system without locks the folder counts as locked.
fn lock(path: &Path, work: &Directory) -> Result<File, Error> {
    let taken = || Error::folder(Fault::Taken(path.to_owned()), Remedy::WaitOrOtherFolder);
    let name = Path::new(MARK_FILE);
    let file = match work.open_or_create_file(name) {
        // The process that had the lock has just removed the folder.
        Err(Error::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
            return Err(taken());
        }
        other => other.map_err(|error| refused(path, error))?,
    };
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(taken()),
        // The process that had the lock may have removed the file between opening and locking.
        _ if is_still(&file, work)? => Ok(file),
        _ => Err(taken()),
    }
}

/// True if the file of the mark in `work` is the open one.
#[cfg(unix)]
fn is_still(file: &File, work: &Directory) -> Result<bool, Error> {
    use std::os::unix::fs::MetadataExt;
    let there = work.open_file(Path::new(MARK_FILE))?.map(|there| there.metadata());
    Ok(match (file.metadata(), there) {
        (Ok(ours), Some(Ok(there))) => (ours.dev(), ours.ino()) == (there.dev(), there.ino()),
        _ => false,
    })
}

/// True if there is a file of the mark in `work`: systems without inode numbers do not tell which one.
#[cfg(not(unix))]
fn is_still(_file: &File, work: &Directory) -> Result<bool, Error> {
    Ok(work.kind(Path::new(MARK_FILE))?.is_some())
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
    use std::thread;
    use std::time::{Duration, Instant};

    use super::*;
    use crate::folder::WORK;

    /// A worker of a cluster that does not know of an interruption writes the files of its part into the folder
    /// of unfinished files while another process removes that folder.
    #[test]
    fn a_folder_that_a_late_worker_writes_into_can_be_taken_again() {
        let home = tempfile::tempdir().unwrap();
        let dir = home.path().join("out");
        let (ended, made) = (AtomicBool::new(false), AtomicU32::new(0));
        fs::create_dir(&dir).unwrap();
        thread::scope(|scope| {
            scope.spawn(|| {
                while !ended.load(Ordering::Relaxed) {
                    let Ok(work) = Directory::open(&dir.join(WORK)) else { continue };
                    let Ok((name, folder)) = work.make_new_folder("part-of-0") else { continue };
                    if folder.write_new(Path::new("summary"), b"rows").is_ok() {
                        made.fetch_add(1, Ordering::Relaxed);
                    }
                    let _ = work.remove_folder(Path::new(&name));
                }
            });
            // Until both have met, however seldom the system lets the worker run; the time only ends what hangs.
            let begin = Instant::now();
            let meets =
                || made.load(Ordering::Relaxed) > 0 || begin.elapsed() > Duration::from_secs(300);
            let mut turns = (0..).take_while(|turn| *turn < 2000 || !meets());
            // The assertions come after the end of the thread, which would otherwise run on.
            let failure = turns.find_map(|_| Claim::take(&dir).map(drop).err());
            ended.store(true, Ordering::Relaxed);
            assert!(failure.is_none(), "{failure:?}");
        });
        assert!(made.into_inner() > 0, "the worker never met the folder");
    }
}
