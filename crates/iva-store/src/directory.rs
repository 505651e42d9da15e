//! A folder accessed through an open handle.
//!
//! Names are resolved below the handle, one component at a time, and no symbolic link is followed. So
//! nothing outside the folder is written, moved or removed, whatever links the folder holds.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use cap_fs_ext::{DirExt, FollowSymlinks, OpenOptionsFollowExt, OpenOptionsSyncExt};
use cap_std::ambient_authority;
use cap_std::fs::{Dir, OpenOptions};

use crate::error::Error;

pub mod faults;
mod names;

use names::{absent_is_fine, components, is_absent, is_same};

/// Number of attempts to remove a folder that another process puts files into meanwhile.
const ATTEMPTS: u32 = 8;

/// An open folder.
#[derive(Debug)]
pub(crate) struct Directory {
    dir: Dir,
    /// Path at which the folder was opened, for messages.
    path: PathBuf,
}

/// Type of a directory entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// A symbolic link, whatever its target.
    Link,
    /// A pipe, a device or a socket.
    Other,
}

impl Directory {
    /// Opens a folder by a path from the user, in which links are followed.
    ///
    /// # Errors
    /// The error of the operating system.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let dir = Dir::open_ambient_dir(path, ambient_authority())?;
        Ok(Self { dir, path: path.to_owned() })
    }

    /// Opens a folder as [`Directory::open`] does; `None` if there is no such folder.
    ///
    /// # Errors
    /// [`Error::Io`] if it exists and cannot be opened.
    pub(crate) fn find(path: &Path) -> Result<Option<Self>, Error> {
        match Self::open(path) {
            Err(reason) if is_absent(&reason) => Ok(None),
            other => other.map(Some).map_err(|reason| Error::io("read", path, reason)),
        }
    }

    /// Path at which the folder was opened.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// True if the path at which the folder was opened still leads to it.
    pub(crate) fn is_in_place(&self) -> bool {
        match (self.dir.dir_metadata(), Self::open(&self.path).and_then(|it| it.dir.dir_metadata()))
        {
            (Ok(held), Ok(there)) => is_same(&held, &there),
            _ => false,
        }
    }

    /// Opens a folder below this one; `None` if there is none of that name.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be opened, or a component is not a folder.
    pub(crate) fn folder(&self, name: &Path) -> Result<Option<Self>, Error> {
        let mut found = self.itself()?;
        for component in components(self, name)? {
            match found.attempt("read", component, |dir| dir.open_dir_nofollow(component)) {
                Ok(dir) => found = Self { dir, path: found.path.join(component) },
                Err(Error::Io { source, .. }) if source.kind() == ErrorKind::NotFound => {
                    return Ok(None);
                }
                Err(other) => return Err(other),
            }
        }
        Ok(Some(found))
    }

    /// Creates a folder in this one; false if the name is in use already.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be created.
    pub(crate) fn make_absent_folder(&self, name: &Path) -> Result<bool, Error> {
        match self.attempt("create", name, |dir| dir.create_dir(name)) {
            Err(Error::Io { source, .. }) if source.kind() == ErrorKind::AlreadyExists => Ok(false),
            made => made.map(|()| true),
        }
    }

    /// Opens a folder below this one, which is created, with those on the way to it, if it is absent.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be created or opened.
    pub(crate) fn make_folder(&self, name: &Path) -> Result<Self, Error> {
        let mut found = self.itself()?;
        for component in components(self, name)? {
            let dir = found.attempt("create", component, |dir| {
                match dir.create_dir(component) {
                    Err(reason) if reason.kind() != ErrorKind::AlreadyExists => return Err(reason),
                    _ => {}
                }
                dir.open_dir_nofollow(component)
            })?;
            found = Self { dir, path: found.path.join(component) };
        }
        Ok(found)
    }

    /// Creates a folder of a new name, which is `begin`, a hyphen and a number.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be created.
    pub(crate) fn make_new_folder(&self, begin: &str) -> Result<(String, Self), Error> {
        for number in 0_u64.. {
            let name = format!("{begin}-{number}");
            let made = self.attempt("create", &name, |dir| {
                dir.create_dir(&name)?;
                dir.open_dir_nofollow(&name)
            });
            match made {
                Ok(dir) => return Ok((name.clone(), Self { dir, path: self.path.join(&name) })),
                Err(Error::Io { source, .. }) if source.kind() == ErrorKind::AlreadyExists => {}
                Err(other) => return Err(other),
            }
        }
        Err(Error::Internal("no number is left for a folder".to_owned()))
    }

    /// The type of the entry of a name; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read.
    pub(crate) fn kind(&self, name: &Path) -> Result<Option<Kind>, Error> {
        let Some((folder, leaf)) = self.above(name)? else { return Ok(None) };
        let found = folder.attempt("read", leaf, |dir| dir.symlink_metadata(leaf));
        let metadata = match found {
            Err(Error::Io { source, .. }) if is_absent(&source) => return Ok(None),
            other => other?,
        };
        Ok(Some(match metadata.file_type() {
            kind if kind.is_symlink() => Kind::Link,
            kind if kind.is_dir() => Kind::Folder,
            kind if kind.is_file() => Kind::File,
            _ => Kind::Other,
        }))
    }

    /// The names of the entries that are valid Unicode, sorted by length and then alphabetically.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be read.
    pub(crate) fn names(&self) -> Result<Vec<String>, Error> {
        let read = |dir: &Dir| -> io::Result<Vec<String>> {
            let mut names = Vec::new();
            for entry in dir.entries()? {
                names.extend(entry?.file_name().into_string());
            }
            names.sort_by_key(|name| (name.len(), name.clone()));
            Ok(names)
        };
        self.attempt("read", Path::new(""), read)
    }

    /// Opens a regular file for reading; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be opened, or is not a regular file.
    pub(crate) fn open_file(&self, name: &Path) -> Result<Option<File>, Error> {
        let Some((folder, leaf)) = self.above(name)? else { return Ok(None) };
        let found = folder.attempt("read", leaf, |dir| {
            let mut options = OpenOptions::new();
            // Without `nonblock` the opening of a pipe would wait for a writer.
            options.read(true).follow(FollowSymlinks::No).nonblock(true);
            let file = dir.open_with(leaf, &options)?.into_std();
            match file.metadata()?.is_file() {
                true => Ok(file),
                false => Err(io::Error::other("it is not a regular file")),
            }
        });
        match found {
            Err(Error::Io { source, .. }) if is_absent(&source) => Ok(None),
            other => other.map(Some),
        }
    }

    /// The bytes of a regular file; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read, or has more than `limit` bytes.
    pub(crate) fn read(&self, name: &Path, limit: u64) -> Result<Option<Vec<u8>>, Error> {
        let Some(file) = self.open_file(name)? else { return Ok(None) };
        self.attempt("read", name, |_| {
            let mut bytes = Vec::new();
            if file.take(limit + 1).read_to_end(&mut bytes)? as u64 > limit {
                return Err(io::Error::other(format!("it has more than {limit} bytes")));
            }
            Ok(Some(bytes))
        })
    }

    /// Creates a file in an existing folder.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be created, or the name is in use.
    pub(crate) fn create_file(&self, name: &Path) -> Result<File, Error> {
        let mut options = OpenOptions::new();
        options.write(true).create_new(true).follow(FollowSymlinks::No);
        self.open_with(name, &options)
    }

    /// Opens a file for reading and writing, which is created in its existing folder if it is absent.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be opened or created.
    pub(crate) fn open_or_create_file(&self, name: &Path) -> Result<File, Error> {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).follow(FollowSymlinks::No).nonblock(true);
        self.open_with(name, &options)
    }

    /// Opens a file in an existing folder with the given options.
    fn open_with(&self, name: &Path, options: &OpenOptions) -> Result<File, Error> {
        let Some((folder, leaf)) = self.above(name)? else {
            return Err(Error::io("create", &self.path.join(name), ErrorKind::NotFound.into()));
        };
        folder.attempt("create", leaf, |dir| Ok(dir.open_with(leaf, options)?.into_std()))
    }

    /// Creates a file with the given bytes and syncs it.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written, or the name is in use.
    pub(crate) fn write_new(&self, name: &Path, bytes: &[u8]) -> Result<(), Error> {
        let mut file = self.create_file(name)?;
        self.attempt("write", name, |_| file.write_all(bytes).and_then(|()| file.sync_all()))
    }

    /// Moves a file or folder to the unused name `new` in the folder `to`; missing folders are created.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be moved, or the new name is in use.
    pub(crate) fn rename(&self, name: &Path, to: &Self, new: &Path) -> Result<(), Error> {
        if to.kind(new)?.is_some() {
            // On some systems a rename would silently replace the entry.
            return Err(Error::io("write", &to.path.join(new), ErrorKind::AlreadyExists.into()));
        }
        self.replace(name, to, new)
    }

    /// Moves a file to the name `new` in the folder `to`, where it replaces a file of that name. Of a link the
    /// link itself is replaced, not its target.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be moved.
    pub(crate) fn replace(&self, name: &Path, to: &Self, new: &Path) -> Result<(), Error> {
        let Some((from, leaf)) = self.above(name)? else {
            return Err(Error::io("write", &self.path.join(name), ErrorKind::NotFound.into()));
        };
        let target = match new.parent() {
            Some(parent) => to.make_folder(parent)?,
            None => to.itself()?,
        };
        let new = new.file_name().unwrap_or_default();
        target.attempt("write", new, |dir| from.dir.rename(leaf, dir, new))
    }

    /// Removes a file or a link, not its target; the absence of the file is not an error.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be removed.
    pub(crate) fn remove_file(&self, name: &Path) -> Result<(), Error> {
        let Some((folder, leaf)) = self.above(name)? else { return Ok(()) };
        absent_is_fine(folder.attempt("remove", leaf, |dir| dir.remove_file_or_symlink(leaf)))
    }

    /// Removes a folder with its contents; links in it are removed, not followed. The absence of the folder is
    /// not an error.
    ///
    /// # Errors
    /// [`Error::Io`] if something cannot be removed.
    pub(crate) fn remove_folder(&self, name: &Path) -> Result<(), Error> {
        let Some((folder, leaf)) = self.above(name)? else { return Ok(()) };
        let remove = || folder.attempt("remove", leaf, |dir| dir.remove_dir_all(leaf));
        for _ in 1..ATTEMPTS {
            match remove() {
                // Another process has just put a file into it.
                Err(Error::Io { source, .. }) if source.kind() == ErrorKind::DirectoryNotEmpty => {}
                other => return absent_is_fine(other),
            }
        }
        absent_is_fine(remove())
    }

    /// Removes a folder if it is empty.
    pub(crate) fn remove_if_empty(&self, name: &Path) {
        if let Ok(Some((folder, leaf))) = self.above(name) {
            // The call fails for a folder that is not empty, as intended.
            let _ = folder.attempt("remove", leaf, |dir| dir.remove_dir(leaf));
        }
    }

    /// Syncs the directory entries of the folder.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be synced.
    pub(crate) fn sync(&self) -> Result<(), Error> {
        // Other systems do not sync folders, and keep a rename without it.
        if !cfg!(unix) {
            return Ok(());
        }
        self.attempt("write", Path::new(""), |dir| {
            // The handle itself may have been opened for path lookups only.
            match dir.open(".")?.into_std().sync_all() {
                // Some network file systems cannot sync folders.
                Err(reason)
                    if matches!(
                        reason.kind(),
                        ErrorKind::InvalidInput | ErrorKind::Unsupported
                    ) =>
                {
                    Ok(())
                }
                other => other,
            }
        })
    }

    /// Another handle of the same folder.
    ///
    /// # Errors
    /// [`Error::Io`] if the system cannot duplicate the handle.
    pub(crate) fn itself(&self) -> Result<Self, Error> {
        let dir = self.dir.try_clone().map_err(|reason| Error::io("read", &self.path, reason))?;
        Ok(Self { dir, path: self.path.clone() })
    }

    /// The parent folder of a name and its last component; `None` if there is no such folder.
    fn above<'a>(&self, name: &'a Path) -> Result<Option<(Self, &'a OsStr)>, Error> {
        let mut names = components(self, name)?;
        let leaf = names.pop().unwrap_or_default();
        let parent: PathBuf = names.iter().collect();
        Ok(self.folder(&parent)?.map(|folder| (folder, leaf)))
    }

    /// Calls the system for a name in the folder, with the error turned into [`Error::Io`]; tests make such calls
    /// fail.
    fn attempt<T>(
        &self,
        action: &'static str,
        name: impl AsRef<Path>,
        act: impl FnOnce(&Dir) -> io::Result<T>,
    ) -> Result<T, Error> {
        let name = name.as_ref();
        faults::next(&self.path).and_then(|()| act(&self.dir)).map_err(|reason| {
            // Joining an empty name would add a separator.
            let path = if name == Path::new("") { self.path.clone() } else { self.path.join(name) };
            // The system's own message for a link is "too many levels of symbolic links".
            let is_link = || self.dir.symlink_metadata(name).is_ok_and(|it| it.is_symlink());
            match reason.kind() {
                ErrorKind::NotFound | ErrorKind::AlreadyExists => Error::io(action, &path, reason),
                _ if is_link() => {
                    Error::io(action, &path, io::Error::other("it is a symbolic link"))
                }
                _ => Error::io(action, &path, reason),
            }
        })
    }
}

#[cfg(test)]
mod tests;
