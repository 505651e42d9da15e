//! Running of a sweep into a folder: the study is checked, divided into parts, run and written part by part.
//!
//! Two or more parts are under way at a time, each driven and written by a thread of its own, so that the
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

/// Number of points that a driver holds in memory at once, a constant so that the rows reach the files in the
/// same batches on every machine.
const BATCH_POINTS: u64 = 16_384;
/// Number of workers for each driver beyond the first two.
const WORKERS_PER_DRIVER: usize = 8;

/// A sweep to run, with its folder and options.
pub struct Sweep<'a> {
    /// Study file of the sweep.
    pub file: &'a StudyFile,
    /// Folder of the result.
    pub dir: &'a Path,
    /// File format of the tables.
    pub style: Style,
    /// True to resume the same sweep in the folder.
    pub resume: bool,
    /// True to replace the tables in the folder, once the new ones are complete.
    pub overwrite: bool,
    /// True if the parts are in another place and the folder holds only study and manifest.
    pub elsewhere: bool,
    /// Worker threads that run the points.
    pub workers: &'a Workers,
    /// Flag that cancels the sweep; parts under way are dropped.
    pub cancel: &'a AtomicBool,
}

/// The receiver of the progress of a sweep, which may be called from any thread.
pub trait Watch: Sync {
    /// Receives the number of points checked since the last call.
    fn checked(&self, _points: u64) {}
    /// Receives the manifest when the parts are planned, with the parts that an earlier process completed.
    fn planned(&self, _manifest: &Manifest) {}
    /// Receives the names of damaged or missing files of an earlier process, whose parts are computed again.
    fn damaged(&self, _files: &[String]) {}
    /// Receives the counts of points run since the last call.
    fn done(&self, _done: Done) {}
    /// Receives the number of a part that is complete, and the manifest.
    fn part(&self, _number: u64, _manifest: &Manifest) {}
    /// True if [`Watch::rows`] has to be called.
    fn wants_rows(&self) -> bool {
        false
    }
    /// Receives rows of the summary, each once, in any order.
    fn rows(&self, _summary: &RecordBatch) {}
}

/// A sweep whose folder is ready for the missing parts.
pub struct Opened {
    /// Folder that is filled: that of the result, or `.iva-new` in it if earlier tables are to be replaced.
    pub folder: SweepFolder,
}

impl Opened {
    /// Ends the sweep: complete parts stay, unfinished ones are removed, and a complete sweep replaces earlier
    /// tables. Returns the manifest.
    ///
    /// # Errors
    /// [`Error::Interrupted`] if `failure` is one or parts are missing without a failure, [`Error::Incomplete`] for
    /// any other `failure`, [`Error::Store`] if the folder cannot be closed or earlier tables cannot be replaced.
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
    /// Runs the sweep; returns the manifest of the complete one.
    ///
    /// # Errors
    /// As [`Sweep::open`] before the first part, and as [`Opened::close`] after it.
    pub fn run(&self, watch: &dyn Watch) -> Result<Manifest, Error> {
        let mut opened = self.open(watch)?;
        let ran = self
            .read_complete(&opened.folder, watch)
            .and_then(|()| self.run_parts(&mut opened.folder, watch));
        opened.close(ran.err())
    }

    /// Checks the study and the folder, and prepares the folder for the missing parts.
    ///
    /// # Errors
    /// [`Error::Store`] for a folder that cannot take the sweep and [`Error::Study`] for an invalid study, with no
    /// result changed; [`Error::Interrupted`] if the sweep is cancelled.
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

    /// Resumes or begins the sweep in a locked folder.
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
            // Without complete parts there is nothing to resume, and the sweep is planned again.
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

    /// The description of the complete parts for an error.
    fn kept(&self, replaced: bool, manifest: &Manifest) -> Kept {
        Kept { dir: self.dir.to_owned(), done: manifest.done(), points: manifest.points, replaced }
    }

    /// The error of a cancelled sweep without complete parts, if the sweep is cancelled.
    fn nothing_if_cancelled(&self) -> Result<(), Error> {
        match self.cancel.load(Ordering::Relaxed) {
            true => Err(Error::Interrupted(Kept::nothing())),
            false => Ok(()),
        }
    }

    /// Passes the summaries of complete parts to `watch`.
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

    /// Runs the missing parts until all are complete, one fails, or the sweep is cancelled.
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
                // A panic ends the sweep like any other error, and complete parts are kept.
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

    /// Runs and writes a part; if the sweep is cancelled midway, its files are removed.
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

/// The study and the workers that run a part.
pub struct PartWork<'a> {
    /// Study that contains at least the points of the part.
    pub study: &'a Study,
    /// Worker threads that run the points.
    pub workers: &'a Workers,
    /// Flag that cancels the run.
    pub cancel: &'a AtomicBool,
}

impl PartWork<'_> {
    /// Runs the points of a part and writes its files; `None` if the run is cancelled.
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

/// Refuses to resume a sweep that differs from the one of a study.
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

/// Locks a mutex, also after a panic of the thread that held it, which ends the sweep anyway.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
