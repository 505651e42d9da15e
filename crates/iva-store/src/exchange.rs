//! Exchange of an earlier result for a new one, file by file and with a journal, so that after an interruption
//! it can be completed or undone.
//!
//! The new result is in `.iva-new` in the folder. A journal there lists the files to be moved; then the earlier
//! files are moved to `.iva-new/earlier`, the manifest last, and the new ones into place, the manifest first.
//! So at any instant a reader finds a whole result, or one whose manifest lists missing files, and never a part
//! that looks whole. The renaming of the journal makes the new result valid; then `.iva-new` is removed.
//!
//! A process that is killed leaves the journal, from which the next command that writes into the folder
//! completes the exchange if every new file is still there, and undoes it otherwise. The places of the files
//! show which moves are done, so both can be repeated.

use std::collections::HashSet;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::directory::{Directory, Kind};
use crate::error::Error;
use crate::fault::Fault;
use crate::folder::{
    MANIFEST_FILE, NEW, in_the_way, is_result_name, manifest, remove_empty_table_folders,
    written_by_iva,
};
use crate::hidden::{new_folder, remove_new_folder};
use crate::remedy::Remedy;

/// Name of the journal of an exchange under way.
const JOURNAL: &str = "exchange.json";
/// Name of the journal of an exchange whose moves are all done.
const DONE: &str = "exchanged.json";
/// Name of the folder of the earlier files during an exchange.
const EARLIER: &str = "earlier";
/// Largest size of a journal in bytes.
const LIMIT: u64 = 1 << 30;
/// Version of the journal's layout.
const VERSION: u32 = 1;

/// The names of the files that are moved, relative to the folder of the result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Journal {
    /// Version of the journal's layout.
    exchange: u32,
    /// Files of the earlier result, in the order in which they are moved away.
    out: Vec<PathBuf>,
    /// Files of the new result, in the order in which they are moved into place.
    #[serde(rename = "in")]
    into: Vec<PathBuf>,
}

/// Writes the journal of an exchange into the folder of the new result, which need not be `.iva-new` yet.
/// Nothing is moved.
///
/// # Errors
/// [`Error::Folder`] if a file that `iva` did not write has the name of a new one; [`Error::Io`] if a folder
/// cannot be read, a new file is missing or the journal cannot be written.
pub(crate) fn prepare(dir: &Directory, new: &Directory) -> Result<(), Error> {
    let out = written_by_iva(dir)?;
    let mut into = written_by_iva(new)?;
    into.sort_by_key(|name| name != Path::new(MANIFEST_FILE));
    let (goes, comes): (HashSet<_>, HashSet<_>) = (out.iter().collect(), into.iter().collect());
    if let Some((lost, _)) =
        manifest(new)?.iter().flat_map(|it| it.files()).find(|(name, _)| !comes.contains(name))
    {
        return Err(Error::io("read", &new.path().join(lost), io::ErrorKind::NotFound.into()));
    }
    for name in &into {
        if !goes.contains(name) && dir.kind(name)?.is_some() {
            return Err(in_the_way(dir, name, "was not written by iva"));
        }
    }
    let journal = Journal { exchange: VERSION, out, into };
    // A number and strings are valid in JSON, so this cannot fail.
    let text = serde_json::to_vec(&journal).unwrap_or_default();
    let aside = Path::new("exchange");
    new.remove_file(aside)?;
    new.write_new(aside, &text)?;
    new.replace(aside, new, Path::new(JOURNAL))?;
    new.sync()
}

/// True if there is the journal of an exchange under way.
///
/// # Errors
/// [`Error::Io`] if the folder cannot be read.
pub(crate) fn is_begun(dir: &Directory) -> Result<bool, Error> {
    let journal = Path::new(NEW).join(JOURNAL);
    Ok(dir.kind(Path::new(NEW))? == Some(Kind::Folder) && dir.kind(&journal)?.is_some())
}

/// Completes the exchange of the journal in `.iva-new`, or undoes it if new files are missing. Without a
/// journal nothing is moved, and a `.iva-new` that holds no unfinished sweep is removed.
///
/// # Errors
/// [`Error::NotMoved`] if a file cannot be moved, after the moved ones are moved back where possible;
/// [`Error::Folder`] for an invalid journal.
pub(crate) fn finish(dir: &Directory) -> Result<(), Error> {
    let Some(new) = new_folder(dir)? else { return Ok(()) };
    let is_there = |name: &str| Ok::<_, Error>(new.kind(Path::new(name))?.is_some());
    let Some(bytes) = new.read(Path::new(JOURNAL), LIMIT)? else {
        if is_there(DONE)? || !is_there(MANIFEST_FILE)? {
            clear(dir);
        }
        return Ok(());
    };
    let journal = parse(&new, &bytes)?;
    let exchange = Exchange {
        dir,
        new: &new,
        journal: &journal,
        goes: set(&journal.out),
        comes: set(&journal.into),
    };
    let moved = match exchange.can_go_forth()? {
        true => exchange.forth().map_err(|reason| (reason, exchange.back())),
        false => return exchange.back(),
    };
    moved.map_err(|(reason, undone)| Error::NotMoved {
        reason: Box::new(reason),
        what: if undone.is_ok() { "the new tables" } else { "the new and the earlier tables" },
        kept: dir.path().join(NEW),
    })
}

/// The names as a set.
fn set(names: &[PathBuf]) -> HashSet<&Path> {
    names.iter().map(PathBuf::as_path).collect()
}

/// Reads the bytes of a journal.
///
/// # Errors
/// [`Error::Folder`] for another layout, or a name that no file of a result has.
fn parse(new: &Directory, bytes: &[u8]) -> Result<Journal, Error> {
    let refused =
        || Error::folder(Fault::BadJournal(new.path().join(JOURNAL)), Remedy::MoveOrOtherFolder);
    let journal: Journal = serde_json::from_slice(bytes).map_err(|_| refused())?;
    let mut names = journal.out.iter().chain(&journal.into);
    match journal.exchange == VERSION && names.all(|name| is_result_name(name)) {
        true => Ok(journal),
        false => Err(refused()),
    }
}

/// An exchange under way.
struct Exchange<'a> {
    dir: &'a Directory,
    new: &'a Directory,
    journal: &'a Journal,
    goes: HashSet<&'a Path>,
    comes: HashSet<&'a Path>,
}

impl Exchange<'_> {
    /// The name of an earlier file that is moved away, relative to `.iva-new`.
    fn earlier(name: &Path) -> PathBuf {
        Path::new(EARLIER).join(name)
    }

    /// True if `.iva-new` holds a file of that name.
    fn is_new(&self, name: &Path) -> Result<bool, Error> {
        Ok(self.new.kind(name)?.is_some())
    }

    /// True if the earlier file of that name is moved away.
    fn is_aside(&self, name: &Path) -> Result<bool, Error> {
        self.is_new(&Self::earlier(name))
    }

    /// True if the folder of the result holds a file of that name.
    fn is_here(&self, name: &Path) -> Result<bool, Error> {
        Ok(self.dir.kind(name)?.is_some())
    }

    /// True if a new file is moved into place: the folder of the result holds the name, `.iva-new` does not, and
    /// the earlier file of the name, if there was one, is moved away.
    fn has_come(&self, name: &Path) -> Result<bool, Error> {
        let replaces = self.goes.contains(name);
        Ok(self.is_here(name)? && !self.is_new(name)? && (!replaces || self.is_aside(name)?))
    }

    /// True if every new file is in `.iva-new` or in place.
    fn can_go_forth(&self) -> Result<bool, Error> {
        for name in &self.journal.into {
            if !self.is_new(name)? && !self.has_come(name)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Makes the remaining moves and completes the exchange.
    fn forth(&self) -> Result<(), Error> {
        let Self { dir, new, journal, .. } = self;
        for name in &journal.out {
            let has_come = self.comes.contains(name.as_path()) && !self.is_new(name)?;
            if !has_come && !self.is_aside(name)? && self.is_here(name)? {
                dir.rename(name, new, &Self::earlier(name))?;
            }
        }
        for name in &journal.into {
            if self.is_new(name)? {
                new.rename(name, dir, name)?;
            }
        }
        self.sync()?;
        new.replace(Path::new(JOURNAL), new, Path::new(DONE))?;
        remove_empty_table_folders(dir);
        clear(dir);
        Ok(())
    }

    /// Undoes the moves and removes the journal; the new files stay in `.iva-new`.
    fn back(&self) -> Result<(), Error> {
        let Self { dir, new, journal, .. } = self;
        for name in journal.into.iter().rev() {
            if self.has_come(name)? {
                dir.rename(name, new, name)?;
            }
        }
        for name in journal.out.iter().rev() {
            if self.is_aside(name)? {
                new.rename(&Self::earlier(name), dir, name)?;
            }
        }
        self.sync()?;
        remove_empty_table_folders(dir);
        new.remove_file(Path::new(JOURNAL))?;
        new.remove_folder(Path::new(EARLIER))
    }

    /// Syncs every folder from which or into which a file is moved.
    fn sync(&self) -> Result<(), Error> {
        let mut folders: Vec<&Path> = self
            .journal
            .out
            .iter()
            .chain(&self.journal.into)
            .filter_map(|it| it.parent())
            .collect();
        folders.sort_unstable();
        folders.dedup();
        for folder in folders {
            for found in [self.dir.folder(folder)?, self.new.folder(&Self::earlier(folder))?] {
                found.map_or(Ok(()), |it| it.sync())?;
            }
        }
        self.new.sync()
    }
}

/// Removes `.iva-new` as far as possible.
fn clear(dir: &Directory) {
    // The next command that writes into the folder removes the rest.
    let _ = remove_new_folder(dir);
}
