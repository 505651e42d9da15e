//! A folder held by a handle.
//!
//! Names are resolved below the handle, one component at a time, and no symbolic link is followed. So
//! whatever a folder from elsewhere holds, nothing outside it is written, moved or removed through it.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use cap_fs_ext::{DirExt, FollowSymlinks, OpenOptionsFollowExt, OpenOptionsSyncExt};
use cap_std::ambient_authority;
use cap_std::fs::{Dir, OpenOptions};

use crate::error::Error;

#[cfg(any(test, feature = "faults"))]
pub mod faults;
mod names;

use names::{absent_is_fine, components, is_absent, is_same};

/// How often a folder is emptied that another process puts files into meanwhile.
const ATTEMPTS: u32 = 8;

/// An open folder.
#[derive(Debug)]
pub(crate) struct Directory {
    dir: Dir,
    /// Where it was opened, for messages.
    path: PathBuf,
}

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// A symbolic link, whatever it points to.
    Link,
    /// A pipe, a device, a socket.
    Other,
}

impl Directory {
    /// Opens a folder that the user named; links on the way to it are the user's own.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let dir = Dir::open_ambient_dir(path, ambient_authority())?;
        Ok(Self { dir, path: path.to_owned() })
    }

    /// As [`Directory::open`]; `None` if there is no such folder.
    ///
    /// # Errors
    /// [`Error::Io`] if it is there and cannot be opened.
    pub(crate) fn find(path: &Path) -> Result<Option<Self>, Error> {
        match Self::open(path) {
            Err(reason) if is_absent(&reason) => Ok(None),
            other => other.map(Some).map_err(|reason| Error::io("read", path, reason)),
        }
    }

    /// Where it was opened.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// True if the folder still is where it was opened.
    pub(crate) fn is_in_place(&self) -> bool {
        match (self.dir.dir_metadata(), Self::open(&self.path).and_then(|it| it.dir.dir_metadata()))
        {
            (Ok(held), Ok(there)) => is_same(&held, &there),
            _ => false,
        }
    }

    /// The folder of that name; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be opened, or a component is no folder.
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

    /// Makes a folder in this one; false if something of that name is there already.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be made.
    pub(crate) fn make_absent_folder(&self, name: &Path) -> Result<bool, Error> {
        match self.attempt("create", name, |dir| dir.create_dir(name)) {
            Err(Error::Io { source, .. }) if source.kind() == ErrorKind::AlreadyExists => Ok(false),
            made => made.map(|()| true),
        }
    }

    /// The folder of that name, made if there is none.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be made or opened.
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

    /// Makes a folder of a name that begins as said and that no other folder has.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be made.
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

    /// What stands under a name; `None`: nothing.
    ///
    /// # Errors
    /// [`Error::Io`] if that cannot be found out.
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

    /// The names in it that are text, sorted by length and then by letters.
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

    /// Opens a regular file; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be opened, or is no regular file.
    pub(crate) fn open_file(&self, name: &Path) -> Result<Option<File>, Error> {
        let Some((folder, leaf)) = self.above(name)? else { return Ok(None) };
        let found = folder.attempt("read", leaf, |dir| {
            let mut options = OpenOptions::new();
            // A pipe without a writer would be waited for.
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

    /// Makes a file; its folder is there.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be made, or something of that name is there.
    pub(crate) fn create_file(&self, name: &Path) -> Result<File, Error> {
        let mut options = OpenOptions::new();
        options.write(true).create_new(true).follow(FollowSymlinks::No);
        self.open_with(name, &options)
    }

    /// Opens a file for writing with what is in it, or makes it; its folder is there.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be opened or made.
    pub(crate) fn open_or_create_file(&self, name: &Path) -> Result<File, Error> {
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).follow(FollowSymlinks::No).nonblock(true);
        self.open_with(name, &options)
    }

    fn open_with(&self, name: &Path, options: &OpenOptions) -> Result<File, Error> {
        let Some((folder, leaf)) = self.above(name)? else {
            return Err(Error::io("create", &self.path.join(name), ErrorKind::NotFound.into()));
        };
        folder.attempt("create", leaf, |dir| Ok(dir.open_with(leaf, options)?.into_std()))
    }

    /// Makes a file of some bytes and sees them onto the disk.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written, or something of that name is there.
    pub(crate) fn write_new(&self, name: &Path, bytes: &[u8]) -> Result<(), Error> {
        let mut file = self.create_file(name)?;
        self.attempt("write", name, |_| file.write_all(bytes).and_then(|()| file.sync_all()))
    }

    /// Moves a file or folder to another folder under a name that is free; folders on the way are made.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be moved, or something of that name is there.
    pub(crate) fn rename(&self, name: &Path, to: &Self, new: &Path) -> Result<(), Error> {
        if to.kind(new)?.is_some() {
            // A rename would silently replace it on some systems.
            return Err(Error::io("write", &to.path.join(new), ErrorKind::AlreadyExists.into()));
        }
        self.replace(name, to, new)
    }

    /// Moves a file to another folder, in the place of a file of that name if there is one. What is
    /// replaced is the name: if it was a link, the file that it points to stays as it is.
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

    /// Removes a file, or a link itself; it is no fault if there is none.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be removed.
    pub(crate) fn remove_file(&self, name: &Path) -> Result<(), Error> {
        let Some((folder, leaf)) = self.above(name)? else { return Ok(()) };
        absent_is_fine(folder.attempt("remove", leaf, |dir| dir.remove_file_or_symlink(leaf)))
    }

    /// Removes a folder with all that is in it; links in it are removed, not followed. It is no fault if
    /// there is none.
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

    /// Removes a folder if nothing is in it.
    pub(crate) fn remove_if_empty(&self, name: &Path) {
        if let Ok(Some((folder, leaf))) = self.above(name) {
            // Fails, as it should, where files are left.
            let _ = folder.attempt("remove", leaf, |dir| dir.remove_dir(leaf));
        }
    }

    /// Sees the names in it onto the disk.
    ///
    /// # Errors
    /// [`Error::Io`] if that fails.
    pub(crate) fn sync(&self) -> Result<(), Error> {
        // Elsewhere folders cannot be synced, and a rename lasts by itself.
        if !cfg!(unix) {
            return Ok(());
        }
        self.attempt("write", Path::new(""), |dir| {
            // The handle itself may be one that only finds names.
            match dir.open(".")?.into_std().sync_all() {
                // Some file systems of the network know no such thing.
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
    /// [`Error::Io`] if the system gives none.
    pub(crate) fn itself(&self) -> Result<Self, Error> {
        let dir = self.dir.try_clone().map_err(|reason| Error::io("read", &self.path, reason))?;
        Ok(Self { dir, path: self.path.clone() })
    }

    /// The folder that a name is in and its last component; `None` if there is no such folder.
    fn above<'a>(&self, name: &'a Path) -> Result<Option<(Self, &'a OsStr)>, Error> {
        let mut names = components(self, name)?;
        let leaf = names.pop().unwrap_or_default();
        let parent: PathBuf = names.iter().collect();
        Ok(self.folder(&parent)?.map(|folder| (folder, leaf)))
    }

    /// Every call of the system that concerns a name goes through here.
    fn attempt<T>(
        &self,
        action: &'static str,
        name: impl AsRef<Path>,
        act: impl FnOnce(&Dir) -> io::Result<T>,
    ) -> Result<T, Error> {
        let name = name.as_ref();
        #[cfg(any(test, feature = "faults"))]
        let act = |dir: &Dir| faults::next(&self.path).and_then(|()| act(dir));
        act(&self.dir).map_err(|reason| {
            // Joining an empty name would add a separator.
            let path = if name == Path::new("") { self.path.clone() } else { self.path.join(name) };
            // The system's own word for it is "too many levels".
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
