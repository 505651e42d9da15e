//! The tables of a single run, which are written into a hidden folder and moved into place when all of them
//! are complete. Earlier tables stay until then, and are moved back if the exchange fails.

use std::collections::BTreeMap;
use std::path::Path;

use arrow_array::RecordBatch;
use arrow_schema::SchemaRef;
use iva_sweep::identity::Identity;
use iva_sweep::study::{Study, Table};

use crate::claim::{Claim, end_exchange};
use crate::directory::Directory;
use crate::error::Error;
use crate::exchange;
use crate::folder::{
    MANIFEST_FILE, NEW, STUDY_FILE, errors_folder, part_name, refuse_conflicts, vanished,
};
use crate::hidden::{mark, remove_new_folder};
use crate::manifest::{Manifest, Part};
use crate::table_file::{Contents, Style, TableFile};

/// Name of the folder of the new result in the folder of unfinished files.
const STAGED: &str = "result";

/// A locked output folder, and the tables written for it so far.
#[derive(Debug)]
pub struct Output {
    overwrite: bool,
    style: Style,
    staged: Directory,
    tables: BTreeMap<String, Contents>,
    errors: BTreeMap<String, Contents>,
    /// Lock of the folder, which must drop after `staged`.
    claim: Claim,
}

impl Output {
    /// Locks the folder and checks that it can take the results, before anything is computed.
    ///
    /// # Errors
    /// [`Error::Folder`] if the folder holds tables (unless `overwrite`) or files that `iva` did not write under
    /// the names of a result, cannot be written, or is locked by another process.
    pub fn prepare(dir: &Path, overwrite: bool, style: Style) -> Result<Self, Error> {
        end_exchange(dir)?;
        refuse_conflicts(dir, overwrite)?;
        let claim = Claim::take(dir)?;
        // The contents may have changed before the folder was locked.
        refuse_conflicts(dir, overwrite)?;
        let staged = claim.work().make_folder(Path::new(STAGED))?;
        mark(&staged)?;
        let (tables, errors) = (BTreeMap::new(), BTreeMap::new());
        Ok(Self { overwrite, style, staged, tables, errors, claim })
    }

    /// Writes a table into the hidden folder; returns the size and checksum of its file.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be written.
    pub fn write_table(
        &mut self,
        table: Table,
        schema: SchemaRef,
        rows: &RecordBatch,
    ) -> Result<Contents, Error> {
        let contents = self.write(Path::new(table.name()), schema, rows)?;
        self.tables.insert(table.name().to_owned(), contents.clone());
        Ok(contents)
    }

    /// Writes the errors of a table into the hidden folder.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written.
    pub fn write_errors(
        &mut self,
        table: Table,
        schema: SchemaRef,
        rows: &RecordBatch,
    ) -> Result<(), Error> {
        let contents = self.write(&errors_folder(table.name()), schema, rows)?;
        self.errors.insert(table.name().to_owned(), contents);
        Ok(())
    }

    /// Writes rows as the only part of a table.
    fn write(
        &self,
        folder: &Path,
        schema: SchemaRef,
        rows: &RecordBatch,
    ) -> Result<Contents, Error> {
        self.is_there()?;
        let folder = self.staged.make_folder(folder)?;
        let name = part_name(0, self.style.format);
        let mut file = TableFile::create(&folder, Path::new(&name), schema, self.style)?;
        file.append(rows)?;
        file.finish()
    }

    /// Refuses to go on if the hidden folder was moved or removed.
    fn is_there(&self) -> Result<(), Error> {
        match self.staged.is_in_place() {
            true => Ok(()),
            false => Err(vanished(self.claim.dir().path())),
        }
    }

    /// Writes study and manifest, and replaces the earlier result by the new one. `text` is the resolved study,
    /// `failed` the number of runs with another outcome than `finished`.
    ///
    /// # Errors
    /// [`Error::NotMoved`] if tables have appeared in the folder meanwhile or a file cannot be moved;
    /// [`Error::Io`] if something cannot be written or the new tables are gone.
    pub fn commit(
        self,
        study: &Study,
        identity: Identity,
        text: &str,
        failed: u64,
    ) -> Result<(), Error> {
        self.is_there()?;
        let Self { overwrite, style, staged, tables, errors, claim } = self;
        let part = Part { first_point: 0, points: 1, failed, tables, errors };
        let manifest = Manifest::of_run(study, identity, style, part);
        staged.write_new(Path::new(STUDY_FILE), text.as_bytes())?;
        staged.write_new(Path::new(MANIFEST_FILE), manifest.text().as_bytes())?;
        let dir = claim.dir();
        let ready =
            refuse_conflicts(dir.path(), overwrite).and_then(|()| exchange::prepare(dir, &staged));
        let moved = remove_new_folder(dir)
            .and_then(|()| claim.work().rename(Path::new(STAGED), dir, Path::new(NEW)));
        match (ready, moved) {
            (Ok(()), Ok(())) => exchange::finish(dir),
            (Err(reason), Ok(())) => Err(Error::NotMoved {
                reason: Box::new(reason),
                what: "the new tables",
                kept: dir.path().join(NEW),
            }),
            (_, Err(reason)) => Err(reason),
        }
    }
}

#[cfg(test)]
mod tests;
