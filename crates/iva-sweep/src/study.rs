//! A study: one spec, the points swept over it, and the tables to write.

use std::fmt;
use std::ops::Range;

use iva_core::error::Invalid;

use crate::choices::Kind;
use crate::columns::Selection;
use crate::design::{Design, Spec};
use crate::fields::{FieldId, Part};
use crate::sampling::Sampling;
use crate::units::UnitSystem;

/// The tables that a study can write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Table {
    /// One row per point: swept parameters, then measures.
    Summary,
    /// One row per impact.
    Impacts,
    /// One row per chatter that ends in stick, plastic stick or start at rest on a wall.
    Episodes,
    /// One row per peak of the primary displacement.
    Envelope,
    /// One row per cycle of the harmonic force.
    Stroboscope,
    /// One row per absorber.
    Absorbers,
    /// The motion sampled in time (single runs only).
    Trajectory,
}

impl Table {
    /// The tables that a sweep can write.
    pub const SWEEP: [Table; 6] = [
        Table::Summary,
        Table::Impacts,
        Table::Episodes,
        Table::Envelope,
        Table::Stroboscope,
        Table::Absorbers,
    ];
    /// All tables, the trajectory last.
    pub const ALL: [Table; 7] = [
        Table::Summary,
        Table::Impacts,
        Table::Episodes,
        Table::Envelope,
        Table::Stroboscope,
        Table::Absorbers,
        Table::Trajectory,
    ];

    /// Name of the table, also as folder and key.
    pub fn name(self) -> &'static str {
        match self {
            Table::Summary => "summary",
            Table::Impacts => "impacts",
            Table::Episodes => "episodes",
            Table::Envelope => "envelope",
            Table::Stroboscope => "stroboscope",
            Table::Absorbers => "absorbers",
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

/// The points to run and the tables to write.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The fields that are not swept.
    pub spec: Spec,
    /// The points that are run.
    pub sampling: Sampling,
    /// Tables to build.
    pub tables: Vec<Table>,
    /// Summary columns to compute.
    pub measures: Selection,
    /// True if the errors of impact times are to be estimated.
    pub errors: bool,
}

/// Makes the designs of points one after another.
#[derive(Debug)]
pub struct Designer<'a> {
    study: &'a Study,
    /// The fields of the previous point; no others set a quantity that is swept.
    spec: Spec,
    /// The swept values of the previous point.
    swept: Vec<f64>,
}

impl Designer<'_> {
    /// The design of a point.
    ///
    /// # Errors
    /// As [`Study::design`].
    pub fn design(&mut self, point: u64) -> Result<Design, Invalid> {
        let mut design = self.place(point).and_then(|()| self.spec.design());
        if let Err(error) = &mut design {
            // A missing field is missing at every point, so no point is named.
            if !(self.study.sampling.is_empty() || error.value.is_empty()) {
                error.allowed = format!("{} (point {point})", error.allowed);
            }
        }
        design
    }

    /// Sets the swept values of a point.
    fn place(&mut self, point: u64) -> Result<(), Invalid> {
        let sampling = &self.study.sampling;
        self.swept.clear();
        sampling.push_values(point, &mut self.swept);
        let mut swept = sampling.keys().zip(&self.swept);
        swept.try_for_each(|(swept, value)| self.spec.set(swept.slot, *value))
    }
}

impl Study {
    /// A study of a single run with every table of a sweep.
    pub fn single(spec: Spec) -> Self {
        Self {
            spec,
            sampling: Sampling::default(),
            tables: Table::SWEEP.to_vec(),
            measures: Selection::default(),
            errors: false,
        }
    }

    /// Number of points: 1 without a sweep.
    ///
    /// # Errors
    /// As [`Sampling::points`].
    pub fn points(&self) -> Result<u64, Invalid> {
        self.sampling.points()
    }

    /// The swept values of a point, in the order of the keys.
    pub fn swept(&self, point: u64) -> Vec<f64> {
        self.sampling.values(point)
    }

    /// True if a column of the summary is a swept parameter, and so must not appear twice.
    pub fn sweeps(&self, column: &str) -> bool {
        self.sampling.keys().any(|swept| swept.key == column)
    }

    /// The fields of a point: those of the study with the swept values set.
    ///
    /// # Errors
    /// [`Invalid`] for a swept value out of range.
    pub fn spec(&self, point: u64) -> Result<Spec, Invalid> {
        let mut designer = self.designer();
        designer.place(point)?;
        Ok(designer.spec)
    }

    /// The designs of some points.
    ///
    /// # Errors
    /// As [`Study::design`].
    pub(crate) fn designs(&self, points: Range<u64>) -> Result<Vec<Design>, Invalid> {
        let mut designer = self.designer();
        points.map(|point| designer.design(point)).collect()
    }

    /// The design of a point.
    ///
    /// # Errors
    /// [`Invalid`] if the fields do not form a valid scene; the message names the point.
    pub fn design(&self, point: u64) -> Result<Design, Invalid> {
        self.designer().design(point)
    }

    /// A [`Designer`] for the designs of many points.
    pub fn designer(&self) -> Designer<'_> {
        let mut spec = self.spec.clone();
        self.sampling.keys().for_each(|swept| spec.clear(swept.slot));
        Designer { study: self, spec, swept: Vec::new() }
    }

    /// The default of a field; `None` if it is not the same number at all points, or depends on units that
    /// are not known, which a design of the study reports.
    pub fn default(&self, field: FieldId) -> Option<f64> {
        let of_primary = field.info().part == Part::Primary;
        match field {
            _ if of_primary && self.spec.structure().is_some() => None,
            FieldId::Gravity => {
                self.spec(self.sampling.first()).ok()?.standard_gravity_of(0).ok()?
            }
            FieldId::GapDisplacement if self.begins_on_a_stop() => None,
            _ => field.default(),
        }
    }

    /// True if the absorber starts on its lower stop by default: a free mass whose line of motion is inclined at some point.
    pub fn begins_on_a_stop(&self) -> bool {
        self.rises() && self.spec.choices().kind == Kind::Siva
    }

    /// True if the line of motion is inclined at some point.
    pub fn rises(&self) -> bool {
        let fields = [FieldId::Inclination, FieldId::InclinationDeg];
        let given = |field: FieldId| self.spec.get(field).is_some_and(|value| value != 0.0);
        self.sampling.sets(FieldId::Inclination.into()) || fields.into_iter().any(given)
    }

    /// The units of inputs and results: the same at every point.
    ///
    /// # Errors
    /// As [`Spec::units`].
    pub fn units(&self) -> Result<UnitSystem, Invalid> {
        self.spec(self.sampling.first())?.units()
    }
}
