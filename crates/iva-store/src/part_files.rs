//! The files of one part while they are written, one for each table.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use iva_sweep::identity::Identity;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::Tables;
use iva_sweep::tables::schema;
use serde::{Deserialize, Serialize};

use crate::directory::Directory;
use crate::error::Error;
use crate::manifest::sweep_tables;
use crate::table_file::{Contents, Format, Style, TableFile, part_schema};

/// The open files of a part, which are removed on drop unless they are finished.
pub struct PartFiles {
    // Fields drop in this order: the files are closed before their folder is removed.
    files: Vec<(Table, TableFile)>,
    folder: Unfinished,
    /// Number of points with another outcome than `finished`.
    pub failed: u64,
}

/// The report of complete files of a part that are not in their final place yet.
#[derive(Debug, Serialize, Deserialize)]
pub struct Staged {
    /// Version of the program that wrote the files.
    pub iva: String,
    /// Name of the folder of the files, in the folder of unfinished files.
    pub folder: String,
    /// Sizes and checksums of the files, by the name of the table.
    pub contents: BTreeMap<String, Contents>,
    /// Number of points with another outcome than `finished`.
    pub failed: u64,
}

/// The folder of the files of a part, which is removed on drop with its contents unless it is kept.
struct Unfinished {
    work: Directory,
    name: String,
    kept: bool,
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if !self.kept {
            // The rest is removed with all unfinished files.
            let _ = self.work.remove_folder(Path::new(&self.name));
        }
    }
}

/// Name of the file of a table in the folder of an unfinished part.
pub(crate) fn staged_name(table: &str, format: Format) -> PathBuf {
    PathBuf::from(format!("{table}.{format}"))
}

impl PartFiles {
    /// Creates the files in a new folder in `work`, a path from the user or from the process that divides the
    /// sweep.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be created, [`Error::Invalid`] for a study without units.
    pub fn create_in(
        work: &Path,
        study: &Study,
        identity: Identity,
        points: Range<u64>,
        style: Style,
    ) -> Result<Self, Error> {
        let work = Directory::open(work).map_err(|reason| Error::io("create", work, reason))?;
        Self::create(&work, study, identity, points, style)
    }

    /// Creates the files in a new folder in the open folder `work`.
    ///
    /// # Errors
    /// As [`PartFiles::create_in`].
    pub(crate) fn create(
        work: &Directory,
        study: &Study,
        identity: Identity,
        points: Range<u64>,
        style: Style,
    ) -> Result<Self, Error> {
        let (name, folder) = work.make_new_folder(&format!("part-of-{}", points.start))?;
        let kept = Unfinished { work: work.itself()?, name, kept: false };
        let mut files = Vec::new();
        for table in sweep_tables(study) {
            let schema = part_schema(&*schema(study, table, identity)?, &points);
            let name = staged_name(table.name(), style.format);
            files.push((table, TableFile::create(&folder, &name, schema, style)?));
        }
        Ok(Self { folder: kept, files, failed: 0 })
    }

    /// Appends the rows of each table to its file.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written.
    pub fn append(&mut self, tables: &Tables) -> Result<(), Error> {
        for (table, file) in &mut self.files {
            if let Some(rows) = tables.get(table) {
                file.append(rows)?;
            }
        }
        Ok(())
    }

    /// Completes, syncs and closes the files, and keeps them.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be written.
    pub fn finish(self) -> Result<Staged, Error> {
        let Self { files, mut folder, failed } = self;
        let mut contents = BTreeMap::new();
        for (table, file) in files {
            contents.insert(table.name().to_owned(), file.finish()?);
        }
        folder.kept = true;
        let iva = env!("CARGO_PKG_VERSION").to_owned();
        Ok(Staged { iva, folder: folder.name.clone(), contents, failed })
    }
}
