//! Arrow schemas and builders of the result tables.

use std::collections::HashMap;
use std::iter;
use std::sync::{Arc, OnceLock};

use arrow_array::builder::{
    BooleanBuilder, Float64Builder, Int8Builder, Int64Builder, StringBuilder, UInt32Builder,
};
use arrow_array::{ArrayRef, RecordBatch, new_null_array};
use arrow_schema::{ArrowError, DataType, Field, FieldRef, Schema, SchemaRef};
use iva_core::error::Invalid;

use crate::cells::Cell;
use crate::columns::{Column, SCHEMA_VERSION, columns};
use crate::engine::rows::{RunRow, SummaryColumn};
use crate::fields::Quantity;
use crate::identity::Identity;
use crate::slot::Slot;
use crate::study::{Study, Table};
use crate::units::UnitSystem;

/// Sign conventions and reference frames, written to the metadata of every table.
pub const SIGN_CONVENTIONS: &str = "displacement: primary system, positive in the direction of \
     the + wall; gap displacement y = absorber - primary, walls at y = +d and y = -d with d the \
     one-sided clearance; gap velocity w = dy/dt; approach velocity: w just before an impact; \
     absorber velocities: primary velocity + w; on a moving base all are relative to it; pendulum: y = b sin(angle) with b from pivot to contact, angle from the \
     hanging position, in [-π, π], absorber velocities those of its centre of mass";

/// The Arrow schema of a table of a study, as written to its files.
///
/// Columns: `point`, in the summary the swept parameters under the names of the study, then [`columns`],
/// except swept ones. Field metadata: `unit`, `description`. Schema metadata: `iva.schema_version`,
/// `iva.version`, `iva.table`, `iva.units` (si, seconds or natural), `iva.units_sentence`,
/// `iva.sign_conventions`, `iva.swept` (comma-separated keys), `iva.study` (a digest: files with different
/// digests belong to different studies), `iva.points` (number of points of the whole study).
///
/// # Errors
/// As [`Study::units`].
pub fn schema(study: &Study, table: Table, identity: Identity) -> Result<SchemaRef, Invalid> {
    let schema = schema_in(study, table, study.units()?);
    let mut metadata = schema.metadata().clone();
    metadata.insert("iva.study".to_owned(), identity.to_string());
    metadata.insert("iva.points".to_owned(), identity.points.to_string());
    Ok(Arc::new(Schema::new_with_metadata(schema.fields().clone(), metadata)))
}

/// Name of the last column of a summary of derivatives; its value is null if the motion is never too
/// sensitive.
pub(crate) const SENSITIVE_FROM: &str = "sensitive_from";

/// The kind of numbers in a table that does not hold values.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// Errors of the values, in their units.
    Errors,
    /// Derivatives of the values with respect to a field; `key` is its name as the user wrote it.
    Derivatives {
        /// The field.
        by: Slot,
        /// Its name.
        key: String,
    },
}

impl Content {
    fn unit(&self, unit: &str, units: UnitSystem) -> String {
        match self {
            Content::Errors => unit.to_owned(),
            Content::Derivatives { by, .. } => match units.unit(by.info().quantity) {
                "1" => unit.to_owned(),
                below => format!("({unit}) per ({below})"),
            },
        }
    }

    fn description(&self, description: &str) -> String {
        match self {
            Content::Errors => format!("error of: {description}"),
            Content::Derivatives { key, .. } => format!("derivative by {key} of: {description}"),
        }
    }
}

/// The schema of a table with errors or derivatives in place of values, named in its metadata under
/// `iva.content`.
///
/// # Errors
/// As [`Study::units`].
pub(crate) fn schema_of(
    study: &Study,
    table: Table,
    content: &Content,
) -> Result<SchemaRef, Invalid> {
    let units = study.units()?;
    let plain = schema_in(study, table, units);
    let changed = |field: &Arc<Field>| {
        let mut field = Field::clone(field);
        if let (DataType::Float64, Some(text)) =
            (field.data_type(), field.metadata().get("description"))
        {
            let unit = field.metadata().get("unit").map_or("", String::as_str);
            let metadata = field_metadata(&content.unit(unit, units), &content.description(text));
            field.set_metadata(metadata);
        }
        field
    };
    let mut fields: Vec<Field> = plain.fields().iter().map(changed).collect();
    if let (Table::Summary, Content::Derivatives { .. }) = (table, content) {
        let help =
            "instant from which on rounding decides what happens, so that derivatives are null";
        let field = Field::new(SENSITIVE_FROM, DataType::Float64, true);
        fields.push(field.with_metadata(field_metadata(units.unit(Quantity::Time), help)));
    }
    let mut metadata = plain.metadata().clone();
    let name = match content {
        Content::Errors => "errors".to_owned(),
        Content::Derivatives { key, .. } => format!("derivatives by {key}"),
    };
    metadata.insert("iva.content".to_owned(), name);
    Ok(Arc::new(Schema::new_with_metadata(fields, metadata)))
}

pub(crate) fn schema_in(study: &Study, table: Table, units: UnitSystem) -> SchemaRef {
    let (point, own) = fields(table, units).split_at(1);
    let mut fields = point.to_vec();
    if table == Table::Summary {
        for swept in study.sampling.keys() {
            let info = swept.slot.info();
            fields.push(Arc::new(
                Field::new(swept.key, DataType::Float64, false)
                    .with_metadata(field_metadata(units.unit(info.quantity), info.help)),
            ));
        }
    }
    let there = |name| table == Table::Summary && study.sweeps(name);
    fields.extend(own.iter().filter(|column| !there(column.name())).cloned());
    let swept: Vec<&str> = study.sampling.keys().map(|swept| swept.key).collect();
    let metadata = [
        ("iva.schema_version", SCHEMA_VERSION.to_string()),
        ("iva.version", env!("CARGO_PKG_VERSION").to_owned()),
        ("iva.table", table.name().to_owned()),
        ("iva.units", units.name().to_owned()),
        ("iva.units_sentence", units.sentence().to_owned()),
        ("iva.sign_conventions", SIGN_CONVENTIONS.to_owned()),
        ("iva.swept", swept.join(",")),
    ];
    let metadata: HashMap<String, String> =
        metadata.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    Arc::new(Schema::new_with_metadata(fields, metadata))
}

/// The column `point` and the [`columns`] of a table as Arrow fields. They are made once in a process, for to
/// make them takes longer than a short run.
fn fields(table: Table, units: UnitSystem) -> &'static [FieldRef] {
    static FIELDS: [[OnceLock<Vec<FieldRef>>; Table::ALL.len()]; UnitSystem::ALL.len()] =
        [const { [const { OnceLock::new() }; Table::ALL.len()] }; UnitSystem::ALL.len()];
    FIELDS[units as usize][table as usize].get_or_init(|| {
        let point = Field::new("point", DataType::UInt32, false).with_metadata(field_metadata(
            "1",
            "number of the point; of a grid row-major, last axis fastest",
        ));
        let column = |column: &Column| {
            Field::new(column.name, data_type(column.quantity), true)
                .with_metadata(field_metadata(units.unit(column.quantity), column.help))
        };
        iter::once(point).chain(columns(table).iter().map(column)).map(Arc::new).collect()
    })
}

fn field_metadata(unit: &str, description: &str) -> HashMap<String, String> {
    HashMap::from([
        ("unit".to_owned(), unit.to_owned()),
        ("description".to_owned(), description.to_owned()),
    ])
}

fn data_type(quantity: Quantity) -> DataType {
    match quantity {
        Quantity::Count => DataType::Int64,
        Quantity::Side => DataType::Int8,
        Quantity::Text => DataType::Utf8,
        Quantity::Flag => DataType::Boolean,
        _ => DataType::Float64,
    }
}

enum Builder {
    Point(UInt32Builder),
    Number(Float64Builder),
    Count(Int64Builder),
    Side(Int8Builder),
    Text(StringBuilder),
    Flag(BooleanBuilder),
    /// A column of nulls, with their number.
    Nulls(DataType, usize),
}

impl Builder {
    fn new(data_type: &DataType, rows: usize) -> Self {
        match data_type {
            DataType::UInt32 => Self::Point(UInt32Builder::with_capacity(rows)),
            DataType::Int64 => Self::Count(Int64Builder::with_capacity(rows)),
            DataType::Int8 => Self::Side(Int8Builder::with_capacity(rows)),
            DataType::Utf8 => Self::Text(StringBuilder::with_capacity(rows, 8 * rows)),
            DataType::Boolean => Self::Flag(BooleanBuilder::with_capacity(rows)),
            _ => Self::Number(Float64Builder::with_capacity(rows)),
        }
    }

    /// Appends a cell; `Err` if its type is not that of the column.
    fn push(&mut self, cell: Cell) -> Result<(), Cell> {
        match (self, cell) {
            (Self::Nulls(_, count), Cell::Null) => *count += 1,
            (Self::Point(column), Cell::Point(value)) => column.append_value(value),
            // Adding +0 leaves every value unchanged except −0, which becomes 0 and so prints without a sign.
            (Self::Number(column), Cell::Number(value)) => column.append_value(value + 0.0),
            (Self::Count(column), Cell::Count(value)) => {
                column.append_option(i64::try_from(value).ok());
            }
            (Self::Side(column), Cell::Side(value)) => column.append_value(value),
            (Self::Text(column), Cell::Text(value)) => column.append_value(value),
            (Self::Flag(column), Cell::Flag(value)) => column.append_value(value),
            (Self::Number(column), Cell::Null) => column.append_null(),
            (Self::Count(column), Cell::Null) => column.append_null(),
            (Self::Side(column), Cell::Null) => column.append_null(),
            (Self::Text(column), Cell::Null) => column.append_null(),
            (Self::Flag(column), Cell::Null) => column.append_null(),
            (_, cell) => return Err(cell),
        }
        Ok(())
    }

    fn finish(&mut self) -> ArrayRef {
        match self {
            Self::Point(column) => Arc::new(column.finish()),
            Self::Number(column) => Arc::new(column.finish()),
            Self::Count(column) => Arc::new(column.finish()),
            Self::Side(column) => Arc::new(column.finish()),
            Self::Text(column) => Arc::new(column.finish()),
            Self::Flag(column) => Arc::new(column.finish()),
            Self::Nulls(data_type, count) => new_null_array(data_type, *count),
        }
    }
}

/// Builds one table, row by row or column by column.
pub(crate) struct TableBuilder {
    schema: SchemaRef,
    builders: Vec<Builder>,
    rows: usize,
    /// Description of the first row that does not fit its columns, a bug; reported when the table is
    /// finished.
    fault: Option<String>,
}

impl TableBuilder {
    /// An empty table with room for this number of rows.
    pub fn new(schema: SchemaRef, rows: usize) -> Self {
        let builder = |field: &Arc<Field>| Builder::new(field.data_type(), rows);
        let builders = schema.fields().iter().map(builder).collect();
        Self { schema, builders, rows: 0, fault: None }
    }

    /// Adds a row with one cell for each column.
    pub fn row(&mut self, cells: impl IntoIterator<Item = Cell>) {
        let mut cells = cells.into_iter();
        for (index, builder) in self.builders.iter_mut().enumerate() {
            let taken = cells.next().map(|cell| builder.push(cell));
            if !matches!(taken, Some(Ok(()))) && self.fault.is_none() {
                let (row, name) = (self.rows, self.schema.field(index).name());
                let cell = match taken {
                    Some(Err(cell)) => format!("{cell:?}"),
                    _ => "no cell".to_owned(),
                };
                self.fault = Some(format!("row {row} has {cell} in the column {name}"));
            }
        }
        if let (Some(cell), None) = (cells.next(), &self.fault) {
            self.fault = Some(format!("row {} has {cell:?} after the last column", self.rows));
        }
        self.rows += 1;
    }

    /// Adds cells to one column; all columns have to be given as many.
    pub fn column(&mut self, index: usize, cells: impl IntoIterator<Item = Cell>) {
        let builder = &mut self.builders[index];
        for (row, cell) in cells.into_iter().enumerate() {
            if let (Err(cell), None) = (builder.push(cell), &self.fault) {
                let name = self.schema.field(index).name();
                self.fault = Some(format!("row {row} has {cell:?} in the column {name}"));
            }
        }
    }

    /// Adds so many nulls to a column that has nothing else.
    pub fn nulls(&mut self, index: usize, count: usize) {
        let builder = &mut self.builders[index];
        if !matches!(builder, Builder::Nulls(..)) {
            *builder = Builder::Nulls(self.schema.field(index).data_type().clone(), 0);
        }
        if let Builder::Nulls(_, all) = builder {
            *all += count;
        }
    }

    /// The table.
    ///
    /// # Errors
    /// [`ArrowError`] if a row did not fit the columns, or they are of different lengths.
    pub fn finish(mut self) -> Result<RecordBatch, ArrowError> {
        if let Some(fault) = self.fault {
            return Err(ArrowError::InvalidArgumentError(fault));
        }
        let arrays = self.builders.iter_mut().map(Builder::finish).collect();
        RecordBatch::try_new(self.schema, arrays)
    }
}

/// Writes the rows of some points, the first of which has this number, to the table `summary`.
pub(crate) fn write_summary(
    table: &mut TableBuilder,
    study: &Study,
    columns: &[SummaryColumn],
    first: u64,
    rows: &[RunRow<'_>],
) {
    let mut swept = Vec::new();
    let points = first..first + rows.len() as u64;
    points.clone().for_each(|point| study.sampling.push_values(point, &mut swept));
    table.column(0, points.map(Cell::point));
    let keys = study.sampling.keys().count();
    for key in 0..keys {
        let values = swept.iter().skip(key).step_by(keys);
        table.column(1 + key, values.map(|value| Cell::Number(*value)));
    }
    for (index, column) in (1 + keys..).zip(columns) {
        if column.asked {
            table.column(index, rows.iter().map(|row| column.cell(row)));
        } else {
            table.nulls(index, rows.len());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds a table of a count and a number with the given second row.
    fn finished(cells: Vec<Cell>) -> Result<RecordBatch, String> {
        let fields = [DataType::Int64, DataType::Float64]
            .map(|data_type| Field::new(data_type.to_string(), data_type, true));
        let mut builder = TableBuilder::new(Arc::new(Schema::new(fields.to_vec())), 2);
        builder.row([Cell::Count(1), Cell::Null]);
        builder.row(cells);
        builder.finish().map_err(|error| error.to_string())
    }

    #[test]
    fn a_row_that_does_not_fit_its_columns_is_a_fault() {
        assert_eq!(finished(vec![Cell::Count(2), Cell::Number(0.5)]).unwrap().num_rows(), 2);
        for (cells, said) in [
            (vec![Cell::Count(2), Cell::Count(3)], "Count(3) in the column Float64"),
            (vec![Cell::Number(0.5), Cell::Null], "Number(0.5) in the column Int64"),
            (vec![Cell::Count(2)], "no cell in the column Float64"),
            (vec![Cell::Null, Cell::Null, Cell::Null], "Null after the last column"),
        ] {
            let error = finished(cells).unwrap_err();
            assert!(error.contains("row 1 has") && error.ends_with(said), "{error}");
        }
    }
}
