//! The folder of a result: its layout, and what in it is ours.
//!
//! ```text
//! DIR/study.toml                       the resolved study
//! DIR/manifest.json                    of a sweep: what it is, and which parts are complete
//! DIR/summary/part-00000.parquet       the first points
//! DIR/summary/part-00001.parquet       the next ones
//! DIR/impacts/part-00000.parquet       and so on, a folder for every table
//! DIR/inputs/points.parquet            points and records of a sweep made in Python
//! DIR/errors/impacts/part-00000.parquet   of a verified run, again for every table
//! ```
//!
//! With another format the files of tables end in `.arrow` or `.csv`. Files that `iva` did not write are
//! never touched.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use iva_sweep::study::Table;

use crate::error::Error;
use crate::inputs::INPUTS;
use crate::manifest::Manifest;
use crate::resolved::HEADER;
use crate::table_file::Format;

/// The resolved study.
pub(crate) const STUDY_FILE: &str = "study.toml";
/// What a sweep says of itself.
pub(crate) const MANIFEST_FILE: &str = "manifest.json";
/// How every manifest begins.
const MANIFEST_BEGIN: &str = "{\n  \"manifest\": ";
/// Begin of the names of folders that hold unfinished work.
pub(crate) const STAGING_PREFIX: &str = ".iva-";
const ERRORS: &str = "errors";

/// File name of a part.
pub(crate) fn part_name(part: u64, format: Format) -> String {
    format!("part-{part:05}.{format}")
}

/// The folder of a table's errors, relative to that of the result.
pub(crate) fn errors_folder(table: Table) -> PathBuf {
    Path::new(ERRORS).join(table.name())
}

/// What is said of a folder that went while it was written into.
pub(crate) fn vanished(dir: &Path) -> Error {
    let reason = io::Error::new(io::ErrorKind::NotFound, "the folder vanished during the run");
    Error::io("write", dir, reason)
}

/// What is said of a folder that cannot be written into.
pub(crate) fn unwritable(dir: &Path, reason: &io::Error) -> Error {
    Error::Refused(format!(
        "cannot write into the folder {}: {reason}; choose another one with --out",
        dir.display()
    ))
}

/// The folders that tables go into, relative to that of the run.
fn table_folders() -> impl Iterator<Item = PathBuf> {
    let plain = Table::ALL.into_iter().map(|table| PathBuf::from(table.name()));
    plain.chain(Table::SWEEP.into_iter().map(errors_folder))
}

/// Checks that a folder can take new results, as far as that shows from what it holds.
///
/// # Errors
/// [`Error::Refused`] if it holds tables (unless `overwrite`), or a file that is not `iva`'s where one of
/// its own must go.
pub(crate) fn refuse_conflicts(dir: &Path, overwrite: bool) -> Result<(), Error> {
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
    let manifest = dir.join(MANIFEST_FILE);
    if manifest.exists() && !is_manifest(&manifest) {
        return Err(Error::Refused(format!(
            "{} is no manifest of a sweep and would be replaced; move it or choose another folder \
             with --out",
            manifest.display()
        )));
    }
    if holds_tables(dir) && !overwrite {
        return Err(Error::Refused(format!(
            "the output folder {shown} already holds tables; choose another one with --out, or \
             give --overwrite to replace them{}",
            if is_interrupted(dir) {
                ", or --resume to go on with the sweep that wrote them"
            } else {
                ""
            }
        )));
    }
    Ok(())
}

/// True if there are tables in a folder.
pub(crate) fn holds_tables(dir: &Path) -> bool {
    !parts_in(dir).is_empty()
}

/// The text of a folder's manifest, if it has one.
///
/// # Errors
/// [`Error::Io`] if it is there and cannot be read.
pub(crate) fn manifest_text(dir: &Path) -> Result<Option<String>, Error> {
    let path = dir.join(MANIFEST_FILE);
    match fs::read(&path) {
        Ok(bytes) => Ok(Some(String::from_utf8_lossy(&bytes).into_owned())),
        Err(reason) if reason.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(reason) => Err(Error::io("read", &path, reason)),
    }
}

/// The files of points and records that the manifest of a folder lists, as far as they are there.
pub(crate) fn inputs_of(dir: &Path) -> Vec<PathBuf> {
    let text = manifest_text(dir).ok().flatten();
    let manifest = text.and_then(|text| Manifest::parse(&text).ok());
    let names = manifest.into_iter().flat_map(|manifest| manifest.inputs).map(PathBuf::from);
    names.filter(|name| name.starts_with(INPUTS) && dir.join(name).is_file()).collect()
}

fn is_interrupted(dir: &Path) -> bool {
    let text = manifest_text(dir).ok().flatten();
    text.and_then(|text| Manifest::parse(&text).ok()).is_some_and(|it| !it.is_complete())
}

/// True of any text that begins like a manifest: also of one of another version, or cut off.
fn is_manifest(path: &Path) -> bool {
    fs::read(path).is_ok_and(|bytes| bytes.starts_with(MANIFEST_BEGIN.as_bytes()))
}

fn is_resolved(study: &Path) -> bool {
    fs::read(study).is_ok_and(|bytes| bytes.starts_with(HEADER.as_bytes()))
}

/// The part files in a folder, relative to it, in a fixed order.
pub(crate) fn parts_in(dir: &Path) -> Vec<PathBuf> {
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
        parts.sort_by_key(|name| (name.as_os_str().len(), name.clone()));
        names.append(&mut parts);
    }
    names
}

/// The files of an earlier run, relative to the folder, in a fixed order: what they are told by last.
pub(crate) fn written_by_iva(dir: &Path) -> Vec<PathBuf> {
    let mut names = parts_in(dir);
    names.extend(inputs_of(dir));
    if is_manifest(&dir.join(MANIFEST_FILE)) {
        names.push(PathBuf::from(MANIFEST_FILE));
    }
    if is_resolved(&dir.join(STUDY_FILE)) {
        names.push(PathBuf::from(STUDY_FILE));
    }
    names
}

pub(crate) fn is_part(name: &str) -> bool {
    name.strip_prefix("part-").and_then(|rest| rest.split_once('.')).is_some_and(
        |(digits, ending)| {
            digits.len() >= 5
                && digits.bytes().all(|b| b.is_ascii_digit())
                && Format::ALL.iter().any(|format| format.name() == ending)
        },
    )
}

/// Removes the folders of tables that hold nothing.
pub(crate) fn remove_empty_table_folders(dir: &Path) {
    for folder in table_folders().chain([ERRORS, INPUTS].map(PathBuf::from)) {
        // Fails, as it should, where files are left.
        let _ = fs::remove_dir(dir.join(folder));
    }
}
