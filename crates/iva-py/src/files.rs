//! What the files of a result say of themselves; iva-cli reads them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use arrow_array::RecordBatch;
use iva_cli::table_file;
use iva_sweep::identity::Identity;
use iva_sweep::study::Table;
use iva_sweep::tables::schema;
use pyo3::prelude::*;

use crate::arrow_table::ArrowTable;
use crate::errors::unreadable;

/// The metadata of an Arrow file.
#[pyfunction]
pub fn metadata(path: PathBuf) -> PyResult<BTreeMap<String, String>> {
    table_file::metadata(&path).map_err(unreadable)
}

/// Every table of a study file by name, with columns and metadata but no rows.
#[pyfunction]
pub fn empty_tables(path: PathBuf) -> PyResult<BTreeMap<&'static str, ArrowTable>> {
    let file = iva_cli::read_study(&path).map_err(unreadable)?;
    let identity =
        Identity::of(&file.study).map_err(|invalid| unreadable(file.source.locate(&invalid)))?;
    let empty = |table: Table| {
        let schema = schema(&file.study, table, identity)
            .map_err(|invalid| unreadable(file.source.locate(&invalid)))?;
        Ok((table.name(), ArrowTable(RecordBatch::new_empty(schema))))
    };
    Table::ALL.into_iter().map(empty).collect()
}
