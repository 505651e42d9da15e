//! A complete result takes the place of an earlier one, file by file, so that it can be ended or undone
//! whatever happens in between.
//!
//! The new result lies in `.iva-new` below the folder. What is to be moved is first written into a
//! journal there; then the earlier files go to `.iva-new/earlier`, the manifest last; then the new
//! ones come, the manifest first, so that at any instant a reader finds one result, or one of which
//! files are missing, and never a part of one that looks whole. Then the journal is renamed, which is the
//! moment from which the new result counts, and `.iva-new` is removed.
//!
//! A process that is killed leaves the journal, and the next command that writes into the folder goes on
//! from it: forth, if every new file is still there, else back. Which moves are done shows from where the
//! files are, so going on twice does no harm.

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

/// What is to be moved.
const JOURNAL: &str = "exchange.json";
/// The journal of an exchange of which every move is done.
const DONE: &str = "exchanged.json";
/// Where the earlier files are until the end.
const EARLIER: &str = "earlier";
/// Most bytes of a journal that are read.
const LIMIT: u64 = 1 << 30;
/// Version of the journal's layout.
const VERSION: u32 = 1;

/// The names of the files that are moved, relative to the folder of the result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct Journal {
    exchange: u32,
    /// Of the earlier result, in the order in which they go.
    out: Vec<PathBuf>,
    /// Of the new result, in the order in which they come.
    #[serde(rename = "in")]
    into: Vec<PathBuf>,
}

/// Writes the journal of an exchange into the folder of the new result, which need not be in its place
/// yet. Nothing is moved.
///
/// # Errors
/// [`Error::Folder`] if a file that is not ours stands where a new one must go; [`Error::Io`] if a folder
/// cannot be read or the journal not written.
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
    // Strings alone: there is nothing in it that JSON cannot say.
    let text = serde_json::to_vec(&journal).unwrap_or_default();
    let aside = Path::new("exchange");
    new.remove_file(aside)?;
    new.write_new(aside, &text)?;
    new.replace(aside, new, Path::new(JOURNAL))?;
    new.sync()
}

/// True if there is a journal of an exchange that was not ended.
///
/// # Errors
/// [`Error::Io`] if that cannot be found out.
pub(crate) fn is_begun(dir: &Directory) -> Result<bool, Error> {
    let journal = Path::new(NEW).join(JOURNAL);
    Ok(dir.kind(Path::new(NEW))? == Some(Kind::Folder) && dir.kind(&journal)?.is_some())
}

/// Does what the journal in `.iva-new` says, as far as it is not done. Without a journal there is nothing
/// to do; a `.iva-new` in which nothing was kept is removed.
///
/// # Errors
/// [`Error::NotMoved`] if a file cannot be moved; what was moved is moved back then, as far as that can be.
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

fn set(names: &[PathBuf]) -> HashSet<&Path> {
    names.iter().map(PathBuf::as_path).collect()
}

/// Reads a journal.
///
/// # Errors
/// [`Error::Folder`] if it says what none of this program says.
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
    fn earlier(name: &Path) -> PathBuf {
        Path::new(EARLIER).join(name)
    }

    fn is_new(&self, name: &Path) -> Result<bool, Error> {
        Ok(self.new.kind(name)?.is_some())
    }

    fn is_aside(&self, name: &Path) -> Result<bool, Error> {
        self.is_new(&Self::earlier(name))
    }

    fn is_here(&self, name: &Path) -> Result<bool, Error> {
        Ok(self.dir.kind(name)?.is_some())
    }

    /// True if a new file has come: it is here, not with the others, and the earlier one of its name, if
    /// there was one, is aside.
    fn has_come(&self, name: &Path) -> Result<bool, Error> {
        let replaces = self.goes.contains(name);
        Ok(self.is_here(name)? && !self.is_new(name)? && (!replaces || self.is_aside(name)?))
    }

    fn can_go_forth(&self) -> Result<bool, Error> {
        for name in &self.journal.into {
            if !self.is_new(name)? && !self.has_come(name)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Moves what is not moved yet, and ends the exchange.
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

    /// Moves everything back to where it was, and forgets the exchange; the new files stay in `.iva-new`.
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

    /// Sees every folder that a file went from or came to onto the disk.
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

/// Removes `.iva-new`.
fn clear(dir: &Directory) {
    // What cannot be removed now is removed by the next command that writes into the folder.
    let _ = remove_new_folder(dir);
}
