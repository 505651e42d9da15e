//! Recorded forces for Python, each checked once and shared by all scenes that it drives.

use std::path::PathBuf;
use std::sync::Arc;

use iva_store::visible;
use iva_study::record_file::{self, RecordUnit, read_record as read};
use iva_sweep::Invalid;
use iva_sweep::forces::{History, RecordKind, Recorded, Selection};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::errors::{invalid, unreadable_study};
use crate::worker;

/// Increasing times with a value each, and what the values are.
#[pyclass(frozen, eq, module = "iva._iva", name = "Record")]
#[derive(PartialEq)]
pub struct PyRecord(Recorded);

fn kind_of(name: &str) -> PyResult<RecordKind> {
    RecordKind::from_name(name).ok_or_else(|| {
        let known = RecordKind::ALL.map(RecordKind::name).join("\", \"");
        invalid(Invalid::new("kind", format!("\"{name}\""), format!("give one of \"{known}\"")))
    })
}

#[pymethods]
impl PyRecord {
    #[new]
    #[pyo3(signature = (times, values, kind, is_metric = false))]
    fn new(times: Vec<f64>, values: Vec<f64>, kind: &str, is_metric: bool) -> PyResult<Self> {
        let kind = kind_of(kind)?;
        let history = Arc::new(History::new(times, values).map_err(invalid)?);
        let selection = Selection::default();
        Ok(Self(Recorded { history, kind, file: None, selection, is_metric }))
    }

    #[getter]
    fn times(&self) -> Vec<f64> {
        self.0.history.times().to_vec()
    }

    #[getter]
    fn values(&self) -> Vec<f64> {
        self.0.history.values().to_vec()
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.0.kind.name()
    }

    /// Whether times are in s and values in m/s².
    #[getter]
    fn is_metric(&self) -> bool {
        self.0.is_metric
    }

    #[allow(clippy::type_complexity)] // what pickle asks for
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> (Bound<'py, PyType>, (Vec<f64>, Vec<f64>, &'static str, bool)) {
        let record = slf.get();
        let given = (record.times(), record.values(), record.kind(), record.0.is_metric);
        (slf.get_type(), given)
    }
}

impl PyRecord {
    pub fn of(recorded: Recorded) -> Self {
        Self(recorded)
    }

    pub fn recorded(&self) -> Recorded {
        self.0.clone()
    }
}

/// The record of a file; of an AT2 file the kind is known.
#[pyfunction]
#[pyo3(signature = (path, kind = None))]
pub fn read_record(py: Python<'_>, path: PathBuf, kind: Option<&str>) -> PyResult<PyRecord> {
    let kind = kind.map(kind_of).transpose()?;
    // Reading a large file takes seconds, in which other threads may use Python.
    let read = worker::run_any(py, None, move |_| read(&path))?;
    let file = read.map_err(|error| match error {
        iva_study::Error::UnreadableRecord { .. } => unreadable_study(error),
        other => PyValueError::new_err(visible(&other.to_string())),
    })?;
    let is_metric = file.unit == RecordUnit::MetresPerSecondSquared;
    let known = if is_metric { RecordKind::BaseAcceleration } else { RecordKind::Force };
    let history = History::new(file.times, file.values).map_err(invalid)?;
    let kind = kind.unwrap_or(known);
    let (history, selection) = (Arc::new(history), Selection::default());
    Ok(PyRecord(Recorded { history, kind, file: None, selection, is_metric }))
}

/// What a file is by its first lines, in one word; `None` for any text that is none of the kinds that are known.
#[pyfunction]
pub fn kind_of_file(contents: &[u8]) -> Option<&'static str> {
    record_file::kind_of_file(contents).map(record_file::FileKind::name)
}
