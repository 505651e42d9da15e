//! The files of one part, one for each table, as they are written.

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

/// Files that are being written; removed unless they are finished.
pub struct PartFiles {
    // Closed before the folder is removed.
    files: Vec<(Table, TableFile)>,
    folder: Unfinished,
    /// Points that failed.
    pub failed: u64,
}

/// Complete files of a part that are not in their place yet.
#[derive(Debug, Serialize, Deserialize)]
pub struct Staged {
    /// Version of the program that made them.
    pub iva: String,
    /// The name of their folder, in the folder of unfinished files.
    pub folder: String,
    /// What is in them, by the name of the table.
    pub contents: BTreeMap<String, Contents>,
    /// Points that failed.
    pub failed: u64,
}

/// A folder of unfinished files, removed with all that is in it unless it is kept.
struct Unfinished {
    work: Directory,
    name: String,
    kept: bool,
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if !self.kept {
            // What cannot be removed now is removed with all unfinished files.
            let _ = self.work.remove_folder(Path::new(&self.name));
        }
    }
}

/// File name of a table of a part that is not in its place yet.
pub(crate) fn staged_name(table: &str, format: Format) -> PathBuf {
    PathBuf::from(format!("{table}.{format}"))
}

impl PartFiles {
    /// Makes the files in a folder of their own below `work`, a folder that the user or the process that
    /// divides the sweep named.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be made, [`Error::Invalid`] for a study without units.
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

    /// As [`PartFiles::create_in`], in an open folder.
    ///
    /// # Errors
    /// As there.
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

    /// Appends rows.
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

    /// Completes the files and sees them onto the disk.
    ///
    /// # Errors
    /// [`Error::Io`] if that fails.
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
