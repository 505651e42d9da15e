//! The folder of a sweep: parts are written aside, synced, renamed into place and then entered in the
//! manifest, so that at any instant everything that the manifest lists is there and complete.

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

/// Parts up to which the manifest is written after every one of them.
const FEW_PARTS: usize = 256;

/// A folder that a sweep fills part by part.
#[derive(Debug)]
pub struct SweepFolder {
    root: Directory,
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
pub type Resumed = (SweepFolder, Vec<String>);

impl SweepFolder {
    fn new(root: Directory, manifest: Manifest, claim: Claim) -> Self {
        let written = Written { at: Instant::now(), took: Duration::ZERO, stale: false };
        Self { root, manifest, claim, written }
    }

    /// Begins a sweep in a folder without tables.
    ///
    /// # Errors
    /// [`Error::Folder`] if a file that is not `iva`'s stands where an input must go; [`Error::Io`] if
    /// something cannot be written.
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
        // They were listed until now; what is in them need not say that they are ours.
        bad.iter().try_for_each(|name| folder.root.remove_file(Path::new(name)))?;
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
        self.root.path()
    }

    /// The folder of the result: the one that is filled, or the one whose tables it is to replace.
    pub fn dir(&self) -> &Path {
        self.claim.dir().path()
    }

    /// True if the folder that is filled is to replace the tables of the folder of the result.
    pub fn replaces(&self) -> bool {
        self.root() != self.dir()
    }

    /// Says that the folder vanished, if it or that of unfinished files is not where it was.
    pub fn vanished(&self) -> Option<Error> {
        let is_in_place = self.root.is_in_place() && self.claim.work().is_in_place();
        (!is_in_place).then(|| vanished(self.root.path()))
    }

    /// Hands out the rows of the summary of a complete part, in portions.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be read, [`Error::Invalid`] for a study without units.
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

    /// Lets the tables of a complete sweep take the place of those that it is to replace, if there are any.
    ///
    /// # Errors
    /// [`Error::NotMoved`] if a file cannot be moved; [`Error::Folder`] if a file of others is in the way.
    pub fn put_in_place(&self) -> Result<(), Error> {
        if self.replaces() {
            exchange::prepare(self.claim.dir(), &self.root)?;
            exchange::finish(self.claim.dir())?;
        }
        Ok(())
    }

    /// Opens the files of a part, aside.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be made.
    pub fn stage(&self, study: &Study, part: u64) -> Result<PartFiles, Error> {
        self.is_there()?;
        let plan = self.manifest.plan();
        let identity = self.manifest.identity();
        PartFiles::create(self.claim.work(), study, identity, plan.range(part), self.style())
    }

    fn is_there(&self) -> Result<(), Error> {
        match self.root.is_in_place() {
            true => Ok(()),
            false => Err(vanished(self.root.path())),
        }
    }

    /// Where unfinished files go.
    pub fn work(&self) -> PathBuf {
        self.claim.work().path().to_owned()
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
        self.is_there()?;
        let (format, work) = (self.style().format, self.claim.work());
        let name = part_name(part, format);
        for table in staged.contents.keys() {
            let from = Path::new(&staged.folder).join(staged_name(table, format));
            let folder = self.root.make_folder(Path::new(table))?;
            work.rename(&from, &folder, Path::new(&name))?;
            folder.sync()?;
        }
        // It is empty, and what remains of it is removed with all unfinished files.
        work.remove_if_empty(Path::new(&staged.folder));
        self.enter(part, staged)
    }

    /// As [`SweepFolder::take`], of a part that another process ran: nothing that it says is believed
    /// before the files have been found to be what it says.
    ///
    /// # Errors
    /// [`Error::OtherVersion`], [`Error::UnfitPart`] or [`Error::ChangedPart`] if they are not; as
    /// [`SweepFolder::take`].
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

    /// Enters a part in the manifest that another process ran and whose files are in place elsewhere.
    ///
    /// # Errors
    /// [`Error::OtherVersion`] or [`Error::UnfitPart`] if what it says does not fit the sweep; [`Error::Io`] if
    /// the manifest cannot be written.
    pub fn receive_entry(&mut self, part: u64, staged: Staged) -> Result<(), Error> {
        self.check(part, &staged)?;
        self.enter(part, staged)
    }

    /// Checks what another process says of a part.
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

    /// Enters a part in the manifest whose files are in place already, here or elsewhere.
    ///
    /// # Errors
    /// [`Error::Io`] if the manifest cannot be written.
    fn enter(&mut self, part: u64, staged: Staged) -> Result<(), Error> {
        let points = self.manifest.plan().range(part);
        let entry = entry(points, &staged);
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

    /// Removes parts that the manifest does not list: a process was killed before it entered them.
    fn remove_unlisted(&self) -> Result<(), Error> {
        let listed: HashSet<PathBuf> = self.manifest.files().map(|(name, _)| name).collect();
        our_parts(&self.root)?
            .iter()
            .filter(|name| !listed.contains(*name))
            .try_for_each(|name| self.root.remove_file(name))
    }

    /// Takes parts out of the manifest that are not what it says; `None` if the look was ended early.
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

    fn write_manifest(&mut self) -> Result<(), Error> {
        let begin = Instant::now();
        self.write_aside(MANIFEST_FILE, self.manifest.text().as_bytes())?;
        self.written = Written { at: Instant::now(), took: begin.elapsed(), stale: false };
        Ok(())
    }

    /// Writes the study and its inputs; on resumption anew, for nothing vouches for those that are there.
    fn write_study(&self, study: &str, inputs: &[Input]) -> Result<(), Error> {
        inputs.iter().try_for_each(|input| input.write(self.claim.work(), &self.root))?;
        self.write_aside(STUDY_FILE, study.as_bytes())
    }

    /// Writes a file of the folder aside, syncs it and renames it.
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
