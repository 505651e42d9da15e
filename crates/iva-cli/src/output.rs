//! The tables of a single run: written into a hidden folder inside DIR first, and moved into place when
//! all of it is complete. Tables of an earlier run are moved aside, not deleted, until then, and moved
//! back if anything fails.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use iva_sweep::study::Table;
use tempfile::TempDir;

use crate::claim::Claim;
use crate::error::Error;
use crate::folder::{
    STAGING_PREFIX, STUDY_FILE, errors_folder, part_name, refuse_conflicts,
    remove_empty_table_folders, unwritable, vanished,
};
use crate::moves::exchange;
use crate::table_file::Style;

/// An output folder that was found usable, with a staging area inside.
#[derive(Debug)]
pub struct Output {
    dir: PathBuf,
    overwrite: bool,
    style: Style,
    staging: TempDir,
    /// Files staged so far, relative to the folder.
    staged: Vec<PathBuf>,
    /// After `staging` in drop order.
    _claim: Claim,
}

impl Output {
    /// Checks that the folder can take the results, before anything is computed.
    ///
    /// # Errors
    /// [`Error::Refused`] if the folder holds tables (unless `overwrite`), holds a `study.toml`
    /// that is not `iva`'s own, or cannot be written.
    pub fn prepare(dir: &Path, overwrite: bool, style: Style) -> Result<Self, Error> {
        refuse_conflicts(dir, overwrite)?;
        let unwritable = |reason: io::Error| unwritable(dir, &reason);
        let claim = Claim::take(dir)?;
        refuse_conflicts(dir, overwrite)?;
        let staging =
            tempfile::Builder::new().prefix(STAGING_PREFIX).tempdir_in(dir).map_err(unwritable)?;
        Ok(Self {
            dir: dir.to_owned(),
            overwrite,
            style,
            staging,
            staged: Vec::new(),
            _claim: claim,
        })
    }

    /// How its tables are written.
    pub fn style(&self) -> Style {
        self.style
    }

    /// Where to write a table for now; the caller creates the file.
    ///
    /// # Errors
    /// [`Error::Io`] if its folder cannot be made.
    pub fn stage_table(&mut self, table: Table) -> Result<PathBuf, Error> {
        self.stage(Path::new(table.name()).join(part_name(0, self.style.format)))
    }

    /// Where to write the errors of a table for now; the caller creates the file.
    ///
    /// # Errors
    /// [`Error::Io`] if its folder cannot be made.
    pub fn stage_errors(&mut self, table: Table) -> Result<PathBuf, Error> {
        self.stage(errors_folder(table).join(part_name(0, self.style.format)))
    }

    /// Writes the resolved study, for now aside.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub fn stage_study(&mut self, text: &str) -> Result<(), Error> {
        let path = self.stage(PathBuf::from(STUDY_FILE))?;
        fs::write(&path, text)
            .and_then(|()| fs::File::open(&path)?.sync_all())
            .map_err(|reason| Error::io("write", &path, reason))
    }

    fn stage(&mut self, name: PathBuf) -> Result<PathBuf, Error> {
        if !self.staging.path().is_dir() {
            return Err(vanished(&self.dir));
        }
        let path = self.staging.path().join("new").join(&name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|reason| Error::io("create", folder, reason))?;
        }
        self.staged.push(name);
        Ok(path)
    }

    /// Moves everything into place: the earlier tables go aside, the new files come in, and on any
    /// failure each move is undone and the new files are kept where they were staged.
    ///
    /// # Errors
    /// [`Error::NotMoved`] if tables have appeared in the folder meanwhile or a file cannot be
    /// moved; [`Error::Io`] if the staged files are gone.
    pub fn commit(self) -> Result<(), Error> {
        if !self.staging.path().is_dir() {
            return Err(vanished(&self.dir));
        }
        let staging = self.staging.path();
        let moved = refuse_conflicts(&self.dir, self.overwrite)
            .map_err(|reason| (reason, "the new tables"))
            .and_then(|()| {
                exchange(&self.dir, &staging.join("new"), &self.staged, &staging.join("old"))
            });
        remove_empty_table_folders(&self.dir);
        // Better a leftover folder than lost tables.
        moved.map_err(|(reason, what)| Error::NotMoved {
            reason: Box::new(reason),
            what,
            kept: self.staging.keep(),
        })
    }
}

#[cfg(test)]
mod tests;
