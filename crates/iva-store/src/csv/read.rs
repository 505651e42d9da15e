//! Reading of rows from text with commas.

use std::io::BufRead;
use std::str;
use std::sync::Arc;

use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int8Array, Int64Array, RecordBatch, StringArray,
    UInt32Array,
};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};

use super::records::{Fields, Records};

/// A reader of the rows in batches, up to the first fault.
pub(crate) struct Reader<R> {
    records: Records<R>,
    schema: SchemaRef,
    /// Number of rows of a batch.
    batch_rows: usize,
    /// Number of records read before the next batch.
    read: usize,
}

impl<R: BufRead> Reader<R> {
    /// A reader of rows with the columns of a schema, from a source that begins behind the header.
    pub(crate) fn new(source: R, schema: SchemaRef, batch_rows: usize) -> Self {
        Self { records: Records::new(source), schema, batch_rows, read: 0 }
    }

    /// A reader of numbers in columns whose names stand in the first record.
    ///
    /// # Errors
    /// [`ArrowError::CsvError`] if the source cannot be read or a name is not UTF-8.
    pub(crate) fn of_numbers(source: R, batch_rows: usize) -> Result<Self, ArrowError> {
        let mut records = Records::new(source);
        let mut names = Fields::default();
        records
            .next(&mut names, usize::MAX)
            .map_err(|reason| ArrowError::CsvError(reason.to_string()))?;
        let field = |(index, name)| match str::from_utf8(name) {
            Ok(name) => Ok(Field::new(name.trim(), DataType::Float64, true)),
            Err(reason) => Err(ArrowError::CsvError(format!(
                "Encountered UTF-8 error while reading CSV file: invalid utf-8: invalid UTF-8 in \
                 field {index} near byte index {} at line 1",
                reason.valid_up_to()
            ))),
        };
        let fields: Vec<Field> = names.iter().enumerate().map(field).collect::<Result<_, _>>()?;
        Ok(Self { records, schema: Arc::new(Schema::new(fields)), batch_rows, read: 1 })
    }

    /// The columns.
    pub(crate) fn schema(&self) -> SchemaRef {
        self.schema.clone()
    }

    fn batch(&mut self) -> Result<Option<RecordBatch>, ArrowError> {
        let expected = self.schema.fields().len();
        let mut fields = Fields::default();
        let mut rows = 0;
        while rows < self.batch_rows
            && let Some(got) = self.records.next(&mut fields, expected)?
        {
            rows += 1;
            if got != expected {
                return Err(ArrowError::CsvError(format!(
                    "incorrect number of fields for line {}, expected {expected} got {got}",
                    self.read + rows
                )));
            }
        }
        if rows == 0 {
            return Ok(None);
        }
        let cells = Cells::new(&fields, expected, self.read)?;
        self.read += rows;
        let columns = self.schema.fields().iter().enumerate();
        let columns = columns.map(|(column, field)| cells.array(column, field.data_type()));
        RecordBatch::try_new(self.schema.clone(), columns.collect::<Result<_, _>>()?).map(Some)
    }
}

impl<R: BufRead> Iterator for Reader<R> {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.batch().transpose()
    }
}

/// The cells of the rows of a batch.
struct Cells<'t> {
    texts: Vec<&'t str>,
    columns: usize,
    /// Number of records before the first row.
    before: usize,
}

impl<'t> Cells<'t> {
    /// # Errors
    /// [`ArrowError::CsvError`] if a field is not UTF-8.
    fn new(fields: &'t Fields, columns: usize, before: usize) -> Result<Self, ArrowError> {
        let text = |(index, bytes)| {
            str::from_utf8(bytes).map_err(|_| {
                let (line, field) = (before + index / columns + 1, index % columns + 1);
                ArrowError::CsvError(format!(
                    "Encountered invalid UTF-8 data for line {line} and field {field}"
                ))
            })
        };
        let texts = fields.iter().enumerate().map(text).collect::<Result<_, _>>()?;
        Ok(Self { texts, columns, before })
    }

    /// A column with values of a type.
    ///
    /// # Errors
    /// [`ArrowError::ParseError`] if a cell is no such value, or no table has such values.
    fn array(&self, column: usize, kind: &DataType) -> Result<ArrayRef, ArrowError> {
        match kind {
            DataType::Float64 => self.parsed::<Float64Array, _>(column, kind, number),
            DataType::Int64 => self.parsed::<Int64Array, i64>(column, kind, whole),
            DataType::Int8 => self.parsed::<Int8Array, i8>(column, kind, whole),
            DataType::UInt32 => self.parsed::<UInt32Array, u32>(column, kind, whole),
            DataType::Boolean => self.parsed::<BooleanArray, _>(column, kind, truth),
            DataType::Utf8 => self.parsed::<StringArray, _>(column, kind, Some),
            other => Err(ArrowError::ParseError(format!("Unsupported data type {other:?}"))),
        }
    }

    /// A column of cells that `parse` reads; an empty one has no value.
    fn parsed<A, T>(
        &self,
        column: usize,
        kind: &DataType,
        parse: impl Fn(&'t str) -> Option<T>,
    ) -> Result<ArrayRef, ArrowError>
    where
        A: Array + FromIterator<Option<T>> + 'static,
    {
        let rows = self.texts.chunks_exact(self.columns).enumerate();
        let values = rows.map(|(row, cells)| match cells[column] {
            "" => Ok(None),
            cell => parse(cell).map(Some).ok_or_else(|| {
                ArrowError::ParseError(format!(
                    "Error while parsing value '{cell}' as type '{kind}' for column {column} at \
                     line {}. Row data: '[{}]'",
                    self.before + row,
                    cells.join(",")
                ))
            }),
        });
        Ok(Arc::new(values.collect::<Result<A, _>>()?))
    }
}

fn number(cell: &str) -> Option<f64> {
    cell.trim_ascii().parse().ok()
}

fn whole<T: TryFrom<i64>>(cell: &str) -> Option<T> {
    cell.trim_ascii().parse::<i64>().ok()?.try_into().ok()
}

fn truth(cell: &str) -> Option<bool> {
    [false, true].into_iter().find(|truth| cell.eq_ignore_ascii_case(&truth.to_string()))
}
