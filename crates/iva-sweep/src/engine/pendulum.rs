//! Length, gravity and frequency of a pendulum: from two of them the third follows (g = κ L ωp²).

use iva_core::absorber::Start;
use iva_core::compensated::DoubleDouble;
use iva_core::piva::{self, Given as Stated, Parameters, PivaStart};
use iva_core::range;
use iva_core::real::Real;

use super::free_mass::{self, Weight};
use super::given::Given;
use super::scale::Scale;
use crate::choices::{Angles, Choices, ImpactLaw};
use crate::error::{Invalid, number};
use crate::fields::FieldId;

/// Largest relative disagreement of frequency, length and gravity where all three are given.
const AGREEMENT: f64 = 1e-9;

/// The parameters that all absorbers have, with ζ of their primary, in natural units.
pub(crate) struct Common<R = f64> {
    pub mass_ratio: R,
    pub restitution: R,
    pub clearance: R,
    pub damping_ratio: R,
}

/// Frequency ratio of a pendulum, with length and gravity unless the motion does not depend on them.
struct Swing<R = f64> {
    frequency_ratio: R,
    hanging: Option<Hanging<R>>,
}

struct Hanging<R = f64> {
    length: R,
    /// Acceleration of gravity, in the user's unit.
    gravity: R,
}

/// The parameters of a pendulum, and the acceleration of gravity (in the user's unit) if its length is known.
pub(crate) fn parameters<R: Real>(
    given: &Given<'_, R>,
    common: Common<R>,
    scale: &Scale<R>,
) -> Result<(Parameters<R>, Option<R>), Invalid> {
    let Common { mass_ratio, restitution, clearance, damping_ratio } = common;
    let Choices { angles, impact_law, .. } = *given.choices();
    let inertia_ratio = given.get(FieldId::InertiaRatio).unwrap_or(R::ONE);
    let Swing { frequency_ratio, hanging } = swing(given, angles, inertia_ratio, scale)?;
    // If the motion does not depend on the length, the clearance serves as length.
    let length = hanging.as_ref().map_or(clearance, |hanging| hanging.length);
    let parameters = Parameters {
        mass_ratio,
        restitution,
        clearance,
        damping_ratio,
        frequency_ratio,
        length,
        inertia_ratio,
        contact_distance: given.get(FieldId::ContactDistance).unwrap_or(length),
        pivot_damping_ratio: given.get(FieldId::PivotDampingRatio).unwrap_or(R::ZERO),
        spring_ratio: given.get(FieldId::SpringRatio).unwrap_or(R::ZERO),
        angles: match angles {
            Angles::Large => piva::Angles::Large,
            Angles::Small => piva::Angles::Small,
        },
        impact_law: match impact_law {
            ImpactLaw::Consistent => piva::ImpactLaw::Consistent,
            ImpactLaw::Printed => piva::ImpactLaw::Printed,
        },
        tolerance: given.get(FieldId::Tolerance).unwrap_or(R::ZERO),
    };
    Ok((parameters, hanging.map(|hanging| hanging.gravity)))
}

/// The angle by which the line rises on which the pivot moves, in rad.
///
/// # Errors
/// [`Invalid`] for one that is given in both units, or with small angles.
pub(super) fn rising<R: Real>(given: &Given<'_, R>) -> Result<DoubleDouble<R>, Invalid> {
    let angle = free_mass::inclination(given)?.unwrap_or(DoubleDouble::ZERO);
    if angle.value == 0.0 || given.choices().angles == Angles::Large {
        return Ok(angle);
    }
    let named = [FieldId::Inclination, FieldId::InclinationDeg];
    let of = named.into_iter().find_map(|field| Some((field, given.get(field)?)));
    let (field, value) = of.unwrap_or((FieldId::Inclination, angle.value));
    let rule = "swings on a line that rises are of any size: give angles = \"large\"";
    Err(Invalid::new(given.path(field), number(value), rule))
}

/// The friction in the pivot: a moment T has the coefficient T/(m g L), and decelerates a pendulum by r² b times that.
///
/// # Errors
/// [`Invalid`] without a length, as the angle at which friction holds the pendulum is then unknown, for less friction at rest than in a swing, and where that
/// deceleration is out of [`iva_core::range`].
pub(super) fn friction<R: Real>(
    given: &Given<'_, R>,
    (parameters, gravity): &(Parameters<R>, Option<R>),
) -> Result<Option<Weight<R>>, Invalid> {
    let at_rest = free_mass::at_rest(given)?;
    let Some(coefficient) = given.get(FieldId::Friction).filter(|it| *it != 0.0) else {
        return Ok(None);
    };
    let Some(gravity) = *gravity else {
        let rule = "friction in the pivot needs the length of the pendulum";
        return Err(Invalid::missing(given.path(FieldId::Length), rule));
    };
    let ratio = parameters.frequency_ratio;
    let hanging = ratio * ratio * parameters.contact_distance;
    let slowed = |field: FieldId, coefficient: R| {
        let slowed = coefficient * hanging;
        range::size("", slowed).map_err(|error| {
            let rule = format!("{} for friction r² b, which is {}", error.allowed, number(slowed));
            Invalid::new(given.path(field), number(coefficient), rule)
        })?;
        Ok(slowed)
    };
    let friction = Some(slowed(FieldId::Friction, coefficient)?);
    let static_friction = at_rest.map(|it| slowed(FieldId::StaticFriction, it)).transpose()?;
    Ok(Some(Weight { gravity, along: R::ZERO, friction, static_friction }))
}

fn swing<R: Real>(
    given: &Given<'_, R>,
    angles: Angles,
    inertia_ratio: R,
    scale: &Scale<R>,
) -> Result<Swing<R>, Invalid> {
    let omega = scale.natural_frequency;
    let gravity = given.get(FieldId::Gravity);
    let hang = |frequency_ratio, length, gravity| Swing {
        frequency_ratio,
        hanging: Some(Hanging { length, gravity }),
    };
    match (given.get(FieldId::FrequencyRatio), given.get(FieldId::Length)) {
        (Some(ratio), Some(length)) => {
            let frequency = ratio * omega;
            let follows = inertia_ratio * length * (frequency * frequency);
            match gravity.filter(|g| (*g - follows).abs() > follows * AGREEMENT) {
                None => Ok(hang(ratio, length, gravity.unwrap_or(follows))),
                Some(g) => Err(Invalid::new(
                    given.path(FieldId::Gravity),
                    number(g),
                    format!(
                        "frequency_ratio and length make it {}; give two of the three",
                        number(follows)
                    ),
                )),
            }
        }
        (None, Some(length)) => {
            let gravity = gravity
                .or(given.spec.standard_gravity_of(given.absorber)?.map(R::from))
                .ok_or_else(|| {
                    Invalid::missing(
                        given.path(FieldId::FrequencyRatio),
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
            } else if given.get(FieldId::ContactDistance).is_some() {
                "contact_distance is given, so give length too"
            } else if given.get(FieldId::Angle).or(given.get(FieldId::AngularVelocity)).is_some() {
                "the start is an angle, so give length too"
            } else {
                return Ok(Swing { frequency_ratio, hanging: None });
            };
            Err(Invalid::missing(given.path(FieldId::Length), needs))
        }
        (None, None) => Err(Invalid::missing(
            given.path(FieldId::Length),
            "give two of frequency_ratio, length and gravity (in SI units length alone will do)",
        )),
    }
}

/// The start of a pendulum: displacement as gap or angle, velocity as gap velocity or angular velocity,
/// independently.
pub(crate) fn start<R: Real>(
    given: &Given<'_, R>,
    start: Start<R>,
    scale: &Scale<R>,
) -> PivaStart<R> {
    let mut start = PivaStart::from(start);
    if let Some(angle) = given.get(FieldId::Angle) {
        start.place = Stated::Angle(angle);
    }
    if let Some(rate) = given.get(FieldId::AngularVelocity) {
        start.rate = Stated::Angle(rate / scale.natural_frequency);
    }
    start
}
