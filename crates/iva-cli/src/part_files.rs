//! The files of one part, one for each table, as they are written.

use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use iva_sweep::identity::Identity;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::Tables;
use iva_sweep::tables::schema;
use serde::{Deserialize, Serialize};
use tempfile::TempDir;

use crate::error::Error;
use crate::manifest::sweep_tables;
use crate::table_file::{Contents, Style, TableFile, part_schema};

/// Files that are being written; removed unless they are finished.
pub struct PartFiles {
    // Closed before the folder is removed.
    files: Vec<(Table, PathBuf, TableFile)>,
    folder: TempDir,
    /// Points that failed.
    pub failed: u64,
}

/// Complete files of a part that are not in their place yet.
#[derive(Debug, Serialize, Deserialize)]
pub struct Staged {
    /// Version of the program that made them.
    pub iva: String,
    /// Where they are, by the name of the table.
    pub paths: BTreeMap<String, PathBuf>,
    /// What is in them, by the name of the table.
    pub contents: BTreeMap<String, Contents>,
    /// Points that failed.
    pub failed: u64,
    folder: PathBuf,
}

impl PartFiles {
    /// Makes the files in a folder of their own below `work`.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be made, [`Error::Invalid`] for a study without units.
    pub fn create(
        work: &Path,
        study: &Study,
        identity: Identity,
        points: Range<u64>,
        style: Style,
    ) -> Result<Self, Error> {
        let failed = |reason| Error::io("create", work, reason);
        let folder = tempfile::Builder::new().prefix("part-").tempdir_in(work).map_err(failed)?;
        let mut files = Vec::new();
        for table in sweep_tables(study) {
            let schema = part_schema(&*schema(study, table, identity)?, &points);
            let path = folder.path().join(format!("{table}.{}", style.format));
            let file = TableFile::create(&path, schema, style)?;
            files.push((table, path, file));
        }
        Ok(Self { folder, files, failed: 0 })
    }

    /// Appends rows.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written.
    pub fn append(&mut self, tables: &Tables) -> Result<(), Error> {
        for (table, _, file) in &mut self.files {
            if let Some(rows) = tables.get(table) {
                file.append(rows)?;
            }
        }
        Ok(())
    }

    /// Completes the files and sees them onto the disk.
    ///
    /// # Errors
    /// [`Error::Io`] if that fails.
    pub fn finish(self) -> Result<Staged, Error> {
        let mut paths = BTreeMap::new();
        let mut contents = BTreeMap::new();
        for (table, path, file) in self.files {
            contents.insert(table.name().to_owned(), file.finish()?);
            paths.insert(table.name().to_owned(), path);
        }
        let iva = env!("CARGO_PKG_VERSION").to_owned();
        Ok(Staged { iva, paths, contents, failed: self.failed, folder: self.folder.keep() })
    }
}

impl Staged {
    /// Removes the folder that held the files.
    pub(crate) fn remove_folder(&self) {
        // It is empty, and what remains of it is removed with all unfinished work.
        let _ = fs::remove_dir(&self.folder);
    }
}
