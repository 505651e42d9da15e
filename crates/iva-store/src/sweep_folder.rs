//! The folder of a sweep: parts are written as unfinished files, synced, renamed into place and then entered
//! in the manifest, so that at any instant everything that the manifest lists exists and is complete.

use std::collections::{BTreeMap, HashSet};
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use arrow_array::RecordBatch;
use iva_sweep::study::{Study, Table};
use iva_sweep::tables::schema;

use crate::claim::Claim;
use crate::directory::Directory;
use crate::error::Error;
use crate::exchange;
use crate::folder::{
    MANIFEST_FILE, STUDY_FILE, in_the_way, inputs_of, our_parts, part_name,
    remove_empty_table_folders, vanished,
};
use crate::hidden::remove_new_folder;
use crate::inputs::Input;
use crate::manifest::{Manifest, Part};
use crate::part_files::{PartFiles, Staged, staged_name};
use crate::table_file::{Style, part_schema, read_rows};

/// Number of parts up to which the manifest is written after every part.
const FEW_PARTS: usize = 256;

/// A locked folder that a sweep fills part by part.
#[derive(Debug)]
pub struct SweepFolder {
    root: Directory,
    manifest: Manifest,
    /// Lock of the folder of the result, which is `root` or the parent of it.
    claim: Claim,
    written: Written,
}

/// The state of the manifest on disk.
#[derive(Debug)]
struct Written {
    /// Instant of the last write.
    at: Instant,
    /// Duration of the last write.
    took: Duration,
    /// True if a part was entered since the last write.
    stale: bool,
}

/// The folder of a resumed sweep, and the names of its damaged or missing files.
pub type Resumed = (SweepFolder, Vec<String>);

impl SweepFolder {
    /// A folder whose manifest counts as written now.
    fn new(root: Directory, manifest: Manifest, claim: Claim) -> Self {
        let written = Written { at: Instant::now(), took: Duration::ZERO, stale: false };
        Self { root, manifest, claim, written }
    }

    /// Begins a sweep in a folder without tables, or with none but parts that a process put in place before it was
    /// killed and did not enter; these are removed.
    ///
    /// # Errors
    /// [`Error::Folder`] if a file that `iva` did not write has the name of an input; [`Error::Io`] if something
    /// cannot be written.
    pub(crate) fn begin(
        root: Directory,
        claim: Claim,
        mut manifest: Manifest,
        study: &str,
        inputs: &[Input],
    ) -> Result<Self, Error> {
        let known = inputs_of(&root)?;
        for name in inputs.iter().map(|input| Path::new(input.name())) {
            if root.kind(name)?.is_some() && !known.iter().any(|known| known == name) {
                return Err(in_the_way(&root, name, "was not written by iva"));
            }
        }
        manifest.inputs = inputs.iter().map(|input| input.name().to_owned()).collect();
        let mut folder = Self::new(root, manifest, claim);
        let ready = folder
            .write_manifest()
            .and_then(|()| folder.write_study(study, inputs))
            .and_then(|()| folder.remove_unlisted());
        match ready {
            Ok(()) => Ok(folder),
            Err(reason) => {
                // The first error is returned, not that of the cleanup.
                let _ = folder.close();
                Err(reason)
            }
        }
    }

    /// Resumes the sweep in a folder whose manifest is that of the same sweep. Parts with files that differ from
    /// the manifest are removed from it, to be computed again; with `elsewhere` no files are checked. Returns
    /// `None`, with nothing changed, if `go_on` returns false.
    ///
    /// # Errors
    /// [`Error::Io`] if a part exists and cannot be read, or something cannot be written.
    pub(crate) fn resume(
        root: Directory,
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
        // The manifest listed these files until now, so their content is not needed to recognise them.
        bad.iter().try_for_each(|name| folder.root.remove_file(Path::new(name)))?;
        folder.write_study(study, inputs)?;
        folder.remove_unlisted()?;
        Ok(Some((folder, bad)))
    }

    /// The manifest, which lists the complete parts.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Path of the folder that is filled.
    pub fn root(&self) -> &Path {
        self.root.path()
    }

    /// Path of the folder of the result: the one that is filled, or the one whose tables are to be replaced.
    pub fn dir(&self) -> &Path {
        self.claim.dir().path()
    }

    /// True if the folder that is filled is `.iva-new` and is to replace the tables of the folder of the result.
    pub fn replaces(&self) -> bool {
        self.root() != self.dir()
    }

    /// The error for a vanished folder, if this one or that of unfinished files was moved or removed.
    pub fn vanished(&self) -> Option<Error> {
        let is_in_place = self.root.is_in_place() && self.claim.work().is_in_place();
        (!is_in_place).then(|| vanished(self.root.path()))
    }

    /// Reads the summary of a complete part and passes its rows to `take`, in batches.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read, [`Error::Invalid`] for a study without units.
    pub fn read_summary(
        &self,
        study: &Study,
        part: u64,
        take: &mut dyn FnMut(&RecordBatch),
    ) -> Result<(), Error> {
        let table = Table::Summary;
        let schema = schema(study, table, self.manifest.identity())?;
        let schema = part_schema(&schema, &self.manifest.plan().range(part));
        let style = self.style();
        let path = self.root().join(table.name()).join(part_name(part, style.format));
        read_rows(&path, schema, style, take)
    }

    /// Exchanges the earlier result for that of the complete sweep, if there is one to replace.
    ///
    /// # Errors
    /// [`Error::NotMoved`] if a file cannot be moved; [`Error::Folder`] if a file that `iva` did not write would
    /// be replaced.
    pub fn put_in_place(&self) -> Result<(), Error> {
        if self.replaces() {
            exchange::prepare(self.claim.dir(), &self.root)?;
            exchange::finish(self.claim.dir())?;
        }
        Ok(())
    }

    /// Creates the files of a part in the folder of unfinished files.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be created, [`Error::Invalid`] for a study without units.
    pub fn stage(&self, study: &Study, part: u64) -> Result<PartFiles, Error> {
        self.is_there()?;
        let plan = self.manifest.plan();
        let identity = self.manifest.identity();
        PartFiles::create(self.claim.work(), study, identity, plan.range(part), self.style())
    }

    /// Refuses to go on if the folder was moved or removed.
    fn is_there(&self) -> Result<(), Error> {
        match self.root.is_in_place() {
            true => Ok(()),
            false => Err(vanished(self.root.path())),
        }
    }

    /// Path of the folder of unfinished files.
    pub fn work(&self) -> PathBuf {
        self.claim.work().path().to_owned()
    }

    /// File format of the tables.
    pub fn style(&self) -> Style {
        self.manifest.style
    }

    /// Moves the complete files of a part into place and enters it in the manifest.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be moved.
    pub fn take(&mut self, part: u64, staged: Staged) -> Result<(), Error> {
        self.is_there()?;
        let (format, work) = (self.style().format, self.claim.work());
        let name = part_name(part, format);
        for table in staged.contents.keys() {
            let from = Path::new(&staged.folder).join(staged_name(table, format));
            let folder = self.root.make_folder(Path::new(table))?;
            work.rename(&from, &folder, Path::new(&name))?;
            folder.sync()?;
        }
        // A folder that is not empty is removed with all unfinished files.
        work.remove_if_empty(Path::new(&staged.folder));
        self.enter(part, staged)
    }

    /// Checks the files of a part that another process ran against its report, moves them into place and enters
    /// the part in the manifest.
    ///
    /// # Errors
    /// [`Error::OtherVersion`] or [`Error::UnfitPart`] if the report does not fit the sweep,
    /// [`Error::ChangedPart`] if the files differ from it; otherwise as [`SweepFolder::take`].
    pub fn receive(&mut self, part: u64, staged: Staged) -> Result<(), Error> {
        self.check(part, &staged)?;
        let refused = || Error::ChangedPart { part };
        for (table, contents) in &staged.contents {
            let name = Path::new(&staged.folder).join(staged_name(table, self.style().format));
            let file = self.claim.work().open_file(&name)?.ok_or_else(refused)?;
            let path = self.claim.work().path().join(&name);
            let whole = contents.are_in(file, &|| true);
            if !whole.map_err(|reason| Error::io("read", &path, reason))? {
                return Err(refused());
            }
        }
        self.take(part, staged)
    }

    /// Enters a part that another process ran, with files in another place, in the manifest.
    ///
    /// # Errors
    /// [`Error::OtherVersion`] or [`Error::UnfitPart`] if its report does not fit the sweep; [`Error::Io`] if the
    /// manifest cannot be written.
    pub fn receive_entry(&mut self, part: u64, staged: Staged) -> Result<(), Error> {
        self.check(part, &staged)?;
        self.enter(part, staged)
    }

    /// Checks the report of another process about a part.
    fn check(&self, part: u64, staged: &Staged) -> Result<(), Error> {
        if staged.iva != self.manifest.iva {
            let (theirs, ours) = (staged.iva.clone(), self.manifest.iva.clone());
            return Err(Error::OtherVersion { theirs, ours });
        }
        let plan = self.manifest.plan();
        let fits = || {
            let part_alone = self.manifest.with_only(part, entry(plan.range(part), staged));
            part_alone.fault().is_none()
        };
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-';
        let plain = !staged.folder.is_empty() && staged.folder.bytes().all(is_plain);
        match part < plan.parts() && plain && fits() {
            true => Ok(()),
            false => Err(Error::UnfitPart { part }),
        }
    }

    /// Enters a part whose files are in place in the manifest, and writes the manifest if it is due.
    ///
    /// # Errors
    /// [`Error::Io`] if the manifest cannot be written.
    fn enter(&mut self, part: u64, staged: Staged) -> Result<(), Error> {
        let points = self.manifest.plan().range(part);
        let entry = entry(points, &staged);
        self.manifest.parts.insert(part, entry);
        self.written.stale = true;
        // A long manifest is written less often, so that writing takes at most about a tenth of the time.
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

    /// Writes the manifest and removes parts that it does not list; a sweep without complete parts is removed.
    ///
    /// # Errors
    /// [`Error::Io`] if a file cannot be written or removed.
    pub fn close(&mut self) -> Result<(), Error> {
        if !self.root.is_in_place() {
            return Ok(());
        }
        if self.written.stale {
            self.write_manifest()?;
        }
        self.remove_unlisted()?;
        if self.manifest.parts.is_empty() {
            let inputs = inputs_of(&self.root)?;
            for name in inputs.into_iter().chain([MANIFEST_FILE, STUDY_FILE].map(PathBuf::from)) {
                self.root.remove_file(&name)?;
            }
            remove_empty_table_folders(&self.root);
            if self.replaces() {
                remove_new_folder(self.claim.dir())?;
            }
        }
        Ok(())
    }

    /// Removes parts that the manifest does not list, which a process that was killed leaves.
    fn remove_unlisted(&self) -> Result<(), Error> {
        let listed: HashSet<PathBuf> = self.manifest.files().map(|(name, _)| name).collect();
        our_parts(&self.root)?
            .iter()
            .filter(|name| !listed.contains(*name))
            .try_for_each(|name| self.root.remove_file(name))
    }

    /// Removes parts with damaged or missing files from the manifest, and returns the names of these files; `None`
    /// if `go_on` ends the check.
    fn drop_bad_parts(&mut self, go_on: &dyn Fn() -> bool) -> Result<Option<Vec<String>>, Error> {
        let (mut bad, mut numbers) = (Vec::new(), Vec::new());
        for (number, part) in &self.manifest.parts {
            let name = part_name(*number, self.manifest.style.format);
            for (table, contents) in &part.tables {
                let name = Path::new(table).join(&name);
                let whole = match self.root.open_file(&name)? {
                    Some(file) => contents.are_in(file, go_on),
                    None => Ok(false),
                };
                match whole {
                    Ok(true) => {}
                    Ok(false) => {
                        bad.push(format!("{table}/{}", part_name(*number, self.style().format)));
                        numbers.push(*number);
                    }
                    Err(reason) if reason.kind() == io::ErrorKind::Interrupted => return Ok(None),
                    Err(reason) => {
                        return Err(Error::io("read", &self.root.path().join(name), reason));
                    }
                }
            }
        }
        for number in numbers {
            self.manifest.parts.remove(&number);
        }
        Ok(Some(bad))
    }

    /// Writes the manifest and notes when.
    fn write_manifest(&mut self) -> Result<(), Error> {
        let begin = Instant::now();
        self.write_aside(MANIFEST_FILE, self.manifest.text().as_bytes())?;
        self.written = Written { at: Instant::now(), took: begin.elapsed(), stale: false };
        Ok(())
    }

    /// Writes the study and its inputs, also on resumption, since there are no checksums of the existing ones.
    fn write_study(&self, study: &str, inputs: &[Input]) -> Result<(), Error> {
        inputs.iter().try_for_each(|input| input.write(self.claim.work(), &self.root))?;
        self.write_aside(STUDY_FILE, study.as_bytes())
    }

    /// Writes a file into the folder of unfinished files, syncs it and renames it into place.
    fn write_aside(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        let (name, work) = (Path::new(name), self.claim.work());
        let written = work
            .remove_file(name)
            .and_then(|()| work.write_new(name, bytes))
            .and_then(|()| work.replace(name, &self.root, name))
            .and_then(|()| self.root.sync());
        match written {
            Err(_) if !self.root.is_in_place() => Err(vanished(self.root.path())),
            other => other,
        }
    }
}

/// The entry of a part in the manifest.
fn entry(points: Range<u64>, staged: &Staged) -> Part {
    Part {
        first_point: points.start,
        points: points.end - points.start,
        failed: staged.failed,
        tables: staged.contents.clone(),
        errors: BTreeMap::new(),
    }
}
