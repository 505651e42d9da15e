//! Conversion of the forces of a scene to those of the core.

use std::sync::Arc;

use iva_core::force::{Acts, Force, Harmonic, Impulse, Record};
use iva_core::real::Real;

use super::given::Given;
use super::scale::Scale;
use crate::error::{Invalid, number};
use crate::fields::FieldId;
use crate::forces::{ForceSpec, Nature, RecordKind, Recorded};
use crate::slot::Slot;
use crate::units::UnitSystem;

/// One force with everything needed to convert it: its fields, its number in the list, and the units.
struct Reader<'a, R = f64> {
    given: &'a Given<'a, R>,
    spec: &'a ForceSpec,
    number: usize,
    count: usize,
    scale: &'a Scale<R>,
    units: UnitSystem,
}

/// The sum of the forces in natural units.
///
/// # Errors
/// [`Invalid`] if something is missing, given twice, of another kind of force, or needs a mass.
pub(crate) fn force<R: Real>(
    given: &Given<'_, R>,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<Force<R>, Invalid> {
    let forces = given.spec.forces();
    let mut impulses = Vec::from_iter(shock(given, scale, units)?);
    if forces.is_empty() && impulses.is_empty() {
        return Ok(Force::default());
    }
    let structure = given.spec.structure();
    let pushed = structure.map(|it| it.pushed(forces)).transpose()?;
    let (mut harmonics, mut records, mut elsewhere) = (Vec::new(), Vec::new(), Vec::new());
    for (number, spec) in forces.iter().enumerate() {
        let reader = Reader { given, spec, number, count: forces.len(), scale, units };
        reader.check_nature()?;
        match (&spec.record, spec.nature()) {
            (Some(recorded), _) => records.push(reader.record(recorded)?),
            (None, Nature::Impulse) => impulses.push(reader.impulse()?),
            (None, _) => {
                let harmonic = reader.harmonic()?;
                let at = structure.map(|it| it.force_at(number, forces.len())).transpose()?;
                match structure.zip(at).filter(|_| harmonic.acts == Acts::Primary && at != pushed) {
                    Some((structure, point)) => {
                        elsewhere.push((structure.index_of(point), harmonic));
                    }
                    None => harmonics.push(harmonic),
                }
            }
        }
    }
    Force::new(harmonics, records, &impulses)?.with_elsewhere(elsewhere)
}

/// The impulse of the start, which acts at time zero.
///
/// # Errors
/// [`Invalid`] if it is given twice, needs a mass, or the run begins later.
fn shock<R: Real>(
    given: &Given<'_, R>,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<Option<Impulse<R>>, Invalid> {
    let fields = [FieldId::StartImpulseVelocity, FieldId::StartImpulse];
    given.at_most_one(&fields)?;
    let [velocity, impulse] = fields.map(|field| given.get(field));
    let Some(value) = velocity.or(impulse) else { return Ok(None) };
    let field = if velocity.is_some() { fields[0] } else { fields[1] };
    if given.get(FieldId::StartTime).is_some_and(|time| time > 0.0) {
        let rule = "it acts at time zero, and the run begins later; give an impulse as a force, with its time";
        return Err(Invalid::new(field.path(), number(value), rule));
    }
    let velocity = match impulse {
        Some(impulse) => per_mass(
            &field.path(),
            impulse,
            "impulse_velocity (impulse over mass)",
            (scale, units),
        )?,
        None => value,
    };
    Ok(Some(Impulse { velocity: velocity / scale.natural_frequency, time: R::ZERO }))
}

/// Divides by the primary mass: a force in N gives f/M, an impulse in N s gives P/M.
///
/// # Errors
/// [`Invalid`] where no mass is given, with the alternative.
fn per_mass<R: Real>(
    name: &str,
    value: R,
    alternative: &str,
    (scale, units): (&Scale<R>, UnitSystem),
) -> Result<R, Invalid> {
    if units == UnitSystem::Si {
        return Ok(value / scale.mass);
    }
    let rule = format!(
        "give primary.mass with stiffness or natural_frequency as well, or give {alternative}"
    );
    Err(Invalid::new(name, number(value), rule))
}

impl<R: Real> Reader<'_, R> {
    fn path(&self, field: FieldId) -> String {
        Slot::of_force(field, self.number, self.count).path()
    }

    /// The path of an entry of the force that is not a number.
    fn named(&self, name: &str) -> String {
        self.path(FieldId::RecordScale).replace("scale", name)
    }

    fn get(&self, field: FieldId) -> Option<R> {
        let slot = Slot::of_force(field, self.number, self.count);
        self.spec.get(field).map(|value| self.given.number(slot, value))
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

    fn per_mass(&self, name: &str, value: R, alternative: &str) -> Result<R, Invalid> {
        per_mass(name, value, alternative, (self.scale, self.units))
    }

    fn stiffness(&self) -> R {
        self.scale.natural_frequency * self.scale.natural_frequency
    }

    fn harmonic(&self) -> Result<Harmonic<R>, Invalid> {
        let phase = self.get(FieldId::Phase).unwrap_or(R::ZERO);
        let given = self.amplitude()?;
        let frequency = self.frequency()?;
        let (amplitude, phase, acts) = match given {
            Some((amplitude, acts)) => (amplitude, phase, acts),
            None => {
                let (amplitude, later) = self.of_moved_base(frequency)?;
                (amplitude, phase + later, Acts::Base)
            }
        };
        Ok(Harmonic { amplitude, frequency, phase, acts })
    }

    /// The amplitude of the acceleration of a base whose velocity V cos(Ωt + φ) or displacement X cos(Ωt + φ) is given, and by how much its phase is ahead of φ:
    /// ΩV and a quarter of a turn, or −Ω²X.
    fn of_moved_base(&self, frequency: R) -> Result<(R, R), Invalid> {
        if let Some(velocity) = self.get(FieldId::BaseVelocity) {
            let natural = self.scale.natural_frequency;
            return Ok((velocity / natural * frequency, R::TURN.value * 0.25));
        }
        let field = FieldId::BaseDisplacementMm;
        let displacement = match (self.get(FieldId::BaseDisplacement), self.get(field)) {
            (Some(length), _) => length,
            (None, Some(length)) if self.units == UnitSystem::Si => length / 1000.0,
            (None, length) => {
                let rule = "in mm it needs primary.mass with stiffness or natural_frequency; give base_displacement";
                return Err(Invalid::new(
                    self.path(field),
                    length.map_or(String::new(), number),
                    rule,
                ));
            }
        };
        Ok((-(displacement * frequency * frequency), R::ZERO))
    }

    /// The amplitude of a force or of an acceleration of the base; `None` of another motion of the base.
    fn amplitude(&self) -> Result<Option<(R, Acts)>, Invalid> {
        let fields = [FieldId::Amplitude, FieldId::ForceAmplitude, FieldId::BaseAcceleration];
        let moved = [FieldId::BaseVelocity, FieldId::BaseDisplacement, FieldId::BaseDisplacementMm];
        let [a, b, c] = fields;
        let [d, e, f] = moved;
        self.at_most_one(&[a, b, c, d, e, f])?;
        if moved.iter().any(|field| self.get(*field).is_some()) {
            return Ok(None);
        }
        let [acceleration, force, base] = fields.map(|field| self.get(field));
        if let Some(acceleration) = acceleration {
            return Ok(Some((acceleration / self.stiffness(), Acts::Primary)));
        }
        if let Some(base) = base {
            return Ok(Some((base / self.stiffness(), Acts::Base)));
        }
        let Some(force) = force else {
            return Err(Invalid::missing(
                self.path(FieldId::Amplitude),
                "give amplitude (f/M), force (N, needs a mass), or base_acceleration, base_velocity or base_displacement",
            ));
        };
        let name = self.path(FieldId::ForceAmplitude);
        let force = self.per_mass(&name, force, "amplitude (f/M)")?;
        Ok(Some((force / self.stiffness(), Acts::Primary)))
    }

    fn frequency(&self) -> Result<R, Invalid> {
        let fields =
            [FieldId::ForceFrequency, FieldId::RelativeFrequency, FieldId::ForceFrequencyHz];
        self.at_most_one(&fields)?;
        let [absolute, relative, hertz] = fields.map(|field| self.get(field));
        let natural = self.scale.natural_frequency;
        relative
            .or_else(|| absolute.map(|frequency| frequency / natural))
            .or_else(|| hertz.map(|frequency| R::TURN.value * frequency / natural))
            .ok_or_else(|| {
                Invalid::missing(
                    self.path(FieldId::ForceFrequency),
                    "give frequency (rad/s), frequency_hz or relative_frequency (over that of the \
                     bare primary)",
                )
            })
    }

    fn impulse(&self) -> Result<Impulse<R>, Invalid> {
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
        let time = self.get(FieldId::ImpulseTime).unwrap_or(R::ZERO) * natural;
        Ok(Impulse { velocity: velocity / natural, time })
    }

    fn record(&self, recorded: &Recorded) -> Result<Record<R>, Invalid> {
        let factor = self.get(FieldId::RecordScale).unwrap_or(R::ONE);
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
