//! The forces of a scene as given by the user.

use std::sync::Arc;

pub use iva_core::force::History;

use crate::fields::FieldId;

/// Index of the first field of a force; these fields are contiguous in the table.
const FIRST: usize = FieldId::Amplitude as usize;
/// Number of fields of a force.
const COUNT: usize = FieldId::RecordScale as usize - FIRST + 1;

/// The quantity that the values of a record give.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RecordKind {
    /// f/M, an acceleration.
    Force,
    /// f in N; needs a mass.
    ForceNewtons,
    /// Acceleration of the base.
    BaseAcceleration,
}

impl RecordKind {
    /// All kinds.
    pub const ALL: [RecordKind; 3] =
        [RecordKind::Force, RecordKind::ForceNewtons, RecordKind::BaseAcceleration];

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            RecordKind::Force => "force",
            RecordKind::ForceNewtons => "force_newtons",
            RecordKind::BaseAcceleration => "base_acceleration",
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<RecordKind> {
        RecordKind::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// A column of a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Column {
    /// The one with this name, with or without its unit.
    Named(String),
    /// The one with this index, from 0.
    At(usize),
}

/// What of a file of a record is read, and what the file does not say itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Selection {
    /// The column of the values.
    pub column: Option<Column>,
    /// The column of the times.
    pub time: Option<Column>,
    /// The unit of the values, 1 for that of the study.
    pub unit: Option<String>,
    /// The sampling rate in Hz of a file without times.
    pub sampling_hz: Option<f64>,
}

/// A recorded force: times and values in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// Times and values.
    pub history: Arc<History>,
    /// The quantity of the values.
    pub kind: RecordKind,
    /// The file it was read from, if any, in the form in which a study file names it.
    pub file: Option<String>,
    /// What of that file was read.
    pub selection: Selection,
    /// True if the file says that times are in s and values in m/s².
    pub is_metric: bool,
}

/// One force as given.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceSpec {
    values: [Option<f64>; COUNT],
    /// The points of a recorded force.
    pub record: Option<Recorded>,
}

/// The kinds of force: each has its own fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Nature {
    Harmonic,
    Impulse,
    Record,
}

impl Nature {
    pub fn of(field: FieldId) -> Nature {
        use FieldId as F;
        match field {
            F::ImpulseVelocity | F::ImpulseMomentum | F::ImpulseTime => Nature::Impulse,
            F::RecordScale => Nature::Record,
            _ => Nature::Harmonic,
        }
    }

    pub fn words(self) -> &'static str {
        match self {
            Nature::Harmonic => "a harmonic force",
            Nature::Impulse => "an impulse",
            Nature::Record => "a recorded force",
        }
    }
}

impl ForceSpec {
    /// A force without fields.
    pub fn new(record: Option<Recorded>) -> Self {
        Self { values: [None; COUNT], record }
    }

    pub(crate) fn get(&self, field: FieldId) -> Option<f64> {
        self.values[field as usize - FIRST]
    }

    pub(crate) fn put(&mut self, field: FieldId, value: Option<f64>) {
        self.values[field as usize - FIRST] = value;
    }

    pub(crate) fn given(&self) -> impl Iterator<Item = (FieldId, f64)> + '_ {
        let given = |field| self.get(field).map(|value| (field, value));
        FieldId::all().skip(FIRST).take(COUNT).filter_map(given)
    }

    pub(crate) fn nature(&self) -> Nature {
        if self.record.is_some() {
            return Nature::Record;
        }
        let impulse = self.given().any(|(field, _)| Nature::of(field) == Nature::Impulse);
        if impulse { Nature::Impulse } else { Nature::Harmonic }
    }

    /// True if it acts all the time and not as an impulse; then nothing decays by itself.
    pub fn lasts(&self) -> bool {
        self.nature() != Nature::Impulse
    }

    /// True of a record or an impulse that acts on the structure, not on its base.
    pub(crate) fn is_bound(&self) -> bool {
        match &self.record {
            Some(record) => record.kind != RecordKind::BaseAcceleration,
            None => self.nature() == Nature::Impulse,
        }
    }

    /// True if a field does not belong to a force of this kind.
    pub fn is_foreign(&self, field: FieldId) -> bool {
        Nature::of(field) != self.nature()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fields::Part;

    #[test]
    fn the_fields_of_a_force_stand_together() {
        let of_force = FieldId::all().filter(|field| field.info().part == Part::Force);
        let places: Vec<usize> = of_force.map(|field| field as usize).collect();
        assert_eq!(places, Vec::from_iter(FIRST..FIRST + COUNT));
    }
}
