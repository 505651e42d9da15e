//! The output folder of a sweep for Python, filled by this process or part by part by others.

use std::path::PathBuf;
use std::sync::Mutex;

use iva_store::Error;
use iva_store::manifest::Manifest;
use iva_store::part_files::Staged;
use iva_store::table_file::{Format, Style};
use iva_study::run_sweep::{Opened, Sweep, Watch};
use iva_study::study_file::StudyFile;
use iva_study::threads::workers;
use iva_sweep::Invalid;
use iva_sweep::done::Done;
use iva_sweep::study::Study;
use pyo3::prelude::*;

use crate::errors::{PYTHON, internal, invalid, refused, worded};
use crate::study::{PyStudy, count};
use crate::worker::{self, Progress, Shared};

/// The file style of a format given by name.
///
/// # Errors
/// `ValueError` that lists the formats.
pub fn style(format: &str) -> PyResult<Style> {
    let known = Format::ALL.map(Format::name);
    let found = Format::ALL.into_iter().find(|known| known.name() == format);
    let format = found.ok_or_else(|| {
        let rule = format!("give \"{}\"", known.join("\", \""));
        invalid(Invalid::new("format", format!("\"{format}\""), rule))
    })?;
    Ok(Style { format, units_row: false })
}

/// A folder that a sweep fills.
#[pyclass(frozen, module = "iva._iva", name = "SweepFolder")]
pub struct PySweepFolder {
    opened: Mutex<Option<Opened>>,
}

/// Observer of a sweep that counts finished points and collects the names of damaged files.
struct Counting<'a> {
    shared: &'a Shared,
    damaged: &'a Mutex<Vec<String>>,
}

impl Watch for Counting<'_> {
    fn planned(&self, manifest: &Manifest) {
        self.shared.add(Done {
            points: manifest.done(),
            failed: manifest.parts.values().map(|part| part.failed).sum(),
            work: 0,
        });
    }

    fn damaged(&self, files: &[String]) {
        if let Ok(mut damaged) = self.damaged.lock() {
            damaged.extend_from_slice(files);
        }
    }

    fn done(&self, done: Done) {
        self.shared.add(done);
    }
}

/// The arguments with which a folder is opened.
struct Asked {
    file: StudyFile,
    dir: PathBuf,
    style: Style,
    resume: bool,
    overwrite: bool,
    elsewhere: bool,
    threads: Option<usize>,
}

impl Asked {
    fn new(
        study: &PyStudy,
        dir: PathBuf,
        format: &str,
        resume: bool,
        overwrite: bool,
        threads: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let file = StudyFile::of(Study::clone(&study.study));
        let (style, threads) = (style(format)?, count(threads)?);
        Ok(Self { file, dir, style, resume, overwrite, elsewhere: false, threads })
    }

    fn with<T>(
        &self,
        shared: &Shared,
        work: impl FnOnce(&Sweep<'_>) -> Result<T, iva_study::Error>,
    ) -> Result<T, iva_study::Error> {
        let workers = workers(self.threads)?;
        work(&Sweep {
            file: &self.file,
            dir: &self.dir,
            style: self.style,
            resume: self.resume,
            overwrite: self.overwrite,
            elsewhere: self.elsewhere,
            workers: &workers,
            cancel: &shared.cancel,
        })
    }
}

/// Runs a study into a folder. Returns the files of an earlier process that were not what they should
/// be, and were computed again.
#[pyfunction]
#[pyo3(signature = (study, folder, style, resume, overwrite, threads = None, progress = None))]
#[allow(clippy::too_many_arguments)] // those of `iva.sweep`
pub fn sweep_into(
    py: Python<'_>,
    study: &PyStudy,
    folder: PathBuf,
    style: &str,
    resume: bool,
    overwrite: bool,
    threads: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<String>> {
    let asked = Asked::new(study, folder, style, resume, overwrite, threads)?;
    let progress = progress.map(|callback| Progress { callback, total: study.identity.points });
    let ran = worker::run_any(py, progress.as_ref(), move |shared: &Shared| {
        let damaged = Mutex::default();
        let watch = Counting { shared, damaged: &damaged };
        asked.with(shared, |sweep| sweep.run(&watch))?;
        Ok(damaged.into_inner().unwrap_or_default())
    })?;
    ran.map_err(refused)
}

#[pymethods]
impl PySweepFolder {
    /// Checks study and folder, and makes the folder ready. If the parts are `elsewhere` it holds only study
    /// and manifest. Returns also the files of an earlier process
    /// that are not what they should be.
    #[staticmethod]
    #[pyo3(signature = (study, folder, style, resume, overwrite, elsewhere = false))]
    fn open(
        py: Python<'_>,
        study: &PyStudy,
        folder: PathBuf,
        style: &str,
        resume: bool,
        overwrite: bool,
        elsewhere: bool,
    ) -> PyResult<(Self, Vec<String>)> {
        let mut asked = Asked::new(study, folder, style, resume, overwrite, None)?;
        asked.elsewhere = elsewhere;
        let opened = worker::run_any(py, None, move |shared: &Shared| {
            let damaged = Mutex::default();
            let watch = Counting { shared, damaged: &damaged };
            let opened = asked.with(shared, |sweep| sweep.open(&watch))?;
            Ok((opened, damaged.into_inner().unwrap_or_default()))
        })?;
        let (opened, damaged) = opened.map_err(refused)?;
        Ok((Self { opened: Mutex::new(Some(opened)) }, damaged))
    }

    /// The missing parts: number, first point, and the one after the last.
    #[getter]
    fn missing(&self) -> PyResult<Vec<(u64, u64, u64)>> {
        self.with(|opened| {
            let manifest = opened.folder.manifest();
            let plan = manifest.plan();
            let range = |part| (part, plan.range(part).start, plan.range(part).end);
            Ok(manifest.missing().map(range).collect())
        })
    }

    /// Points of complete parts, and those of them that failed.
    #[getter]
    fn done(&self) -> PyResult<(u64, u64)> {
        self.with(|opened| {
            let manifest = opened.folder.manifest();
            Ok((manifest.done(), manifest.parts.values().map(|part| part.failed).sum()))
        })
    }

    /// Where unfinished files go.
    #[getter]
    fn work(&self) -> PyResult<PathBuf> {
        self.with(|opened| Ok(opened.folder.work()))
    }

    /// Takes the files of a part, as [`PyStudy::run_part`] describes them.
    fn take(&self, py: Python<'_>, part: u64, staged: &str) -> PyResult<()> {
        let staged = received(part, staged)?;
        py.detach(|| {
            self.with(|opened| opened.folder.receive(part, staged).map_err(refused_by_folder))
        })
    }

    /// Enters a part whose files are in place elsewhere.
    fn enter(&self, py: Python<'_>, part: u64, staged: &str) -> PyResult<()> {
        let staged = received(part, staged)?;
        py.detach(|| {
            self.with(|opened| opened.folder.receive_entry(part, staged).map_err(refused_by_folder))
        })
    }

    /// Ends a sweep of which all parts are complete.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let Some(opened) = self.take_opened() else { return Ok(()) };
        py.detach(|| opened.close(None)).map(drop).map_err(refused)
    }

    /// Ends a sweep of which parts are missing; says what is kept, and how to go on.
    fn abandon(&self, py: Python<'_>) -> String {
        let Some(opened) = self.take_opened() else { return String::new() };
        match py.detach(|| opened.close(None)) {
            Err(iva_study::Error::Interrupted(kept)) => kept.sentence(&PYTHON),
            Err(other) => worded(&other),
            Ok(_) => "every part is complete".to_owned(),
        }
    }
}

/// Reads a worker's JSON description of the part that it ran.
fn received(part: u64, staged: &str) -> PyResult<Staged> {
    serde_json::from_str(staged).map_err(|_| refused_by_folder(Error::UnfitPart { part }))
}

/// The exception for a folder error, such as a refused part.
fn refused_by_folder(error: Error) -> PyErr {
    refused(error.into())
}

impl PySweepFolder {
    fn take_opened(&self) -> Option<Opened> {
        self.opened.lock().ok().and_then(|mut opened| opened.take())
    }

    fn with<T>(&self, act: impl FnOnce(&mut Opened) -> PyResult<T>) -> PyResult<T> {
        let mut opened =
            self.opened.lock().map_err(|_| internal("a folder was left in a panic"))?;
        match opened.as_mut() {
            Some(opened) => act(opened),
            None => Err(internal("a folder that was closed")),
        }
    }
}
