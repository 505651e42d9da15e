//! The folder of a result: its layout, and the recognition of files that the program wrote.
//!
//! ```text
//! DIR/study.toml                       the resolved study
//! DIR/manifest.json                    what the result is, and which parts are complete
//! DIR/summary/part-00000.parquet       the first points
//! DIR/summary/part-00001.parquet       the next ones
//! DIR/impacts/part-00000.parquet       and so on, a folder for every table
//! DIR/inputs/points.parquet            points and records of a sweep made in Python
//! DIR/errors/impacts/part-00000.parquet   of a verified run, again for every table
//! DIR/.iva-work/                       unfinished files while a command runs
//! DIR/.iva-new/                        new tables until they take the place of earlier ones
//! ```
//!
//! With another format the files of tables end in `.arrow` or `.csv`. A file counts as one of the program's if
//! the manifest lists it or its content shows it, never by its name alone. Other files stay as they are; a
//! command that would replace one is refused.

use std::collections::HashSet;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use iva_sweep::columns::columns;
use iva_sweep::study::Table;

use crate::directory::{Directory, Kind};
use crate::error::Error;
use crate::fault::Fault;
use crate::inputs::{INPUTS, is_input_name};
use crate::manifest::Manifest;
use crate::remedy::Remedy;
use crate::table_file::Format;

/// Beginning of every resolved study; a `study.toml` without it is a file of the user.
pub const HEADER: &str = "# Resolved by iva-dynamics";
/// Name of the file of the resolved study.
pub const STUDY_FILE: &str = "study.toml";
/// Name of the file of the manifest.
pub const MANIFEST_FILE: &str = "manifest.json";
/// Name of the hidden folder of unfinished files.
pub(crate) const WORK: &str = ".iva-work";
/// Name of the hidden folder of a result that is to replace the one in the folder.
pub(crate) const NEW: &str = ".iva-new";
/// Largest size of a manifest in bytes.
const MANIFEST_LIMIT: u64 = 1 << 30;
/// Largest size of a resolved study in bytes.
const STUDY_LIMIT: u64 = 1 << 26;
/// Beginning of every manifest.
const MANIFEST_BEGIN: &[u8] = b"{\n  \"manifest\": ";
/// Metadata key in the footer of every Parquet and Arrow file of the program.
const TABLE_MARK: &[u8] = b"iva.schema_version";
/// Number of bytes at the end of a file in which the key is searched for.
const FOOTER: u64 = 1 << 20;
/// Name of the folder of the errors of a verified run.
const ERRORS: &str = "errors";

/// Name of the file of a part.
pub(crate) fn part_name(part: u64, format: Format) -> String {
    format!("part-{part:05}.{format}")
}

/// Folder of the errors of a table, relative to that of the result.
pub(crate) fn errors_folder(table: &str) -> PathBuf {
    Path::new(ERRORS).join(table)
}

/// The error for a folder that vanished while results were written into it.
pub(crate) fn vanished(dir: &Path) -> Error {
    let reason = io::Error::new(io::ErrorKind::NotFound, "the folder vanished during the run");
    Error::io("write", dir, reason)
}

/// The error for a folder that cannot be written into.
pub(crate) fn unwritable(dir: &Path, reason: io::Error) -> Error {
    Error::folder(Fault::Unwritable { dir: dir.to_owned(), reason }, Remedy::OtherFolder)
}

/// The folders of tables and of their errors, relative to that of the result, each with its table.
fn table_folders() -> impl Iterator<Item = (PathBuf, Table)> {
    let plain = Table::ALL.into_iter().map(|table| (PathBuf::from(table.name()), table));
    plain.chain(Table::SWEEP.into_iter().map(|table| (errors_folder(table.name()), table)))
}

/// Checks from the contents of a folder that it can take new results.
///
/// # Errors
/// [`Error::Folder`] if it holds tables (unless `replace`), or a symbolic link or a file that `iva` did not
/// write under a name of a result; [`Error::Io`] if it cannot be read.
pub(crate) fn refuse_conflicts(dir: &Path, replace: bool) -> Result<(), Error> {
    if dir.exists() && !dir.is_dir() {
        return Err(Error::folder(Fault::IsFile(dir.to_owned()), Remedy::OtherFolder));
    }
    let Some(dir) = Directory::find(dir)? else { return Ok(()) };
    refuse_other_kinds(&dir)?;
    if study_text(&dir)?.is_some_and(|text| !text.starts_with(HEADER)) {
        return Err(in_the_way(&dir, Path::new(STUDY_FILE), "was not written by iva"));
    }
    if manifest_bytes(&dir)?.is_some_and(|bytes| !bytes.starts_with(MANIFEST_BEGIN)) {
        return Err(in_the_way(&dir, Path::new(MANIFEST_FILE), "is no manifest of a result"));
    }
    let parts = parts_in(&dir)?;
    if replace {
        let ours = ours_of(&dir, &parts)?;
        if let Some(other) = parts.iter().find(|(name, _)| !ours.contains(name)) {
            return Err(in_the_way(&dir, &other.0, "was not written by iva"));
        }
    } else if !parts.is_empty() {
        let unfinished = manifest(&dir)?.is_some_and(|it| !it.is_complete());
        let remedy = match unfinished {
            true => Remedy::OtherFolderReplaceOrGoOn,
            false => Remedy::OtherFolderOrReplace,
        };
        return Err(Error::folder(Fault::HoldsTables(dir.path().to_owned()), remedy));
    }
    Ok(())
}

/// The error for a file that the program did not write and would replace.
pub(crate) fn in_the_way(dir: &Directory, name: &Path, what: &'static str) -> Error {
    let fault = Fault::InTheWay { path: dir.path().join(name), what };
    Error::folder(fault, Remedy::MoveOrOtherFolder)
}

/// Refuses entries of the wrong type: links, files under names of folders, and folders under names of files.
fn refuse_other_kinds(dir: &Directory) -> Result<(), Error> {
    let check = |name: &Path, wanted: Kind| {
        let what = match dir.kind(name)? {
            None => return Ok(()),
            Some(found) if found == wanted => return Ok(()),
            Some(Kind::Link) => "is a symbolic link, and iva writes through none",
            Some(Kind::Folder) => "is a folder where a file must go",
            Some(_) if wanted == Kind::File => "is not a regular file",
            Some(_) => "is a file where a folder must go",
        };
        let fault = Fault::OtherKind { path: dir.path().join(name), what };
        Err(Error::folder(fault, Remedy::MoveOrOtherFolder))
    };
    // Outer folders come first, so that names are looked up only in entries known to be folders.
    for folder in [ERRORS, INPUTS, WORK, NEW] {
        check(Path::new(folder), Kind::Folder)?;
    }
    table_folders().try_for_each(|(folder, _)| check(&folder, Kind::Folder))?;
    for file in [STUDY_FILE, MANIFEST_FILE] {
        check(Path::new(file), Kind::File)?;
    }
    inputs_in(dir)?.iter().try_for_each(|input| check(input, Kind::File))
}

/// The entries with names of inputs, relative to the folder.
fn inputs_in(dir: &Directory) -> Result<Vec<PathBuf>, Error> {
    // The caller has refused a link of that name.
    let Some(folder) = dir.folder(Path::new(INPUTS))? else { return Ok(Vec::new()) };
    let names = folder.names()?.into_iter().map(|name| format!("{INPUTS}/{name}"));
    Ok(names.filter(|name| is_input_name(name)).map(PathBuf::from).collect())
}

/// True if a folder holds parts of tables.
///
/// # Errors
/// [`Error::Io`] if it cannot be read.
pub(crate) fn holds_tables(dir: &Directory) -> Result<bool, Error> {
    Ok(!parts_in(dir)?.is_empty())
}

/// The bytes of a folder's manifest, if it has one.
fn manifest_bytes(dir: &Directory) -> Result<Option<Vec<u8>>, Error> {
    dir.read(Path::new(MANIFEST_FILE), MANIFEST_LIMIT)
}

/// The text of a folder's manifest, if it has one.
///
/// # Errors
/// [`Error::Io`] if it exists and cannot be read.
pub(crate) fn manifest_text(dir: &Directory) -> Result<Option<String>, Error> {
    Ok(manifest_bytes(dir)?.map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
}

/// The manifest of a folder, if it has a valid one.
///
/// # Errors
/// [`Error::Io`] if it exists and cannot be read.
pub(crate) fn manifest(dir: &Directory) -> Result<Option<Manifest>, Error> {
    Ok(manifest_text(dir)?.and_then(|text| Manifest::parse(&text).ok()))
}

/// The text of `study.toml` in a folder, if it has one.
///
/// # Errors
/// [`Error::Io`] if it exists and cannot be read.
pub(crate) fn study_text(dir: &Directory) -> Result<Option<String>, Error> {
    let bytes = dir.read(Path::new(STUDY_FILE), STUDY_LIMIT)?;
    Ok(bytes.map(|bytes| String::from_utf8_lossy(&bytes).into_owned()))
}

/// The files of points and records that the manifest of a folder lists and that exist.
///
/// # Errors
/// [`Error::Io`] if the folder cannot be read.
pub(crate) fn inputs_of(dir: &Directory) -> Result<Vec<PathBuf>, Error> {
    let listed = manifest(dir)?.map_or_else(Vec::new, |manifest| manifest.inputs);
    let mut found = Vec::new();
    for name in listed.into_iter().map(PathBuf::from) {
        if dir.kind(&name)? == Some(Kind::File) {
            found.push(name);
        }
    }
    Ok(found)
}

/// The entries with names of parts, relative to the folder, each with its table, in a fixed order.
fn parts_in(dir: &Directory) -> Result<Vec<(PathBuf, Table)>, Error> {
    let mut parts = Vec::new();
    for (folder, table) in table_folders() {
        if let Some(found) = dir.folder(&folder)? {
            let names = found.names()?.into_iter().filter(|name| is_part(name));
            parts.extend(names.map(|name| (folder.join(name), table)));
        }
    }
    Ok(parts)
}

/// The parts in a folder that the program wrote, relative to it, in a fixed order.
///
/// # Errors
/// [`Error::Io`] if it cannot be read.
pub(crate) fn our_parts(dir: &Directory) -> Result<Vec<PathBuf>, Error> {
    ours_of(dir, &parts_in(dir)?)
}

/// Those of the entries `parts` that the program wrote.
fn ours_of(dir: &Directory, parts: &[(PathBuf, Table)]) -> Result<Vec<PathBuf>, Error> {
    if parts.is_empty() {
        return Ok(Vec::new());
    }
    let manifest = manifest(dir)?;
    let listed: HashSet<PathBuf> =
        manifest.iter().flat_map(Manifest::files).map(|(name, _)| name).collect();
    let mut ours = Vec::new();
    for (name, table) in parts {
        if dir.kind(name)? == Some(Kind::File)
            && (listed.contains(name) || is_table(dir, name, *table)?)
        {
            ours.push(name.clone());
        }
    }
    Ok(ours)
}

/// True if the content of a file shows a table of the program: of Parquet and Arrow the footer, of CSV the
/// first line.
fn is_table(dir: &Directory, name: &Path, table: Table) -> Result<bool, Error> {
    let Some(mut file) = dir.open_file(name)? else { return Ok(false) };
    let csv = name.extension().is_some_and(|ending| ending == Format::Csv.name());
    let read = || -> io::Result<bool> {
        if csv {
            let mut line = Vec::new();
            BufReader::new(file.take(FOOTER)).read_until(b'\n', &mut line)?;
            let line = String::from_utf8_lossy(&line);
            let mut names = line.trim_end().split(',');
            let first = columns(table).first().map(|column| column.name);
            return Ok(names.next() == Some("point") && names.any(|name| Some(name) == first));
        }
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(FOOTER)))?;
        let mut end = Vec::new();
        file.take(FOOTER).read_to_end(&mut end)?;
        Ok(end.windows(TABLE_MARK.len()).any(|bytes| bytes == TABLE_MARK))
    };
    read().map_err(|reason| Error::io("read", &dir.path().join(name), reason))
}

/// The files of a result, relative to the folder, in a fixed order: tables, inputs, study, manifest.
///
/// # Errors
/// [`Error::Io`] if the folder cannot be read.
pub(crate) fn written_by_iva(dir: &Directory) -> Result<Vec<PathBuf>, Error> {
    let mut names = our_parts(dir)?;
    names.extend(inputs_of(dir)?);
    if study_text(dir)?.is_some_and(|text| text.starts_with(HEADER)) {
        names.push(PathBuf::from(STUDY_FILE));
    }
    if manifest_bytes(dir)?.is_some_and(|bytes| bytes.starts_with(MANIFEST_BEGIN)) {
        names.push(PathBuf::from(MANIFEST_FILE));
    }
    Ok(names)
}

/// True if a file of a result can have this name, relative to its folder.
pub(crate) fn is_result_name(name: &Path) -> bool {
    let text = name.to_str().unwrap_or_default();
    let parent = name.parent().unwrap_or(Path::new(""));
    let leaf = name.file_name().and_then(|leaf| leaf.to_str()).unwrap_or_default();
    text == STUDY_FILE
        || text == MANIFEST_FILE
        || is_input_name(text)
        || is_part(leaf) && table_folders().any(|(folder, _)| folder == parent)
}

/// True if a file of a part can have this name.
pub(crate) fn is_part(name: &str) -> bool {
    name.strip_prefix("part-").and_then(|rest| rest.split_once('.')).is_some_and(
        |(digits, ending)| {
            digits.len() >= 5
                && digits.bytes().all(|b| b.is_ascii_digit())
                && Format::ALL.iter().any(|format| format.name() == ending)
        },
    )
}

/// Removes the empty ones among the folders of tables, errors and inputs.
pub(crate) fn remove_empty_table_folders(dir: &Directory) {
    let folders = table_folders().map(|(folder, _)| folder);
    for folder in folders.chain([ERRORS, INPUTS].map(PathBuf::from)) {
        dir.remove_if_empty(&folder);
    }
}
