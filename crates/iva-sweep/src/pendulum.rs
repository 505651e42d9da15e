//! Length, gravity and frequency of a pendulum: two of them, and the third follows (g = κ L ωp²).

use iva_core::error::{Invalid, number};
use iva_core::piva::{Angles, Given, Parameters, PivaStart};
use iva_core::system::Start;

use crate::choices::Choices;
use crate::design::Spec;
use crate::fields::FieldId;
use crate::units::Scale;

/// Standard acceleration of gravity in m/s² (CGPM 1901), taken in SI units where none is given.
pub(crate) const STANDARD_GRAVITY: f64 = 9.806_65;
/// How well frequency, length and gravity must agree where all three are given.
const AGREEMENT: f64 = 1e-9;

/// What all absorbers have, in natural units.
pub(crate) struct Common {
    pub mass_ratio: f64,
    pub restitution: f64,
    pub clearance: f64,
    pub damping_ratio: f64,
}

/// Frequency ratio; length and gravity unless the motion does not depend on them.
struct Swing {
    frequency_ratio: f64,
    hanging: Option<Hanging>,
}

struct Hanging {
    length: f64,
    /// In the user's unit.
    gravity: f64,
}

/// The parameters of a pendulum, and the gravity on it (in the user's unit) if its length is known.
pub(crate) fn parameters(
    spec: &Spec,
    common: Common,
    scale: &Scale,
) -> Result<(Parameters, Option<f64>), Invalid> {
    let Common { mass_ratio, restitution, clearance, damping_ratio } = common;
    let Choices { angles, impact_law, .. } = *spec.choices();
    let inertia_ratio = spec.get(FieldId::InertiaRatio).unwrap_or(1.0);
    let Swing { frequency_ratio, hanging } = swing(spec, angles, inertia_ratio, scale)?;
    // Where it drops out, any length will do.
    let length = hanging.as_ref().map_or(clearance, |hanging| hanging.length);
    let parameters = Parameters {
        mass_ratio,
        restitution,
        clearance,
        damping_ratio,
        frequency_ratio,
        length,
        inertia_ratio,
        contact_distance: spec.get(FieldId::ContactDistance).unwrap_or(length),
        pivot_damping_ratio: spec.get(FieldId::PivotDampingRatio).unwrap_or(0.0),
        angles,
        impact_law,
        tolerance: spec.get(FieldId::Tolerance).unwrap_or(0.0),
    };
    Ok((parameters, hanging.map(|hanging| hanging.gravity)))
}

fn swing(spec: &Spec, angles: Angles, inertia_ratio: f64, scale: &Scale) -> Result<Swing, Invalid> {
    let omega = scale.natural_frequency;
    let gravity = spec.get(FieldId::Gravity);
    let hang = |frequency_ratio, length, gravity| Swing {
        frequency_ratio,
        hanging: Some(Hanging { length, gravity }),
    };
    match (spec.get(FieldId::FrequencyRatio), spec.get(FieldId::Length)) {
        (Some(ratio), Some(length)) => {
            let frequency = ratio * omega;
            let follows = inertia_ratio * length * (frequency * frequency);
            match gravity.filter(|g| (g - follows).abs() > AGREEMENT * follows) {
                None => Ok(hang(ratio, length, gravity.unwrap_or(follows))),
                Some(g) => Err(Invalid::new(
                    FieldId::Gravity.path(),
                    number(g),
                    format!(
                        "frequency_ratio and length make it {}; give two of the three",
                        number(follows)
                    ),
                )),
            }
        }
        (None, Some(length)) => {
            let gravity = gravity.or(spec.standard_gravity()?).ok_or_else(|| {
                Invalid::missing(
                    "absorber.frequency_ratio",
                    "give frequency_ratio, or gravity (which has a default in SI units only)",
                )
            })?;
            let frequency_ratio = (gravity / (inertia_ratio * length)).sqrt() / omega;
            Ok(hang(frequency_ratio, length, gravity))
        }
        (Some(frequency_ratio), None) => {
            if let Some(gravity) = gravity {
                let frequency = frequency_ratio * omega;
                let length = gravity / (inertia_ratio * (frequency * frequency));
                return Ok(hang(frequency_ratio, length, gravity));
            }
            let needs = if angles == Angles::Large {
                "large angles depend on it; give it, or gravity (L = g / (κ ωp²))"
            } else if spec.get(FieldId::ContactDistance).is_some() {
                "contact_distance is given, so give length too"
            } else if spec.get(FieldId::Angle).or(spec.get(FieldId::AngularVelocity)).is_some() {
                "the start is an angle, so give length too"
            } else {
                return Ok(Swing { frequency_ratio, hanging: None });
            };
            Err(Invalid::missing("absorber.length", needs))
        }
        (None, None) => Err(Invalid::missing(
            "absorber.length",
            "give two of frequency_ratio, length and gravity (in SI units length alone will do)",
        )),
    }
}

/// The start of a pendulum: gap or angle, each with or without the other's rate.
pub(crate) fn start(spec: &Spec, start: Start, scale: &Scale) -> PivaStart {
    let mut start = PivaStart::from(start);
    if let Some(angle) = spec.get(FieldId::Angle) {
        start.place = Given::Angle(angle);
    }
    if let Some(rate) = spec.get(FieldId::AngularVelocity) {
        start.rate = Given::Angle(rate / scale.natural_frequency);
    }
    start
}
