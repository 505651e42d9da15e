//! The scene of a study file, for the explorer.

use std::path::PathBuf;

use iva_study::study_file::read_study;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{invalid, refused_study};
use crate::scenes::spec_dict;

/// The spec of one point of a study file, see [`spec_dict`].
///
/// # Errors
/// `ValueError` for a study or a point that is invalid; `IvaError` for a file that cannot be read.
#[pyfunction]
pub fn scene_of_study(py: Python<'_>, path: PathBuf, point: u64) -> PyResult<Bound<'_, PyDict>> {
    let file = read_study(&path).map_err(|error| refused_study(&error))?;
    let points = file.points().map_err(|error| refused_study(&error))?;
    if point >= points {
        let rule = format!("--point {point}: give a number from 0 to {}", points - 1);
        return Err(PyValueError::new_err(rule));
    }
    let spec = file.study.spec(point).map_err(invalid)?;
    spec.design().map_err(invalid)?;
    spec_dict(py, &spec)
}
