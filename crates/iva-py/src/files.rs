//! Metadata, rows and checksums of result files, read by iva-store.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::Ordering;

use arrow_array::RecordBatch;
use iva_store::table_file::{self, Contents, first_damaged};
use iva_study::{StudyFile, examples};
use iva_sweep::identity::Identity;
use iva_sweep::study::Table;
use iva_sweep::tables::schema;
use pyo3::prelude::*;

use crate::arrow_table::ArrowTable;
use crate::errors::{IvaError, refused, unreadable, unreadable_study};
use crate::worker;

/// The metadata of a Parquet or Arrow file.
#[pyfunction]
pub fn metadata(py: Python<'_>, path: PathBuf) -> PyResult<BTreeMap<String, String>> {
    py.detach(|| table_file::metadata(&path)).map_err(unreadable)
}

/// The rows of a Parquet or Arrow file, read with care: nothing says that it is as it was written.
#[pyfunction]
pub fn read_table(py: Python<'_>, path: PathBuf) -> PyResult<ArrowTable> {
    let read = worker::run_any(py, None, move |_| table_file::read_table(&path))?;
    let (schema, batches) = read.map_err(unreadable)?;
    Ok(ArrowTable::new(schema, batches))
}

/// Copies the studies that come with the package into a folder; returns the files that were written.
#[pyfunction]
pub fn copy_examples(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<PathBuf>> {
    py.detach(|| examples::copy_into(&folder)).map_err(refused)
}

/// Names of the studies that come with the package, and of the records that they read.
#[pyfunction]
pub fn example_names() -> Vec<&'static str> {
    examples::FILES.iter().map(|(name, _)| *name).collect()
}

/// Checks that files have the bytes that were written, each by its size and SHA-256; raises IvaError
/// for the first that has not.
#[pyfunction]
pub fn check_files(py: Python<'_>, files: Vec<(PathBuf, u64, String)>) -> PyResult<()> {
    let contents = |(path, bytes, sha256)| (path, Contents { rows: 0, bytes, sha256 });
    let files: Vec<(PathBuf, Contents)> = files.into_iter().map(contents).collect();
    let found = worker::run_any(py, None, move |shared| {
        let go_on = || !shared.cancel.load(Ordering::Relaxed);
        first_damaged(&files, &go_on)
            .map(|found| found.map(|number| files[number].0.clone()))
            .map_err(|(number, reason)| (files[number].0.clone(), reason))
    })?;
    let named = |path: PathBuf| visible(&path.display().to_string());
    match found {
        Ok(None) => Ok(()),
        Ok(Some(path)) => Err(IvaError::new_err(format!(
            "{} is not what was written: its SHA-256 is not that of the manifest; resume the sweep to \
             compute it again, or read it as it is with check=False",
            named(path)
        ))),
        Err((path, reason)) => {
            Err(IvaError::new_err(format!("{} cannot be read: {reason}", named(path))))
        }
    }
}

/// A text with the control characters in it written out.
#[pyfunction]
pub fn visible(text: &str) -> String {
    iva_store::visible(text)
}

/// Every table of a study file by name, with columns and metadata but no rows.
#[pyfunction]
pub fn empty_tables(py: Python<'_>, path: PathBuf) -> PyResult<BTreeMap<&'static str, ArrowTable>> {
    let file = worker::run_any(py, None, move |_| iva_study::read_study(&path))?;
    tables_of(&file.map_err(unreadable_study)?).map_err(unreadable_study)
}

fn tables_of(file: &StudyFile) -> Result<BTreeMap<&'static str, ArrowTable>, iva_study::Error> {
    let located = |invalid| file.source.locate(&invalid);
    let identity = Identity::of(&file.study).map_err(located)?;
    let empty = |table: Table| {
        let schema = schema(&file.study, table, identity).map_err(located)?;
        Ok((table.name(), RecordBatch::new_empty(schema).into()))
    };
    Table::ALL.into_iter().map(empty).collect()
}
