//! A study: one spec, the axes swept over it, and what is to be written.

use std::fmt;

use iva_core::error::Invalid;

use crate::choices::{Kind, only};
use crate::columns::Selection;
use crate::design::{Design, Spec};
use crate::slot::Slot;
use crate::units::UnitSystem;

/// More points than this are refused: `point` is a 32-bit column.
pub const MAX_POINTS: u64 = 1 << 32;
/// More values of an equidistant axis are refused before they are made: these take 80 MB.
pub const MAX_VALUES: u64 = 10_000_000;

/// The tables a study can write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Table {
    /// One row a point: swept parameters, then measures.
    Summary,
    /// One row an impact.
    Impacts,
    /// One row a chatter that ends in stick, a plastic stick or a start at rest on a wall.
    Episodes,
    /// One row a peak of the primary displacement.
    Envelope,
    /// One row a cycle of the harmonic force.
    Stroboscope,
    /// The motion sampled in time (single runs only).
    Trajectory,
}

impl Table {
    /// The tables a sweep can write.
    pub const SWEEP: [Table; 5] =
        [Table::Summary, Table::Impacts, Table::Episodes, Table::Envelope, Table::Stroboscope];
    /// All tables, the trajectory last.
    pub const ALL: [Table; 6] = [
        Table::Summary,
        Table::Impacts,
        Table::Episodes,
        Table::Envelope,
        Table::Stroboscope,
        Table::Trajectory,
    ];

    /// Folder and key of the table.
    pub fn name(self) -> &'static str {
        match self {
            Table::Summary => "summary",
            Table::Impacts => "impacts",
            Table::Episodes => "episodes",
            Table::Envelope => "envelope",
            Table::Stroboscope => "stroboscope",
            Table::Trajectory => "trajectory",
        }
    }

    /// The table of that name.
    pub fn from_name(name: &str) -> Option<Table> {
        Table::ALL.into_iter().find(|table| table.name() == name)
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One axis of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The key as the user wrote it: the name of its column in the summary.
    pub key: String,
    /// The field it sets.
    pub slot: Slot,
    /// Its values, in the order given.
    pub values: Vec<f64>,
}

impl Axis {
    /// Reads the key and checks every value against the field's range.
    ///
    /// # Errors
    /// [`Invalid`] for an unknown or ambiguous key, no values, or a value out of range.
    pub fn new(key: &str, values: Vec<f64>) -> Result<Self, Invalid> {
        let slot = Slot::from_key(key)?;
        if values.is_empty() {
            return Err(Invalid::new(format!("sweep.{key}"), "[]", "give at least one value"));
        }
        for (index, value) in values.iter().enumerate() {
            slot.check(*value)
                .map_err(|error| Invalid { field: format!("sweep.{key}[{index}]"), ..error })?;
        }
        Ok(Self { key: key.to_owned(), slot, values })
    }

    /// `count` equidistant values from `start` to `stop`, both included.
    ///
    /// # Errors
    /// As [`Axis::new`]; also for a `count` of zero or beyond [`MAX_VALUES`], or one value over an
    /// interval.
    pub fn linspace(key: &str, start: f64, stop: f64, count: u64) -> Result<Self, Invalid> {
        if count == 0 || count > MAX_VALUES {
            return Err(Invalid::new(
                format!("sweep.{key}.count"),
                count,
                format!("give a whole number from 1 to {MAX_VALUES}"),
            ));
        }
        if count == 1 && start != stop {
            return Err(Invalid::new(
                format!("sweep.{key}.count"),
                count,
                "one value cannot span start to stop; give 2 or more",
            ));
        }
        // Rounded as numpy.linspace rounds, so that a study and a Python sweep have equal values.
        let step = (stop - start) / (count.max(2) - 1) as f64;
        let mut values: Vec<f64> = (0..count).map(|i| i as f64 * step + start).collect();
        if let [_, .., last] = values.as_mut_slice() {
            *last = stop;
        }
        Self::new(key, values)
    }
}

/// Checks that no two axes sweep the same quantity: the later would silently replace the earlier.
///
/// # Errors
/// [`Invalid`] naming the later axis.
pub fn distinct(axes: &[Axis]) -> Result<(), Invalid> {
    for (index, axis) in axes.iter().enumerate() {
        let same = axes[..index].iter().find(|earlier| earlier.slot.same_quantity(axis.slot));
        if let Some(earlier) = same {
            return Err(Invalid::new(
                format!("sweep.{}", axis.key),
                format!("{} values", axis.values.len()),
                format!("sweep.{} sets the same quantity; give one of them", earlier.key),
            ));
        }
    }
    Ok(())
}

/// Checks that the kind of absorber has what is swept.
///
/// # Errors
/// [`Invalid`] naming the axis.
pub fn fitting(kind: Kind, axes: &[Axis]) -> Result<(), Invalid> {
    for axis in axes {
        if let Some(other) = axis.slot.info().kind.filter(|other| *other != kind) {
            let values = format!("{} values", axis.values.len());
            return Err(Invalid::new(format!("sweep.{}", axis.key), values, only(other)));
        }
    }
    Ok(())
}

/// What to run and what to write.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The fields that are not swept.
    pub spec: Spec,
    /// The swept axes, slowest first.
    pub axes: Vec<Axis>,
    /// Tables to build.
    pub tables: Vec<Table>,
    /// Summary columns to compute.
    pub measures: Selection,
    /// Estimate the errors of impact times.
    pub errors: bool,
}

impl Study {
    /// A study of a single run with every table of a sweep.
    pub fn single(spec: Spec) -> Self {
        Self {
            spec,
            axes: Vec::new(),
            tables: Table::SWEEP.to_vec(),
            measures: Selection::all(),
            errors: false,
        }
    }

    /// Number of points: the product of the axes' lengths, 1 without axes.
    ///
    /// # Errors
    /// [`Invalid`] beyond 2³² points.
    pub fn points(&self) -> Result<u64, Invalid> {
        let product = self
            .axes
            .iter()
            .try_fold(1u64, |product, axis| product.checked_mul(axis.values.len() as u64))
            .filter(|points| *points <= MAX_POINTS);
        product.ok_or_else(|| {
            let lengths: Vec<String> =
                self.axes.iter().map(|axis| axis.values.len().to_string()).collect();
            Invalid::new("sweep", lengths.join(" × "), "a grid has at most 2^32 points")
        })
    }

    /// The index into each axis of a point; the last axis runs fastest.
    pub fn indices(&self, point: u64) -> Vec<usize> {
        let mut rest = point;
        let mut indices = vec![0; self.axes.len()];
        for (slot, axis) in indices.iter_mut().zip(&self.axes).rev() {
            let length = axis.values.len() as u64;
            *slot = (rest % length) as usize;
            rest /= length;
        }
        indices
    }

    /// The swept values of a point, in the order of the axes.
    pub fn swept(&self, point: u64) -> impl Iterator<Item = f64> + '_ {
        self.axes.iter().zip(self.indices(point)).map(|(axis, index)| axis.values[index])
    }

    /// The fields of a point: those of the study with the swept ones in place.
    ///
    /// # Errors
    /// [`Invalid`] for a swept value out of range, which [`Axis::new`] has excluded.
    pub fn spec(&self, point: u64) -> Result<Spec, Invalid> {
        let mut spec = self.spec.clone();
        for (axis, value) in self.axes.iter().zip(self.swept(point)) {
            spec.replace(axis.slot, value)?;
        }
        Ok(spec)
    }

    /// The design of a point.
    ///
    /// # Errors
    /// [`Invalid`] if the fields together make no valid scene; the message names the point.
    pub fn design(&self, point: u64) -> Result<Design, Invalid> {
        self.spec(point)?.design().map_err(|error| {
            // What is missing is missing at every point.
            if self.axes.is_empty() || error.value.is_empty() {
                error
            } else {
                Invalid { allowed: format!("{} (point {point})", error.allowed), ..error }
            }
        })
    }

    /// The units of inputs and results: the same at every point.
    ///
    /// # Errors
    /// As [`Spec::units`].
    pub fn units(&self) -> Result<UnitSystem, Invalid> {
        self.spec(0)?.units()
    }
}
