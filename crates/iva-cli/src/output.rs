//! The folder a run writes: its layout, staging, and the move into place.
//!
//! ```text
//! DIR/study.toml                       the resolved study
//! DIR/summary/part-00000.parquet       points 0 … 65535
//! DIR/summary/part-00001.parquet       points 65536 … 131071
//! DIR/impacts/part-00000.parquet       and so on, a folder for every table
//! DIR/errors/impacts/part-00000.parquet   of a verified run, again for every table
//! ```
//!
//! With another format the files end in `.arrow` or `.csv`.
//!
//! Everything is written into a hidden folder inside DIR first and moved into place when all of it
//! is complete. Tables of an earlier run are moved aside, not deleted, until then, and moved back
//! if anything fails. Files that `iva` did not write are never touched.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use iva_sweep::study::Table;
use tempfile::TempDir;

use crate::error::Error;
use crate::resolved::HEADER;
use crate::table_file::{Format, Style};

/// Points a part file covers: a constant, so that the files do not depend on the machine.
pub const PART_POINTS: u64 = 65_536;

const ERRORS: &str = "errors";
const STUDY_FILE: &str = "study.toml";
const STAGING_PREFIX: &str = ".iva-";

/// File name of a part.
pub fn part_name(part: u64, format: Format) -> String {
    format!("part-{part:05}.{format}")
}

/// An output folder that was found usable, with a staging area inside.
#[derive(Debug)]
pub struct Output {
    dir: PathBuf,
    overwrite: bool,
    style: Style,
    staging: TempDir,
    /// Files staged so far, relative to the folder.
    staged: Vec<PathBuf>,
    /// Removes the folders it made if they are still empty; after `staging` in drop order.
    _created: CreatedFolders,
}

impl Output {
    /// Checks that the folder can take the results, before anything is computed.
    ///
    /// # Errors
    /// [`Error::Refused`] if the folder holds tables (unless `overwrite`), holds a `study.toml`
    /// that is not `iva`'s own, or cannot be written.
    pub fn prepare(dir: &Path, overwrite: bool, style: Style) -> Result<Self, Error> {
        refuse_conflicts(dir, overwrite)?;
        let unwritable = |reason: io::Error| {
            Error::Refused(format!(
                "cannot write into the folder {}: {reason}; choose another one with --out",
                dir.display()
            ))
        };
        let created = CreatedFolders::create(dir).map_err(unwritable)?;
        let staging =
            tempfile::Builder::new().prefix(STAGING_PREFIX).tempdir_in(dir).map_err(unwritable)?;
        Ok(Self {
            dir: dir.to_owned(),
            overwrite,
            style,
            staging,
            staged: Vec::new(),
            _created: created,
        })
    }

    /// The folder.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// How its tables are written.
    pub fn style(&self) -> Style {
        self.style
    }

    /// Where to write a part of a table for now; the caller creates the file.
    ///
    /// # Errors
    /// [`Error::Io`] if its folder cannot be made.
    pub fn stage_part(&mut self, table: Table, part: u64) -> Result<PathBuf, Error> {
        self.stage(Path::new(table.name()).join(part_name(part, self.style.format)))
    }

    /// Where to write the errors of a table for now; the caller creates the file.
    ///
    /// # Errors
    /// [`Error::Io`] if its folder cannot be made.
    pub fn stage_errors(&mut self, table: Table) -> Result<PathBuf, Error> {
        self.stage(errors_folder(table).join(part_name(0, self.style.format)))
    }

    /// Removes what was staged of a part that will not be completed.
    ///
    /// # Errors
    /// [`Error::Io`] if a file cannot be removed.
    pub fn forget_part(&mut self, part: u64) -> Result<(), Error> {
        let name = part_name(part, self.style.format);
        let new = self.staging.path().join("new");
        let (unfinished, staged): (Vec<_>, Vec<_>) = std::mem::take(&mut self.staged)
            .into_iter()
            .partition(|path| path.file_name().is_some_and(|file| file == name.as_str()));
        self.staged = staged;
        unfinished.iter().map(|name| new.join(name)).try_for_each(|path| {
            match fs::remove_file(&path) {
                Err(reason) if reason.kind() != io::ErrorKind::NotFound => {
                    Err(Error::io("remove", &path, reason))
                }
                _ => Ok(()),
            }
        })
    }

    /// Number of parts staged.
    pub fn parts(&self) -> u64 {
        let names: BTreeSet<_> = self.staged.iter().filter_map(|path| path.file_name()).collect();
        names.iter().filter(|name| name.to_str().is_some_and(is_part)).count() as u64
    }

    /// True if a commit would replace tables of an earlier run.
    pub fn replaces_tables(&self) -> bool {
        holds_tables(&self.dir)
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
            return Err(self.vanished());
        }
        let path = self.staging.path().join("new").join(&name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|reason| Error::io("create", folder, reason))?;
        }
        self.staged.push(name);
        Ok(path)
    }

    fn vanished(&self) -> Error {
        let reason = io::Error::new(io::ErrorKind::NotFound, "the folder vanished during the run");
        Error::io("write", &self.dir, reason)
    }

    /// Moves everything into place: the earlier tables go aside, the new files come in, and on any
    /// failure each move is undone and the new files are kept where they were staged.
    ///
    /// # Errors
    /// [`Error::NotMoved`] if tables have appeared in the folder meanwhile or a file cannot be
    /// moved; [`Error::Io`] if the staged files are gone.
    pub fn commit(self) -> Result<(), Error> {
        if !self.staging.path().is_dir() {
            return Err(self.vanished());
        }
        let mut moves = Moves::default();
        let moved = refuse_conflicts(&self.dir, self.overwrite)
            .and_then(|()| self.move_all(&mut moves))
            .map_err(|reason| {
                let what = match moves.undo() {
                    Ok(()) => "the new tables",
                    Err(_) => "the new and the earlier tables",
                };
                (reason, what)
            });
        remove_empty_table_folders(&self.dir);
        // Better a leftover folder than lost tables.
        moved.map_err(|(reason, what)| Error::NotMoved {
            reason: Box::new(reason),
            what,
            kept: self.staging.keep(),
        })
    }

    fn move_all(&self, moves: &mut Moves) -> Result<(), Error> {
        let aside = self.staging.path().join("old");
        for name in written_by_iva(&self.dir) {
            moves.rename(&self.dir.join(&name), &aside.join(&name))?;
        }
        let new = self.staging.path().join("new");
        for name in &self.staged {
            moves.rename(&new.join(name), &self.dir.join(name))?;
        }
        Ok(())
    }
}

/// Renames done so far, so that they can be undone.
#[derive(Default)]
struct Moves(Vec<(PathBuf, PathBuf)>);

impl Moves {
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

    fn undo(self) -> io::Result<()> {
        self.0.into_iter().rev().try_for_each(|(from, to)| fs::rename(to, from))
    }
}

fn errors_folder(table: Table) -> PathBuf {
    Path::new(ERRORS).join(table.name())
}

/// The folders that tables go into, relative to that of the run.
fn table_folders() -> impl Iterator<Item = PathBuf> {
    let plain = Table::ALL.into_iter().map(|table| PathBuf::from(table.name()));
    plain.chain(Table::SWEEP.into_iter().map(errors_folder))
}

fn refuse_conflicts(dir: &Path, overwrite: bool) -> Result<(), Error> {
    let shown = dir.display();
    if dir.exists() && !dir.is_dir() {
        return Err(Error::Refused(format!(
            "the output folder {shown} is a file; choose another one with --out"
        )));
    }
    for folder in table_folders().chain([PathBuf::from(ERRORS)]) {
        let folder = dir.join(folder);
        if folder.exists() && !folder.is_dir() {
            return Err(Error::Refused(format!(
                "{} is a file where a folder of tables must go; move it or choose another folder \
                 with --out",
                folder.display()
            )));
        }
    }
    let study = dir.join(STUDY_FILE);
    if study.exists() && !is_resolved(&study) {
        return Err(Error::Refused(format!(
            "{} was not written by iva and would be replaced; move it or choose another folder \
             with --out",
            study.display()
        )));
    }
    if holds_tables(dir) && !overwrite {
        return Err(Error::Refused(format!(
            "the output folder {shown} already holds tables; choose another one with --out, or \
             give --overwrite to replace them"
        )));
    }
    Ok(())
}

fn holds_tables(dir: &Path) -> bool {
    written_by_iva(dir).iter().any(|name| name != Path::new(STUDY_FILE))
}

fn is_resolved(study: &Path) -> bool {
    fs::read(study).is_ok_and(|bytes| bytes.starts_with(HEADER.as_bytes()))
}

/// The files of an earlier run, relative to the folder, in a fixed order.
fn written_by_iva(dir: &Path) -> Vec<PathBuf> {
    let mut names = Vec::new();
    for folder in table_folders() {
        let Ok(entries) = fs::read_dir(dir.join(&folder)) else {
            continue;
        };
        let mut parts: Vec<PathBuf> = entries
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| is_part(name))
            .map(|name| folder.join(name))
            .collect();
        parts.sort();
        names.append(&mut parts);
    }
    if is_resolved(&dir.join(STUDY_FILE)) {
        names.push(PathBuf::from(STUDY_FILE));
    }
    names
}

fn is_part(name: &str) -> bool {
    name.strip_prefix("part-").and_then(|rest| rest.split_once('.')).is_some_and(
        |(digits, ending)| {
            digits.len() == 5
                && digits.bytes().all(|b| b.is_ascii_digit())
                && Format::ALL.iter().any(|format| format.name() == ending)
        },
    )
}

fn remove_empty_table_folders(dir: &Path) {
    for folder in table_folders().chain([PathBuf::from(ERRORS)]) {
        // Fails, as it should, where files are left.
        let _ = fs::remove_dir(dir.join(folder));
    }
}

/// Folders made for the output, removed again if nothing was put into them.
#[derive(Debug)]
struct CreatedFolders(Vec<PathBuf>);

impl CreatedFolders {
    fn create(dir: &Path) -> io::Result<Self> {
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

#[cfg(test)]
mod tests;
