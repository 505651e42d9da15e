//! A sweep into a folder: checked, divided into parts, run and written part by part.
//!
//! Two parts or more are under way at a time, each with a thread that drives and writes it, so that the
//! workers have points to run while files are encoded and synced.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use arrow_array::RecordBatch;
use iva_store::inputs::Input;
use iva_store::manifest::Manifest;
use iva_store::part_files::{PartFiles, Staged};
use iva_store::sweep_folder::SweepFolder;
use iva_store::table_file::Style;
use iva_store::taken::{Allowed, Earlier, Taken, look};
use iva_sweep::done::Done;
use iva_sweep::identity::Identity;
use iva_sweep::plan::{Plan, Trial};
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{Control, Tables, Workers, sweep};

use crate::changes::changes;
use crate::error::{Error, Kept};
use crate::named::named;
use crate::resolved::{resolve, write};
use crate::study_file::StudyFile;

/// Points computed and held in memory at once by one driver: a constant, so that the rows reach the files
/// in the same portions on every machine.
const BATCH_POINTS: u64 = 16_384;
/// Workers that one driver keeps busy, beyond the first two drivers.
const WORKERS_PER_DRIVER: usize = 8;

/// What to run, and where its tables go.
pub struct Sweep<'a> {
    /// The study.
    pub file: &'a StudyFile,
    /// The folder.
    pub dir: &'a Path,
    /// How tables are written.
    pub style: Style,
    /// Go on with what the folder holds of the same sweep.
    pub resume: bool,
    /// Replace the tables that the folder holds, once the new ones are complete.
    pub overwrite: bool,
    /// The parts are not in the folder, which holds only study and manifest.
    pub elsewhere: bool,
    /// Who does the work.
    pub workers: &'a Workers,
    /// Set to stop: parts under way are dropped.
    pub cancel: &'a AtomicBool,
}

/// Who is told what happens; from any thread.
pub trait Watch: Sync {
    /// So many more points were found valid.
    fn checked(&self, _points: u64) {}
    /// The parts are known; what an earlier process left is in the manifest.
    fn planned(&self, _manifest: &Manifest) {}
    /// Parts of an earlier process that are not what the manifest says, and are computed again.
    fn damaged(&self, _files: &[String]) {}
    /// So much more was done.
    fn done(&self, _done: Done) {}
    /// A part is complete.
    fn part(&self, _number: u64, _manifest: &Manifest) {}
    /// True if [`Watch::rows`] is to be called.
    fn wants_rows(&self) -> bool {
        false
    }
    /// Rows of the summary, each once, in any order.
    fn rows(&self, _summary: &RecordBatch) {}
}

/// A sweep whose folder is ready for the parts that are missing.
pub struct Opened {
    /// The folder that is filled: that of the result, or one in it if earlier tables are to be replaced.
    pub folder: SweepFolder,
}

impl Opened {
    /// Ends the sweep: what is complete stays, what is unfinished goes, and a complete sweep takes the
    /// place of earlier tables. Returns the manifest.
    ///
    /// # Errors
    /// [`Error::Incomplete`] if `failure` says why parts are missing, else [`Error::Interrupted`];
    /// [`Error::Store`] if earlier tables could not be replaced.
    pub fn close(self, failure: Option<Error>) -> Result<Manifest, Error> {
        let Self { mut folder } = self;
        let manifest = folder.manifest().clone();
        let dir = folder.dir().to_owned();
        let replaced = folder.replaces();
        let kept =
            || Kept { dir: dir.clone(), done: manifest.done(), points: manifest.points, replaced };
        let closed = folder.close();
        if let Some(Error::Interrupted(_)) = failure {
            return Err(Error::Interrupted(kept()));
        }
        if let Some(reason) = failure {
            return Err(Error::Incomplete { reason: Box::new(reason), kept: kept() });
        }
        if !manifest.is_complete() {
            return Err(Error::Interrupted(kept()));
        }
        closed?;
        folder.put_in_place()?;
        Ok(manifest)
    }
}

impl Sweep<'_> {
    /// Runs it; returns the manifest of the complete sweep.
    ///
    /// # Errors
    /// As [`Sweep::open`] before anything is run; then as [`Opened::close`].
    pub fn run(&self, watch: &dyn Watch) -> Result<Manifest, Error> {
        let mut opened = self.open(watch)?;
        let ran = self
            .read_complete(&opened.folder, watch)
            .and_then(|()| self.run_parts(&mut opened.folder, watch));
        opened.close(ran.err())
    }

    /// Checks the study and the folder, and makes the folder ready.
    ///
    /// # Errors
    /// [`Error::Store`] and [`Error::Study`] for what the user can mend, with no result touched;
    /// [`Error::Interrupted`] if it was cancelled.
    pub fn open(&self, watch: &dyn Watch) -> Result<Opened, Error> {
        let allowed = Allowed { resume: self.resume, overwrite: self.overwrite };
        look(self.dir, allowed)?;
        let (file, inputs) = named(self.file, self.dir);
        let text = write(&resolve(&file)?)?;
        let taken = Taken::take(self.dir, allowed, &text)?;
        let folder = self.prepare(taken, (&text, &inputs), watch)?;
        watch.planned(folder.manifest());
        Ok(Opened { folder })
    }

    /// The folder, ready for the first missing part.
    fn prepare(
        &self,
        taken: Taken,
        study_and_inputs: (&str, &[Input]),
        watch: &dyn Watch,
    ) -> Result<SweepFolder, Error> {
        let study = &self.file.study;
        let located = |invalid| self.file.source.locate(&invalid);
        let identity = Identity::of(study).map_err(located)?;
        if let Some(found) = taken.earlier()? {
            let undivided = Plan { points: identity.points, part_points: 1 };
            let now = Manifest::new(study, identity, undivided, self.style);
            refuse_another(&found, &now, study_and_inputs.0)?;
            // With no part complete there is nothing to go on with, and the plan is made anew.
            if !found.manifest().parts.is_empty() {
                let kept = self.kept(taken.replaces(), found.manifest());
                let go_on = || !self.cancel.load(Ordering::Relaxed);
                let resumed = taken.resume(found, study_and_inputs, self.elsewhere, &go_on)?;
                let Some((folder, damaged)) = resumed else { return Err(Error::Interrupted(kept)) };
                watch.damaged(&damaged);
                return Ok(folder);
            }
        }
        self.file.validate(self.workers, self.cancel, &|points| watch.checked(points))?;
        self.nothing_if_cancelled()?;
        let trial = Trial::run(study, self.workers, self.cancel)
            .map_err(|error| self.file.source.locate_sweep(error))?;
        self.nothing_if_cancelled()?;
        let plan = Plan::new(study, &trial).map_err(located)?;
        let manifest = Manifest::new(study, identity, plan, self.style);
        Ok(taken.begin(manifest, study_and_inputs)?)
    }

    fn kept(&self, replaced: bool, manifest: &Manifest) -> Kept {
        Kept { dir: self.dir.to_owned(), done: manifest.done(), points: manifest.points, replaced }
    }

    fn nothing_if_cancelled(&self) -> Result<(), Error> {
        match self.cancel.load(Ordering::Relaxed) {
            true => Err(Error::Interrupted(Kept::nothing())),
            false => Ok(()),
        }
    }

    /// Hands out the summaries of complete parts.
    fn read_complete(&self, folder: &SweepFolder, watch: &dyn Watch) -> Result<(), Error> {
        let manifest = folder.manifest();
        if !watch.wants_rows() || !self.file.study.tables.contains(&Table::Summary) {
            return Ok(());
        }
        for number in manifest.parts.keys() {
            folder.read_summary(&self.file.study, *number, &mut |rows| watch.rows(rows))?;
            if self.cancel.load(Ordering::Relaxed) {
                return Err(Error::Interrupted(self.kept(folder.replaces(), manifest)));
            }
        }
        Ok(())
    }

    /// Runs the missing parts, until all are complete, one fails, or the sweep is cancelled.
    fn run_parts(&self, folder: &mut SweepFolder, watch: &dyn Watch) -> Result<(), Error> {
        let missing: Vec<u64> = folder.manifest().missing().collect();
        let drivers = 2 + self.workers.count() / WORKERS_PER_DRIVER;
        let (folder, next) = (Mutex::new(folder), AtomicUsize::new(0));
        let failure: Mutex<Option<Error>> = Mutex::new(None);
        let failed = || lock(&failure).is_some();
        let drive = || {
            while let Some(part) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                if self.cancel.load(Ordering::Relaxed) || failed() {
                    break;
                }
                // A panic ends the sweep like any other fault, with what is complete kept.
                let ran = catch_unwind(AssertUnwindSafe(|| self.run_part(*part, &folder, watch)));
                let panicked = |_| Err(Error::Internal("a part ended in a panic".to_owned()));
                if let Err(reason) = ran.unwrap_or_else(panicked) {
                    let gone = lock(&folder).vanished();
                    let reason = gone.map_or(reason, Error::from);
                    lock(&failure).get_or_insert(reason);
                }
            }
        };
        thread::scope(|scope| {
            for _ in 1..drivers.min(missing.len()) {
                scope.spawn(drive);
            }
            drive();
        });
        failure.into_inner().ok().flatten().map_or(Ok(()), Err)
    }

    /// Runs and writes a part; if the sweep is cancelled midway nothing of it stays.
    fn run_part(
        &self,
        part: u64,
        folder: &Mutex<&mut SweepFolder>,
        watch: &dyn Watch,
    ) -> Result<(), Error> {
        let study = &self.file.study;
        let files = lock(folder).stage(study, part)?;
        let points = lock(folder).manifest().plan().range(part);
        let rows = |rows: &RecordBatch| {
            if watch.wants_rows() {
                watch.rows(rows);
            }
        };
        let work = PartWork { study, workers: self.workers, cancel: self.cancel };
        let staged =
            work.run(points, files, &|done| watch.done(done), &rows).map_err(
                |error| match error {
                    Error::Invalid(invalid) => self.file.source.locate(&invalid),
                    other => other,
                },
            )?;
        if let Some(staged) = staged {
            let mut folder = lock(folder);
            folder.take(part, staged)?;
            watch.part(part, folder.manifest());
        }
        Ok(())
    }
}

/// How a part is run.
pub struct PartWork<'a> {
    /// The study, with the points of the part at least.
    pub study: &'a Study,
    /// Who does the work.
    pub workers: &'a Workers,
    /// Set to stop.
    pub cancel: &'a AtomicBool,
}

impl PartWork<'_> {
    /// Runs the points of a part and writes its files; `None` if it was cancelled.
    ///
    /// # Errors
    /// [`Error::Store`] if they cannot be written, [`Error::Invalid`] for an invalid point.
    pub fn run(
        &self,
        points: std::ops::Range<u64>,
        mut files: PartFiles,
        progress: &(dyn Fn(Done) + Sync),
        rows: &dyn Fn(&RecordBatch),
    ) -> Result<Option<Staged>, Error> {
        let failed = Mutex::new(0);
        let count = |done: Done| {
            *lock(&failed) += done.failed;
            progress(done);
        };
        let Self { study, workers, cancel } = *self;
        let control = Control { workers, chunk: None, cancel, progress: &count };
        let mut first = points.start;
        while first < points.end {
            let last = points.end.min(first + BATCH_POINTS);
            let tables: Tables = sweep(study, first..last, &control)?;
            if cancel.load(Ordering::Relaxed) {
                return Ok(None);
            }
            files.append(&tables)?;
            if let Some(summary) = tables.get(&Table::Summary) {
                rows(summary);
            }
            first = last;
        }
        files.failed = *lock(&failed);
        Ok(Some(files.finish()?))
    }
}

/// Refuses to go on with a sweep that is not the one of a study.
fn refuse_another(found: &Earlier, now: &Manifest, text: &str) -> Result<(), Error> {
    let manifest = found.manifest();
    let mut differences = manifest.differences(now);
    if manifest.study != now.study || manifest.points != now.points {
        differences.extend(changes(&found.study_text()?, text));
    }
    match differences.is_empty() {
        true => Ok(()),
        false => Err(found.refused(differences).into()),
    }
}

/// What a mutex holds; a thread that panicked with it ends the sweep anyway.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
