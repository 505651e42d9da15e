//! Studies for Python: their points, and runs of all or some of them.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use arrow_array::RecordBatch;
use iva_store::part_files::PartFiles;
use iva_study::run_sweep::PartWork;
use iva_study::threads::workers;
use iva_sweep::Invalid;
use iva_sweep::cube::Method;
use iva_sweep::done::Done;
use iva_sweep::identity::Identity;
use iva_sweep::plan::{MAX_PART_POINTS, Plan, Trial, memory};
use iva_sweep::sampling::Sampling;
use iva_sweep::study::{Study, Table};
use iva_sweep::sweep::{
    Control, DESIGNED_FIRST, MAX_THREADS, SweepError, Workers, sweep, validate,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

use crate::arguments;
use crate::arrow_table::ArrowTable;
use crate::calls::{Tables, named};
use crate::errors::{internal, invalid, refused};
use crate::scenes::spec_dict;
use crate::worker::{self, Progress, Shared};

/// Number of points whose tables always fit into memory.
const FEW: u64 = DESIGNED_FIRST;
/// Size of the tables that are joined in one batch, in bytes.
const BATCH_BYTES: f64 = 1e8;

/// What is run at many points: scene, points, tables. Studies can be pickled.
#[pyclass(frozen, module = "iva._iva", name = "Study")]
pub struct PyStudy {
    pub study: Arc<Study>,
    pub identity: Identity,
    given: Given,
}

/// The Python arguments of the constructor, kept for pickling.
struct Given {
    spec: Py<PyDict>,
    sampling: Py<PyTuple>,
    tables: Vec<String>,
    measures: Option<Vec<String>>,
    errors: bool,
}

type Arguments<'py> =
    (Bound<'py, PyDict>, Bound<'py, PyTuple>, Vec<String>, Option<Vec<String>>, bool, (u64, u64));

#[pymethods]
impl PyStudy {
    /// `whole` is digest and number of points of the study that this is a piece of.
    #[new]
    #[pyo3(signature = (spec, sampling, tables, measures = None, errors = false, whole = None))]
    fn new(
        spec: &Bound<'_, PyDict>,
        sampling: &Bound<'_, PyTuple>,
        tables: Vec<String>,
        measures: Option<Vec<String>>,
        errors: bool,
        whole: Option<(u64, u64)>,
    ) -> PyResult<Self> {
        let points = arguments::sampling(sampling)?;
        let scene = arguments::spec(spec)?;
        let study = arguments::study(scene, points, &tables, measures.as_deref(), errors)?;
        let identity = match whole {
            Some((digest, points)) => Identity { digest, points },
            None => {
                study.sampling.check(&study.spec).map_err(invalid)?;
                Identity::of(&study).map_err(invalid)?
            }
        };
        let (spec, sampling) = (spec.clone().unbind(), sampling.clone().unbind());
        let given = Given { spec, sampling, tables, measures, errors };
        Ok(Self { study: Arc::new(study), identity, given })
    }

    /// Number of points.
    #[getter]
    fn points(&self) -> u64 {
        self.identity.points
    }

    /// Keys of what is swept.
    #[getter]
    fn swept(&self) -> Vec<String> {
        self.study.sampling.keys().map(|swept| swept.key.to_owned()).collect()
    }

    /// Runs all points; returns the tables by name. Refused if these would take more than
    /// `memory_limit` bytes.
    #[pyo3(signature = (threads = None, progress = None, memory_limit = None))]
    fn run(
        &self,
        py: Python<'_>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
        memory_limit: Option<f64>,
    ) -> PyResult<Tables> {
        let threads = count(threads)?;
        let (study, points) = (Arc::clone(&self.study), self.identity.points);
        let progress = progress.map(|callback| Progress { callback, total: points });
        let tables = worker::run(py, progress.as_ref(), move |shared| {
            let workers = if threads == Some(1) { Workers::caller() } else { workers(threads)? };
            if let Some(limit) = memory_limit {
                refuse_too_large(&study, limit, &workers, &shared.cancel)?;
            }
            // An invalid point is reported before any point is run.
            if points > DESIGNED_FIRST {
                validate(&study, &workers, &shared.cancel, &|_| {})?;
            }
            let batch = batch_points(&study, &workers, &shared.cancel)?;
            let progress = |done| shared.add(done);
            let (chunk, cancel) = (None, &shared.cancel);
            let control = Control { workers: &workers, chunk, cancel, progress: &progress };
            // Tables are joined batch by batch; joining all at once takes their memory twice.
            let mut made: BTreeMap<Table, Vec<RecordBatch>> = BTreeMap::new();
            let mut first = 0;
            while first < points && !shared.cancel.load(Ordering::Relaxed) {
                let last = points.min(first + batch);
                for (table, rows) in sweep(&study, first..last, &control)? {
                    made.entry(table).or_default().push(rows);
                }
                first = last;
            }
            Ok(made)
        })?;
        let table = |(table, batches): (Table, Vec<RecordBatch>)| {
            let schema = batches.first()?.schema();
            Some((table.name(), ArrowTable::new(schema, batches)))
        };
        Ok(tables.into_iter().filter_map(table).collect())
    }

    /// The study with the points from `first` to below `last`, as small as it can be sent elsewhere.
    fn part(&self, py: Python<'_>, first: u64, last: u64) -> PyResult<Self> {
        let Identity { digest, points } = self.identity;
        let Given { spec, sampling, tables, measures, errors } = &self.given;
        let sampling = if self.is_short(last - first) {
            sampling.bind(py).clone()
        } else {
            ("rows", self.values(first, last), first).into_pyobject(py)?
        };
        let whole = Some((digest, points));
        Self::new(spec.bind(py), &sampling, tables.clone(), measures.clone(), *errors, whole)
    }

    /// Runs the points from `first` to below `last` on one thread; returns the tables by name.
    fn run_points(&self, py: Python<'_>, first: u64, last: u64) -> PyResult<Tables> {
        let study = Arc::clone(&self.study);
        let tables = worker::run(py, None, move |shared| {
            let workers = Workers::caller();
            let (chunk, cancel) = (None, &shared.cancel);
            let progress = |done| shared.add(done);
            let control = Control { workers: &workers, chunk, cancel, progress: &progress };
            sweep(&study, first..last, &control)
        })?;
        Ok(named(tables))
    }

    /// Points of a part. Refused as in [`PyStudy::run`], and for an invalid point.
    #[pyo3(signature = (memory_limit = None))]
    fn part_points(&self, py: Python<'_>, memory_limit: Option<f64>) -> PyResult<u64> {
        let study = Arc::clone(&self.study);
        worker::run(py, None, move |shared| {
            let workers = workers(None)?;
            if let Some(limit) = memory_limit {
                refuse_too_large(&study, limit, &workers, &shared.cancel)?;
            }
            validate(&study, &workers, &shared.cancel, &|_| {})?;
            let trial = Trial::run(&study, &workers, &shared.cancel)?;
            Ok(Plan::new(&study, &trial)?.part_points)
        })
    }

    /// The points from `first` to below `last`: keys with their values.
    fn values(&self, first: u64, last: u64) -> Vec<(String, Vec<f64>)> {
        let mut columns: Vec<(String, Vec<f64>)> =
            self.study.sampling.keys().map(|swept| (swept.key.to_owned(), vec![])).collect();
        for point in first..last {
            for (column, value) in columns.iter_mut().zip(self.study.swept(point)) {
                column.1.push(value);
            }
        }
        columns
    }

    /// The whole scene of a point as a dict, what is swept in it.
    fn scene<'py>(&self, py: Python<'py>, point: u64) -> PyResult<Bound<'py, PyDict>> {
        spec_dict(py, &self.study.spec(point).map_err(invalid)?)
    }

    /// Runs the points from `first` to below `last` on one thread and writes their files into a folder;
    /// returns what they hold as JSON, for [`crate::folder::PySweepFolder::take`].
    fn run_part(
        &self,
        py: Python<'_>,
        first: u64,
        last: u64,
        folder: PathBuf,
        style: &str,
    ) -> PyResult<String> {
        let style = crate::folder::style(style)?;
        let (study, identity) = (Arc::clone(&self.study), self.identity);
        let staged = worker::run_any(py, None, move |shared: &Shared| {
            let workers = Workers::new(Some(1))?;
            let files = PartFiles::create_in(&folder, &study, identity, first..last, style)?;
            let work = PartWork { study: &study, workers: &workers, cancel: &shared.cancel };
            work.run(first..last, files, &|_: Done| {}, &|_| {})
        })?;
        let staged = staged.map_err(refused)?.ok_or_else(|| internal("a part was cancelled"))?;
        serde_json::to_string(&staged).map_err(|error| internal(&error.to_string()))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyType>, Arguments<'py>) {
        let py = slf.py();
        let Self { given, identity, .. } = slf.get();
        let whole = (identity.digest, identity.points);
        let spec = given.spec.bind(py).clone();
        let sampling = given.sampling.bind(py).clone();
        let (tables, measures) = (given.tables.clone(), given.measures.clone());
        (slf.get_type(), (spec, sampling, tables, measures, given.errors, whole))
    }
}

impl PyStudy {
    /// True if describing all points takes no more numbers than listing a given count of them.
    fn is_short(&self, points: u64) -> bool {
        match &self.study.sampling {
            Sampling::Grid(axes) => {
                let numbers: usize = axes.iter().map(|axis| axis.values.len()).sum();
                numbers as u64 <= points * axes.len() as u64
            }
            Sampling::Rows(rows) => {
                rows.axes().iter().all(|axis| axis.values.len() as u64 <= points)
            }
            // A Latin hypercube takes time: each part would have to lay it out anew.
            Sampling::Sample(sample) => sample.method != Method::LatinHypercube,
        }
    }
}

/// The number of points in one batch, whose tables take about [`BATCH_BYTES`].
fn batch_points(study: &Study, workers: &Workers, cancel: &AtomicBool) -> Result<u64, SweepError> {
    let each = memory(study, &tried(study, workers, cancel)?)? / study.points()? as f64;
    Ok((BATCH_BYTES / each).clamp(FEW as f64, MAX_PART_POINTS as f64) as u64)
}

/// A trial run of some points, from which the size of the tables is estimated; empty if no trial is needed.
fn tried(study: &Study, workers: &Workers, cancel: &AtomicBool) -> Result<Trial, SweepError> {
    let known = study.points()? <= FEW || study.tables == [Table::Summary];
    if known { Ok(Trial::default()) } else { Trial::run(study, workers, cancel) }
}

/// Refuses a sweep whose tables would take more memory than `limit`, in bytes.
fn refuse_too_large(
    study: &Study,
    limit: f64,
    workers: &Workers,
    cancel: &AtomicBool,
) -> Result<(), SweepError> {
    let points = study.points()?;
    let bytes = memory(study, &tried(study, workers, cancel)?)?;
    if bytes <= limit {
        return Ok(());
    }
    Err(Invalid::new(
        "sweep",
        format!("{points} points"),
        format!(
            "the tables would take some {:.1} GB in memory, more than memory_limit = {:.1} GB; give \
             out= a folder to write them to, ask for fewer tables or points, or raise memory_limit",
            bytes / 1e9,
            limit / 1e9
        ),
    )
    .into())
}

/// The number of threads from a Python argument; `None` means one per core.
pub fn count(threads: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    Ok(threads
        .map(|n| arguments::whole("threads", n, MAX_THREADS as u64))
        .transpose()?
        .map(|n| n as usize))
}
