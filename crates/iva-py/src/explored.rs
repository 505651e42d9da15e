//! The scene of a study file, for the explorer.

use std::path::PathBuf;

use iva_study::study_file::read_study;
use iva_sweep::watched::{TAKEN, takes};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::errors::{invalid, refused_study};

/// Choices by name and numbers by path.
type Explored = (Vec<(&'static str, &'static str)>, Vec<(String, f64)>);

/// The choices and the numbers of one point of a study file.
///
/// # Errors
/// `ValueError` for a study or a point that is invalid, or a scene that the explorer does not take; `IvaError` for a file
/// that cannot be read.
#[pyfunction]
pub fn scene_of_study(path: PathBuf, point: u64) -> PyResult<Explored> {
    let file = read_study(&path).map_err(|error| refused_study(&error))?;
    let points = file.points().map_err(|error| refused_study(&error))?;
    if point >= points {
        let rule = format!("--point {point}: give a number from 0 to {}", points - 1);
        return Err(PyValueError::new_err(rule));
    }
    let spec = file.study.spec(point).map_err(invalid)?;
    if spec.restitution_table(0).is_some() {
        let rule = "absorber.restitution_table: the explorer takes none; give a number";
        return Err(PyValueError::new_err(rule));
    }
    let design = spec.design().map_err(invalid)?;
    if !takes(&design) {
        return Err(PyValueError::new_err(format!("force: {TAKEN}")));
    }
    let numbers = spec.given().map(|(slot, value)| (slot.path(), value));
    Ok((spec.choices().words().collect(), numbers.collect()))
}
