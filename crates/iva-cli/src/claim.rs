//! A folder taken by one process: as long as a claim lives, no other process writes results into it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::folder::{STAGING_PREFIX, unwritable};
use crate::moves::{CreatedFolders, finish_exchange};

/// A folder that is ours, with a place for unfinished files. When it is let go the unfinished files go,
/// and so do folders that were made and hold nothing.
#[derive(Debug)]
pub(crate) struct Claim {
    dir: PathBuf,
    // Dropped in this order: the lock is held until all is removed.
    _created: CreatedFolders,
    _lock: File,
}

impl Claim {
    /// Takes a folder, and ends an exchange of tables that a killed process began.
    ///
    /// # Errors
    /// [`Error::Refused`] if it cannot be written, or another process has it.
    pub(crate) fn take(dir: &Path) -> Result<Self, Error> {
        let unwritable = |reason: io::Error| unwritable(dir, &reason);
        let created = CreatedFolders::create(dir).map_err(unwritable)?;
        let work = work_folder(dir);
        fs::create_dir_all(&work).map_err(unwritable)?;
        let lock = lock(dir, &work)?;
        finish_exchange(dir)?;
        let claim = Self { dir: dir.to_owned(), _created: created, _lock: lock };
        claim.clear()?;
        Ok(claim)
    }

    /// Where unfinished files are.
    pub(crate) fn work(&self) -> PathBuf {
        work_folder(&self.dir)
    }

    /// Removes what an earlier process left unfinished.
    fn clear(&self) -> Result<(), Error> {
        let work = self.work();
        let failed = |reason| Error::io("remove", &work, reason);
        for entry in fs::read_dir(&work).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.is_dir() {
                fs::remove_dir_all(&path).map_err(failed)?;
            }
        }
        Ok(())
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // What cannot be removed now is removed by the next process that takes the folder.
        let _ = fs::remove_dir_all(self.work());
    }
}

fn work_folder(dir: &Path) -> PathBuf {
    dir.join(format!("{STAGING_PREFIX}work"))
}

/// Locks a file, until this process ends, however it ends. Where the file system knows no locks the
/// folder is taken on trust.
fn lock(dir: &Path, work: &Path) -> Result<File, Error> {
    let path = work.join("lock");
    let mut options = OpenOptions::new();
    options.create(true).truncate(false).write(true);
    let taken = || {
        Error::Refused(format!(
            "another process is writing into {}; wait for its end, or choose another folder with --out",
            dir.display()
        ))
    };
    let file = options.open(&path).map_err(|reason| unwritable(dir, &reason))?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(taken()),
        // Between opening and locking the process that had it may have removed it.
        _ if is_still(&file, &path) => Ok(file),
        _ => Err(taken()),
    }
}

#[cfg(unix)]
fn is_still(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(ours), Ok(there)) => (ours.dev(), ours.ino()) == (there.dev(), there.ino()),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_still(_file: &File, path: &Path) -> bool {
    path.exists()
}
