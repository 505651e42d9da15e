//! Moving files and making folders so that it can be undone.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::error::Error;
use crate::folder::{
    STAGING_PREFIX, manifest_text, part_name, remove_empty_table_folders, written_by_iva,
};
use crate::manifest::Manifest;

/// Where a sweep gathers that is to replace earlier tables.
pub(crate) fn beside(dir: &Path) -> PathBuf {
    dir.join(format!("{STAGING_PREFIX}new"))
}

/// Where the earlier tables are while new ones take their place.
fn aside(new: &Path) -> PathBuf {
    new.join("earlier")
}

/// Puts a complete sweep in the place of earlier tables.
///
/// # Errors
/// [`Error::NotMoved`] if a file cannot be moved.
pub(crate) fn put_in_place(dir: &Path, names: &[PathBuf]) -> Result<(), Error> {
    let new = beside(dir);
    match exchange(dir, &new, names, &aside(&new)) {
        Ok(()) => {
            for folder in names.iter().filter_map(|name| name.parent()) {
                sync_folder(&dir.join(folder)).map_err(|reason| Error::io("write", dir, reason))?;
            }
            remove_empty_table_folders(dir);
            remove_folder(&new)
        }
        Err((reason, what)) => Err(Error::NotMoved { reason: Box::new(reason), what, kept: new }),
    }
}

/// Ends what [`put_in_place`] began in a process that was killed: back, if the earlier tables were still
/// going out, forth, if the new ones were coming in.
///
/// # Errors
/// [`Error::Io`] if a file cannot be moved.
pub(crate) fn finish_exchange(dir: &Path) -> Result<(), Error> {
    let new = beside(dir);
    let aside = aside(&new);
    if !aside.is_dir() {
        return Ok(());
    }
    let manifest = manifest_text(&new)?.and_then(|text| Manifest::parse(&text).ok());
    let all_there = manifest.is_some_and(|manifest| {
        let format = manifest.style.format;
        manifest.parts.iter().all(|(number, part)| {
            part.tables
                .keys()
                .all(|table| new.join(table).join(part_name(*number, format)).exists())
        })
    });
    let from = if all_there { &aside } else { &new };
    let mut moves = Moves::default();
    for name in written_by_iva(from) {
        moves.rename(&from.join(&name), &dir.join(&name))?;
    }
    remove_folder(from)
}

/// Removes a folder with all that is in it, if it is there.
///
/// # Errors
/// [`Error::Io`] if it cannot be removed.
pub(crate) fn remove_folder(dir: &Path) -> Result<(), Error> {
    match fs::remove_dir_all(dir) {
        Err(reason) if reason.kind() != io::ErrorKind::NotFound => {
            Err(Error::io("remove", dir, reason))
        }
        _ => Ok(()),
    }
}

/// Sees the names in a folder onto the disk.
///
/// # Errors
/// What the system says.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    // Elsewhere folders cannot be opened, and a rename lasts by itself.
    if !cfg!(unix) {
        return Ok(());
    }
    match fs::File::open(folder)?.sync_all() {
        // Some file systems of the network know no such thing.
        Err(reason)
            if matches!(
                reason.kind(),
                io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        other => other,
    }
}

/// Moves the tables of a folder aside and new ones in; on a failure every move is undone.
///
/// # Errors
/// Why it failed, and which tables are not in their place then.
pub(crate) fn exchange(
    dir: &Path,
    new: &Path,
    names: &[PathBuf],
    aside: &Path,
) -> Result<(), (Error, &'static str)> {
    let mut moves = Moves::default();
    let earlier = written_by_iva(dir);
    let out = earlier.iter().try_for_each(|name| moves.rename(&dir.join(name), &aside.join(name)));
    out.and_then(|()| {
        names.iter().try_for_each(|name| moves.rename(&new.join(name), &dir.join(name)))
    })
    .map_err(|reason| match moves.undo() {
        Ok(()) => (reason, "the new tables"),
        Err(_) => (reason, "the new and the earlier tables"),
    })
}

/// Renames done so far, so that they can be undone.
#[derive(Default)]
struct Moves(Vec<(PathBuf, PathBuf)>);

impl Moves {
    /// Moves a file; its new folder is made.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be moved, or there is one already.
    fn rename(&mut self, from: &Path, to: &Path) -> Result<(), Error> {
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder).map_err(|reason| Error::io("create", folder, reason))?;
        }
        if to.exists() {
            // A rename would silently replace it on some systems.
            let reason = io::Error::from(io::ErrorKind::AlreadyExists);
            return Err(Error::io("write", to, reason));
        }
        fs::rename(from, to).map_err(|reason| Error::io("write", to, reason))?;
        self.0.push((from.to_owned(), to.to_owned()));
        Ok(())
    }

    /// Moves everything back.
    ///
    /// # Errors
    /// The first that cannot be.
    fn undo(self) -> io::Result<()> {
        self.0.into_iter().rev().try_for_each(|(from, to)| fs::rename(to, from))
    }
}

/// Folders made for the output, removed again if nothing was put into them.
#[derive(Debug, Default)]
pub(crate) struct CreatedFolders(Vec<PathBuf>);

impl CreatedFolders {
    /// Makes a folder and those above it.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn create(dir: &Path) -> io::Result<Self> {
        let mut missing: Vec<PathBuf> = dir
            .ancestors()
            .take_while(|path| !path.as_os_str().is_empty() && !path.exists())
            .map(Path::to_owned)
            .collect();
        missing.reverse();
        let created = Self(missing);
        fs::create_dir_all(dir)?;
        Ok(created)
    }
}

impl Drop for CreatedFolders {
    fn drop(&mut self) {
        for folder in self.0.iter().rev() {
            // Fails, as it should, for a folder that holds something.
            let _ = fs::remove_dir(folder);
        }
    }
}
