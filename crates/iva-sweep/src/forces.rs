//! The forces of a scene as given, each in one of several ways, and what the core makes of them.

use std::f64::consts::TAU;
use std::sync::Arc;

use iva_core::error::{Invalid, number};
pub use iva_core::force::History;
use iva_core::force::{Acts, Force, Harmonic, Impulse, Record};

use crate::fields::{FieldId, Part};
use crate::slot::Slot;
use crate::units::{Scale, UnitSystem};

/// Fields of a force: they stand together in the table.
const FIRST: usize = FieldId::Amplitude as usize;
const COUNT: usize = FieldId::RecordScale as usize - FIRST + 1;

/// What the values of a record are.
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

/// A recorded force: times and values in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// The points.
    pub history: Arc<History>,
    /// What the values are.
    pub kind: RecordKind,
    /// The file it was read from, if any, as a study file can name it.
    pub file: Option<String>,
    /// True if the file says that times are in s and values in m/s².
    pub is_metric: bool,
}

/// One force as given.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceSpec {
    values: [Option<f64>; COUNT],
    /// Of a recorded force its points.
    pub record: Option<Recorded>,
}

/// The ways to give a force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Nature {
    Harmonic,
    Impulse,
    Record,
}

impl Nature {
    fn of(field: FieldId) -> Nature {
        use FieldId as F;
        match field {
            F::ImpulseVelocity | F::ImpulseMomentum | F::ImpulseTime => Nature::Impulse,
            F::RecordScale => Nature::Record,
            _ => Nature::Harmonic,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Nature::Harmonic => "a harmonic force",
            Nature::Impulse => "an impulse",
            Nature::Record => "a recorded force",
        }
    }
}

impl ForceSpec {
    /// Nothing given yet.
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
        FieldId::all()
            .filter(|field| field.info().part == Part::Force)
            .filter_map(|field| self.get(field).map(|value| (field, value)))
    }

    fn nature(&self) -> Nature {
        if self.record.is_some() {
            return Nature::Record;
        }
        let impulse = self.given().any(|(field, _)| Nature::of(field) == Nature::Impulse);
        if impulse { Nature::Impulse } else { Nature::Harmonic }
    }

    /// True if it acts all the time: nothing decays by itself then.
    pub fn lasts(&self) -> bool {
        self.nature() != Nature::Impulse
    }

    /// True if a field has no place in such a force.
    pub fn is_foreign(&self, field: FieldId) -> bool {
        Nature::of(field) != self.nature()
    }
}

/// What is needed to read one force: the fields, their names and the units.
struct Reader<'a> {
    spec: &'a ForceSpec,
    number: usize,
    count: usize,
    scale: &'a Scale,
    units: UnitSystem,
}

/// The sum of the forces in natural units.
///
/// # Errors
/// [`Invalid`] if something is missing, given twice, of another kind of force, or needs a mass.
pub(crate) fn force(
    forces: &[ForceSpec],
    scale: &Scale,
    units: UnitSystem,
) -> Result<Force, Invalid> {
    let (mut harmonics, mut records, mut impulses) = (Vec::new(), Vec::new(), Vec::new());
    for (number, spec) in forces.iter().enumerate() {
        let reader = Reader { spec, number, count: forces.len(), scale, units };
        reader.check_nature()?;
        match (&spec.record, spec.nature()) {
            (Some(recorded), _) => records.push(reader.record(recorded)?),
            (None, Nature::Impulse) => impulses.push(reader.impulse()?),
            (None, _) => harmonics.push(reader.harmonic()?),
        }
    }
    Force::new(harmonics, records, &impulses)
}

impl Reader<'_> {
    fn path(&self, field: FieldId) -> String {
        Slot::of_force(field, self.number, self.count).path()
    }

    /// The path of what is no number.
    fn named(&self, name: &str) -> String {
        self.path(FieldId::RecordScale).replace("scale", name)
    }

    fn get(&self, field: FieldId) -> Option<f64> {
        self.spec.get(field)
    }

    fn check_nature(&self) -> Result<(), Invalid> {
        let nature = self.spec.nature();
        let foreign = self.spec.given().find(|(field, _)| self.spec.is_foreign(*field));
        let Some((field, value)) = foreign else { return Ok(()) };
        let (other, own) = (Nature::of(field).words(), nature.words());
        let alone = self.spec.given().all(|(field, _)| self.spec.is_foreign(field));
        let rule = if alone {
            format!("that is of {other}, and there is none")
        } else {
            format!("that is of {other}, but this is {own}; give two forces")
        };
        Err(Invalid::new(self.path(field), number(value), rule))
    }

    fn at_most_one(&self, fields: &[FieldId]) -> Result<(), Invalid> {
        let mut given = fields.iter().filter(|field| self.get(**field).is_some());
        match (given.next(), given.next()) {
            (Some(first), Some(second)) => Err(Invalid::new(
                self.path(*second),
                self.get(*second).map_or(String::new(), number),
                format!("{} is given as well; give one of them", self.path(*first)),
            )),
            _ => Ok(()),
        }
    }

    /// Turns N into f/M, N s into P/M.
    fn per_mass(&self, name: &str, value: f64, alternative: &str) -> Result<f64, Invalid> {
        if self.units == UnitSystem::Si {
            return Ok(value / self.scale.mass);
        }
        let rule = format!(
            "give primary.mass with stiffness or natural_frequency as well, or give {alternative}"
        );
        Err(Invalid::new(name, number(value), rule))
    }

    fn stiffness(&self) -> f64 {
        self.scale.natural_frequency * self.scale.natural_frequency
    }

    fn harmonic(&self) -> Result<Harmonic, Invalid> {
        let (amplitude, acts) = self.amplitude()?;
        let phase = self.get(FieldId::Phase).unwrap_or(0.0);
        Ok(Harmonic { amplitude, frequency: self.frequency()?, phase, acts })
    }

    fn amplitude(&self) -> Result<(f64, Acts), Invalid> {
        let fields = [FieldId::Amplitude, FieldId::ForceAmplitude, FieldId::BaseAcceleration];
        self.at_most_one(&fields)?;
        let [acceleration, force, base] = fields.map(|field| self.get(field));
        if let Some(acceleration) = acceleration {
            return Ok((acceleration / self.stiffness(), Acts::Primary));
        }
        if let Some(base) = base {
            return Ok((base / self.stiffness(), Acts::Base));
        }
        let Some(force) = force else {
            return Err(Invalid::missing(
                self.path(FieldId::Amplitude),
                "give amplitude (f/M), force (N, needs a mass) or base_acceleration",
            ));
        };
        let name = self.path(FieldId::ForceAmplitude);
        Ok((self.per_mass(&name, force, "amplitude (f/M)")? / self.stiffness(), Acts::Primary))
    }

    fn frequency(&self) -> Result<f64, Invalid> {
        let fields =
            [FieldId::ForceFrequency, FieldId::RelativeFrequency, FieldId::ForceFrequencyHz];
        self.at_most_one(&fields)?;
        let [absolute, relative, hertz] = fields.map(|field| self.get(field));
        let natural = self.scale.natural_frequency;
        relative
            .or_else(|| absolute.map(|frequency| frequency / natural))
            .or_else(|| hertz.map(|frequency| TAU * frequency / natural))
            .ok_or_else(|| {
                Invalid::missing(
                    self.path(FieldId::ForceFrequency),
                    "give frequency (rad/s), frequency_hz or relative_frequency (over that of the \
                     bare primary)",
                )
            })
    }

    fn impulse(&self) -> Result<Impulse, Invalid> {
        let fields = [FieldId::ImpulseVelocity, FieldId::ImpulseMomentum];
        self.at_most_one(&fields)?;
        let velocity = match fields.map(|field| self.get(field)) {
            [Some(velocity), _] => velocity,
            [None, Some(impulse)] => {
                let name = self.path(FieldId::ImpulseMomentum);
                self.per_mass(&name, impulse, "velocity (impulse over mass)")?
            }
            [None, None] => {
                return Err(Invalid::missing(
                    self.path(FieldId::ImpulseVelocity),
                    "give velocity (impulse over mass) or impulse (N s, needs a mass)",
                ));
            }
        };
        let natural = self.scale.natural_frequency;
        let time = self.get(FieldId::ImpulseTime).unwrap_or(0.0) * natural;
        Ok(Impulse { velocity: velocity / natural, time })
    }

    fn record(&self, recorded: &Recorded) -> Result<Record, Invalid> {
        let factor = self.get(FieldId::RecordScale).unwrap_or(1.0);
        if recorded.is_metric && self.units == UnitSystem::Natural {
            let rule = "its times are in s; give primary.natural_frequency or frequency_hz";
            return Err(Invalid::new(self.named("record"), shown(recorded), rule));
        }
        if recorded.is_metric && recorded.kind == RecordKind::ForceNewtons {
            let rule = "the values of this file are accelerations: give \"base_acceleration\" or \"force\" (f/M)";
            return Err(Invalid::new(self.named("kind"), "\"force_newtons\"", rule));
        }
        let per_mass = match recorded.kind {
            RecordKind::ForceNewtons if self.units != UnitSystem::Si => {
                let part = self.named("kind");
                let rule = "values in N need primary.mass with stiffness or natural_frequency; else \
                            give values over the mass with kind \"force\"";
                return Err(Invalid::new(part, "\"force_newtons\"", rule));
            }
            RecordKind::ForceNewtons => factor / self.scale.mass,
            _ => factor,
        };
        let acts = match recorded.kind {
            RecordKind::BaseAcceleration => Acts::Base,
            _ => Acts::Primary,
        };
        Ok(Record {
            history: Arc::clone(&recorded.history),
            acts,
            rate: self.scale.natural_frequency,
            scale: per_mass / self.stiffness(),
        })
    }
}

/// A record in a message.
fn shown(recorded: &Recorded) -> String {
    recorded.file.clone().unwrap_or_else(|| format!("{} points", recorded.history.times().len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fields_of_a_force_stand_together() {
        let of_force = FieldId::all().filter(|field| field.info().part == Part::Force);
        let places: Vec<usize> = of_force.map(|field| field as usize).collect();
        assert_eq!(places, Vec::from_iter(FIRST..FIRST + COUNT));
    }
}
