//! The force of a scene: amplitude and frequency, each given in one of several ways.

use std::f64::consts::TAU;

use iva_core::error::{Invalid, number};
use iva_core::force::{Acts, Force, Harmonic};

use crate::design::Spec;
use crate::fields::{FieldId, Part};
use crate::units::{Scale, UnitSystem};

/// The force in natural units; the empty one if none was given.
///
/// # Errors
/// [`Invalid`] if amplitude or frequency is missing, given twice, or needs a mass.
pub(crate) fn force(spec: &Spec, scale: &Scale, units: UnitSystem) -> Result<Force, Invalid> {
    if !spec.given().any(|(field, _)| field.info().part == Part::Force) {
        return Ok(Force::default());
    }
    let (amplitude, acts) = amplitude(spec, scale, units)?;
    let phase = spec.get(FieldId::Phase).unwrap_or(0.0);
    Force::harmonic(vec![Harmonic { amplitude, frequency: frequency(spec, scale)?, phase, acts }])
}

fn amplitude(spec: &Spec, scale: &Scale, units: UnitSystem) -> Result<(f64, Acts), Invalid> {
    spec.at_most_one(&[FieldId::Amplitude, FieldId::ForceAmplitude, FieldId::BaseAcceleration])?;
    let stiffness = scale.natural_frequency * scale.natural_frequency;
    if let Some(acceleration) = spec.get(FieldId::Amplitude) {
        return Ok((acceleration / stiffness, Acts::Primary));
    }
    if let Some(acceleration) = spec.get(FieldId::BaseAcceleration) {
        return Ok((acceleration / stiffness, Acts::Base));
    }
    match spec.get(FieldId::ForceAmplitude) {
        Some(force) if units == UnitSystem::Si => {
            Ok((force / (scale.mass * stiffness), Acts::Primary))
        }
        Some(force) => Err(Invalid::new(
            FieldId::ForceAmplitude.path(),
            number(force),
            "give primary.mass with stiffness or natural_frequency as well, or give amplitude (f/M)",
        )),
        None => Err(Invalid::missing(
            "force.amplitude",
            "give amplitude (f/M), force (N, needs a mass) or base_acceleration",
        )),
    }
}

fn frequency(spec: &Spec, scale: &Scale) -> Result<f64, Invalid> {
    let fields = [FieldId::ForceFrequency, FieldId::RelativeFrequency, FieldId::ForceFrequencyHz];
    spec.at_most_one(&fields)?;
    let [absolute, relative, hertz] = fields.map(|field| spec.get(field));
    relative
        .or_else(|| absolute.map(|frequency| frequency / scale.natural_frequency))
        .or_else(|| hertz.map(|frequency| TAU * frequency / scale.natural_frequency))
        .ok_or_else(|| {
            Invalid::missing(
                "force.frequency",
                "give frequency (rad/s), frequency_hz or relative_frequency (over that of the bare \
                 primary)",
            )
        })
}
