//! What `iva optimise` needs: the scene of a study file, samples of distributions, and ranges of fields.

use std::path::PathBuf;

use iva_study::study_file::read_optimised;
use iva_sweep::slot::Slot;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arguments;
use crate::errors::{invalid, refused_study};
use crate::scenes::spec_dict;

/// The spec of the scene of a study file with a section `[optimise]`, as [`arguments::spec`] takes it.
///
/// # Errors
/// `ValueError` for an invalid study; `IvaError` for a file that cannot be read.
#[pyfunction]
pub fn optimised_scene(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let file = read_optimised(&path).map_err(|error| refused_study(&error))?;
    spec_dict(py, &file.study.spec)
}

/// The first `count` points of a sample: keys with their values, which no scene has checked, because they may be
/// what is added to a field.
///
/// # Errors
/// `ValueError` for an unknown key, a distribution out of range, or too many points.
#[pyfunction]
pub fn sampled(sampling: &Bound<'_, PyTuple>) -> PyResult<Vec<(String, Vec<f64>)>> {
    let sampling = arguments::sampling(sampling)?;
    let mut columns: Vec<(String, Vec<f64>)> =
        sampling.keys().map(|swept| (swept.key.to_owned(), vec![])).collect();
    for point in sampling.first()..sampling.points().map_err(invalid)? {
        for (column, value) in columns.iter_mut().zip(sampling.values(point)) {
            column.1.push(value);
        }
    }
    Ok(columns)
}

/// Whether each of some values of a field is in its range; NaN is not.
///
/// # Errors
/// `ValueError` for an unknown key.
#[pyfunction]
pub fn in_range(key: &str, values: Vec<f64>) -> PyResult<Vec<bool>> {
    let slot = Slot::from_key(key).map_err(invalid)?;
    Ok(values.into_iter().map(|value| slot.check(value).is_ok()).collect())
}
