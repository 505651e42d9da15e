//! The folder of a sweep: parts are written aside, synced, renamed into place and then entered in the
//! manifest, so that at any instant everything that the manifest lists is there and complete.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use iva_sweep::study::Study;

use crate::changes::changes;
use crate::claim::Claim;
use crate::error::Error;
use crate::folder::{
    MANIFEST_FILE, STUDY_FILE, inputs_of, manifest_text, part_name, parts_in,
    remove_empty_table_folders, unwritable, vanished, written_by_iva,
};
use crate::inputs::Input;
use crate::manifest::{Manifest, Part};
use crate::moves::sync_folder;
use crate::part_files::{PartFiles, Staged};
use crate::table_file::Style;

/// Parts up to which the manifest is written after every one of them.
const FEW_PARTS: usize = 256;

/// A folder that a sweep fills part by part.
#[derive(Debug)]
pub struct SweepFolder {
    root: PathBuf,
    manifest: Manifest,
    /// Of the folder of the result, which `root` is or is in.
    claim: Claim,
    written: Written,
}

/// When the manifest was last written, how long that took, and if something was entered since.
#[derive(Debug)]
struct Written {
    at: Instant,
    took: Duration,
    stale: bool,
}

/// A folder with a sweep to go on with, and the files of it that are not what they should be.
pub(crate) type Resumed = (SweepFolder, Vec<String>);

impl SweepFolder {
    fn new(root: &Path, manifest: Manifest, claim: Claim) -> Self {
        let written = Written { at: Instant::now(), took: Duration::ZERO, stale: false };
        Self { root: root.to_owned(), manifest, claim, written }
    }

    /// Begins a sweep in a folder without tables.
    ///
    /// # Errors
    /// [`Error::Refused`] if a file that is not `iva`'s stands where an input must go; [`Error::Io`] if
    /// something cannot be written.
    pub(crate) fn begin(
        root: &Path,
        claim: Claim,
        mut manifest: Manifest,
        study: &str,
        inputs: &[Input],
    ) -> Result<Self, Error> {
        fs::create_dir_all(root).map_err(|reason| unwritable(root, &reason))?;
        let known = inputs_of(root);
        for input in inputs {
            let path = root.join(input.name());
            if path.exists() && !known.iter().any(|name| name == Path::new(input.name())) {
                return Err(Error::Refused(format!(
                    "{} was not written by iva and would be replaced; move it or choose another folder \
                     with --out",
                    path.display()
                )));
            }
        }
        manifest.inputs = inputs.iter().map(|input| input.name().to_owned()).collect();
        let mut folder = Self::new(root, manifest, claim);
        let ready = folder.write_manifest().and_then(|()| folder.write_study(study, inputs));
        match ready {
            Ok(()) => Ok(folder),
            Err(reason) => {
                // The first reason is the one to tell.
                let _ = folder.close();
                Err(reason)
            }
        }
    }

    /// Goes on with the sweep of a folder whose manifest is that of the same sweep. Parts that are not
    /// what the manifest says are taken out of it, to be computed again. Parts that are `elsewhere` are
    /// taken on trust. `None`: `go_on` returned false, and nothing was changed.
    ///
    /// # Errors
    /// [`Error::Io`] if a part is there and cannot be read, or something cannot be written.
    pub(crate) fn resume(
        root: &Path,
        claim: Claim,
        manifest: Manifest,
        (study, inputs): (&str, &[Input]),
        elsewhere: bool,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Option<Resumed>, Error> {
        let mut folder = Self::new(root, manifest, claim);
        let bad = match elsewhere {
            true => Some(Vec::new()),
            false => folder.drop_bad_parts(go_on)?,
        };
        let Some(bad) = bad else { return Ok(None) };
        if !bad.is_empty() {
            folder.write_manifest()?;
        }
        folder.write_study(study, inputs)?;
        folder.remove_unlisted()?;
        Ok(Some((folder, bad)))
    }

    /// What is complete.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Opens the files of a part, aside.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be made.
    pub fn stage(&self, study: &Study, part: u64) -> Result<PartFiles, Error> {
        if !self.root.is_dir() {
            return Err(vanished(&self.root));
        }
        let plan = self.manifest.plan();
        let identity = self.manifest.identity();
        PartFiles::create(&self.work(), study, identity, plan.range(part), self.style())
    }

    /// Where unfinished files go.
    pub fn work(&self) -> PathBuf {
        self.claim.work()
    }

    /// How tables are written.
    pub fn style(&self) -> Style {
        self.manifest.style
    }

    /// Moves the complete files of a part into place and enters it in the manifest.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be moved.
    pub fn take(&mut self, part: u64, staged: Staged) -> Result<(), Error> {
        if !self.root.is_dir() {
            return Err(vanished(&self.root));
        }
        let name = part_name(part, self.style().format);
        for (table, from) in &staged.paths {
            let folder = self.root.join(table);
            let failed = |reason| Error::io("write", &folder, reason);
            match fs::create_dir(&folder) {
                Err(reason) if reason.kind() != io::ErrorKind::AlreadyExists => {
                    Err(failed(reason))?
                }
                _ => {}
            }
            fs::rename(from, folder.join(&name)).map_err(failed)?;
            sync_folder(&folder).map_err(failed)?;
        }
        staged.remove_folder();
        self.enter(part, staged)
    }

    /// Enters a part in the manifest whose files are in place already, here or elsewhere.
    ///
    /// # Errors
    /// [`Error::Io`] if the manifest cannot be written, [`Error::Refused`] for a part that another version
    /// of the program ran.
    pub fn enter(&mut self, part: u64, staged: Staged) -> Result<(), Error> {
        if staged.iva != self.manifest.iva {
            return Err(Error::Refused(format!(
                "a worker runs iva-dynamics {}, this is {}: install the same version on all of them",
                staged.iva, self.manifest.iva
            )));
        }
        let points = self.manifest.plan().range(part);
        let entry = Part {
            first_point: points.start,
            points: points.end - points.start,
            failed: staged.failed,
            tables: staged.contents,
        };
        self.manifest.parts.insert(part, entry);
        self.written.stale = true;
        // A manifest of thousands of parts is not written anew for each: a tenth of the time is enough.
        if self.manifest.parts.len() <= FEW_PARTS
            || self.written.at.elapsed() > 10 * self.written.took
        {
            let written = self.write_manifest();
            if written.is_err() {
                self.manifest.parts.remove(&part);
            }
            return written;
        }
        Ok(())
    }

    /// Brings manifest and folder to one state; of a sweep without a complete part everything is removed.
    /// Returns the files of the sweep, relative to the folder.
    ///
    /// # Errors
    /// [`Error::Io`] if a file cannot be written or removed.
    pub(crate) fn close(&mut self) -> Result<Vec<PathBuf>, Error> {
        if !self.root.is_dir() {
            return Ok(Vec::new());
        }
        if self.written.stale {
            self.write_manifest()?;
        }
        self.remove_unlisted()?;
        if self.manifest.parts.is_empty() {
            let inputs = inputs_of(&self.root);
            for name in inputs.into_iter().chain([MANIFEST_FILE, STUDY_FILE].map(PathBuf::from)) {
                self.remove(&name)?;
            }
            remove_empty_table_folders(&self.root);
            // Fails, as it should, where files are left.
            let _ = fs::remove_dir(&self.root);
            return Ok(Vec::new());
        }
        Ok(written_by_iva(&self.root))
    }

    fn remove(&self, name: &Path) -> Result<(), Error> {
        let path = self.root.join(name);
        match fs::remove_file(&path) {
            Err(reason) if reason.kind() != io::ErrorKind::NotFound => {
                Err(Error::io("remove", &path, reason))
            }
            _ => Ok(()),
        }
    }

    /// Removes parts that the manifest does not list: a process was killed before it entered them.
    fn remove_unlisted(&self) -> Result<(), Error> {
        let format = self.manifest.style.format;
        let listed: HashSet<PathBuf> = self
            .manifest
            .parts
            .iter()
            .flat_map(|(number, part)| {
                let name = part_name(*number, format);
                part.tables.keys().map(move |table| Path::new(table).join(&name))
            })
            .collect();
        parts_in(&self.root)
            .iter()
            .filter(|name| !listed.contains(*name))
            .try_for_each(|name| self.remove(name))
    }

    /// Takes parts out of the manifest that are not what it says; `None` if the look was ended early.
    fn drop_bad_parts(&mut self, go_on: &dyn Fn() -> bool) -> Result<Option<Vec<String>>, Error> {
        let (mut bad, mut numbers) = (Vec::new(), Vec::new());
        for (number, part) in &self.manifest.parts {
            let name = part_name(*number, self.manifest.style.format);
            for (table, contents) in &part.tables {
                let path = self.root.join(table).join(&name);
                match contents.are_in(&path, go_on) {
                    Ok(true) => {}
                    Ok(false) => {
                        bad.push(format!("{table}/{name}"));
                        numbers.push(*number);
                    }
                    Err(reason) if reason.kind() == io::ErrorKind::Interrupted => return Ok(None),
                    Err(reason) => return Err(Error::io("read", &path, reason)),
                }
            }
        }
        for number in numbers {
            self.manifest.parts.remove(&number);
        }
        Ok(Some(bad))
    }

    fn write_manifest(&mut self) -> Result<(), Error> {
        let begin = Instant::now();
        self.write_aside(MANIFEST_FILE, self.manifest.text().as_bytes())?;
        self.written = Written { at: Instant::now(), took: begin.elapsed(), stale: false };
        Ok(())
    }

    /// Writes the study and its inputs; on resumption anew, for nothing vouches for those that are there.
    fn write_study(&self, study: &str, inputs: &[Input]) -> Result<(), Error> {
        inputs.iter().try_for_each(|input| input.write(&self.root))?;
        self.write_aside(STUDY_FILE, study.as_bytes())
    }

    /// Writes a file of the folder aside, syncs it and renames it.
    fn write_aside(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let path = self.root.join(name);
        let aside = self.work().join(name);
        File::create(&aside)
            .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
            .and_then(|()| fs::rename(&aside, &path))
            .and_then(|()| sync_folder(&self.root))
            .map_err(|reason| match self.root.is_dir() {
                true => Error::io("write", &path, reason),
                false => vanished(&self.root),
            })
    }
}

/// What a folder holds of a sweep that is to go on; `None`: nothing, it can begin.
///
/// # Errors
/// [`Error::Refused`] if it holds another sweep.
pub(crate) fn earlier(root: &Path, now: &Manifest, study: &str) -> Result<Option<Manifest>, Error> {
    let Some(text) = manifest_text(root)? else { return Ok(None) };
    let found = Manifest::parse(&text).map_err(|reason| {
        let path = root.join(MANIFEST_FILE);
        Error::Refused(format!("{}: {reason}; give --overwrite to begin anew", path.display()))
    })?;
    let mut differences = found.differences(now);
    if found.study != now.study || found.points != now.points {
        differences.extend(changes(&study_text(root), study));
    }
    if differences.is_empty() {
        return Ok(Some(found));
    }
    Err(Error::Refused(format!(
        "{} holds another sweep: {}; choose another folder with --out, or give --overwrite without \
         --resume to replace it",
        root.display(),
        differences.join("; ")
    )))
}

/// The resolved study of a folder; nothing if there is none.
pub(crate) fn study_text(root: &Path) -> String {
    fs::read_to_string(root.join(STUDY_FILE)).unwrap_or_default()
}
