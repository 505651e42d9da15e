//! Result tables for Python, passed by the Arrow C stream interface.

use std::collections::BTreeMap;

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{RecordBatch, RecordBatchIterator};
use arrow_schema::SchemaRef;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

/// A table that any reader of the Arrow C stream interface takes without copying.
///
/// `polars.DataFrame(table)` is such a reader.
#[pyclass(frozen, module = "iva._iva")]
pub struct ArrowTable {
    schema: SchemaRef,
    /// The rows in batches, not joined, because joining takes the memory of the table twice.
    batches: Vec<RecordBatch>,
}

impl ArrowTable {
    /// A table of batches of rows that have one schema.
    pub fn new(schema: SchemaRef, batches: Vec<RecordBatch>) -> Self {
        Self { schema, batches }
    }
}

impl From<RecordBatch> for ArrowTable {
    fn from(rows: RecordBatch) -> Self {
        Self { schema: rows.schema(), batches: vec![rows] }
    }
}

#[pymethods]
impl ArrowTable {
    /// Schema metadata: layout and package version, units, sign conventions.
    #[getter]
    fn metadata(&self) -> BTreeMap<String, String> {
        let entries = self.schema.metadata().iter();
        entries.map(|(k, v)| (k.clone(), v.clone())).collect()
    }

    /// Unit of every column, as its field metadata states it.
    #[getter]
    fn units(&self) -> BTreeMap<String, String> {
        let fields = self.schema.fields().iter();
        fields
            .filter_map(|field| {
                let unit = field.metadata().get("unit")?;
                Some((field.name().clone(), unit.clone()))
            })
            .collect()
    }

    /// A new Arrow C stream over the table; a requested schema is not followed.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        let batches: Vec<_> = self.batches.iter().cloned().map(Ok).collect();
        let batches = RecordBatchIterator::new(batches, self.schema.clone());
        // The capsule frees the stream unless a consumer took it and marked it as released.
        let stream = FFI_ArrowArrayStream::new(Box::new(batches));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    fn __repr__(&self) -> String {
        format!(
            "<iva._iva.ArrowTable: {} rows, {} columns>",
            self.batches.iter().map(RecordBatch::num_rows).sum::<usize>(),
            self.schema.fields().len()
        )
    }
}
