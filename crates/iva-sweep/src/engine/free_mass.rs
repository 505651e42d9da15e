//! A free mass with weight: gravity along its line of motion, friction by gravity across it, and the start of the absorber.

use iva_core::compensated::DoubleDouble;
use iva_core::real::Real;

use super::given::Given;
use super::scale::Scale;
use crate::error::{Invalid, number};
use crate::fields::FieldId;

/// What weight does to a free mass whose line of motion is inclined, or to an absorber that rubs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weight<R = f64> {
    /// Acceleration of gravity g, in the user's unit.
    pub gravity: R,
    /// G = g sin α along the motion, in natural units; 0 where it is level.
    pub along: R,
    /// The deceleration by friction, k g cos α of a free mass, in natural units; `None` without.
    pub friction: Option<R>,
    /// The same at rest; `None` if it is not larger.
    pub static_friction: Option<R>,
}

/// The weight of the mass; `None` where it does nothing: the motion is level and has no friction.
///
/// # Errors
/// [`Invalid`] for gravity without inclination and friction, or one of these without gravity, and for less friction at rest than in a slide.
pub(crate) fn weight<R: Real>(
    given: &Given<'_, R>,
    scale: &Scale<R>,
) -> Result<Option<Weight<R>>, Invalid> {
    let angle = inclination(given)?;
    let gravity = given.get(FieldId::Gravity);
    let coefficient = given.get(FieldId::Friction);
    let at_rest = at_rest(given)?;
    if let (None, None, Some(gravity)) = (angle, coefficient, gravity) {
        return Err(Invalid::new(
            given.path(FieldId::Gravity),
            number(gravity),
            "gravity acts on a free mass where its line of motion rises, or where it rubs; give inclination \
             (inclination_deg = 90 upright, 0 level) or friction too",
        ));
    }
    let angle = angle.unwrap_or(DoubleDouble::ZERO);
    let coefficient = coefficient.filter(|coefficient| *coefficient != 0.0);
    if angle.value == 0.0 && coefficient.is_none() {
        return Ok(None);
    }
    let standard = given.spec.standard_gravity_of(given.absorber)?.map(R::from);
    let gravity = gravity.or(standard).ok_or_else(|| {
        Invalid::missing(
            given.path(FieldId::Gravity),
            "the line of motion rises or rubs, so give gravity (which has a default in SI units only)",
        )
    })?;
    let (sine, cosine) = R::precise_sincos(angle);
    let omega = scale.natural_frequency;
    let along = if angle.value == 0.0 { R::ZERO } else { sine.value * gravity / (omega * omega) };
    // Upright the cosine of an angle in degrees is a rounding error.
    let pressing = cosine.value.max(0.0) * gravity / (omega * omega);
    let [friction, static_friction] = [coefficient, at_rest].map(|it| it.map(|it| it * pressing));
    Ok(Some(Weight { gravity, along, friction, static_friction }))
}

/// The angle by which the line of motion rises, in rad, if it is given.
///
/// # Errors
/// [`Invalid`] where it is given in both units.
pub(super) fn inclination<R: Real>(
    given: &Given<'_, R>,
) -> Result<Option<DoubleDouble<R>>, Invalid> {
    given.at_most_one(&[FieldId::Inclination, FieldId::InclinationDeg])?;
    let degree = R::TURN.over(360.0);
    let in_degrees = || given.get(FieldId::InclinationDeg).map(|degrees| degree.times(degrees));
    Ok(given.get(FieldId::Inclination).map(DoubleDouble::new).or_else(in_degrees))
}

/// The coefficient of friction at rest, if it is larger than that of a slide.
///
/// # Errors
/// [`Invalid`] if it is smaller.
pub(super) fn at_rest<R: Real>(given: &Given<'_, R>) -> Result<Option<R>, Invalid> {
    let sliding = given.get(FieldId::Friction).unwrap_or(R::ZERO);
    let Some(at_rest) = given.get(FieldId::StaticFriction) else { return Ok(None) };
    let rule = match sliding {
        _ if at_rest == sliding => return Ok(None),
        none if none == 0.0 => "give friction too, that of a slide".to_owned(),
        _ if at_rest > sliding => return Ok(Some(at_rest)),
        _ => format!("give at least friction, which is {}", number(sliding)),
    };
    Err(Invalid::new(given.path(FieldId::StaticFriction), number(at_rest), rule))
}

/// True if an absorber has friction, or one in a list an inclination.
pub(super) fn weighs<R: Real>(given: &Given<'_, R>, several: bool) -> bool {
    let inclined = [FieldId::Inclination, FieldId::InclinationDeg].into_iter().filter(|_| several);
    let mut fields = inclined.chain([FieldId::Friction, FieldId::StaticFriction]);
    fields.any(|field| given.get(field).is_some_and(|value| value != 0.0))
}

/// The gap displacement at the start on an inclined line of motion: the lower stop, unless one is given.
pub(crate) fn starting_place<R: Real>(given: &Given<'_, R>, place: R, lower_stop: R) -> R {
    if given.get(FieldId::GapDisplacement).is_some() { place } else { lower_stop }
}

/// The error for a start outside the gap. If no gap displacement is given, the error names the offset of the
/// gap.
pub(crate) fn misplaced<R: Real>(given: &Given<'_, R>, error: Invalid) -> Invalid {
    let offsets = [FieldId::GapOffset, FieldId::GapOffsetMm];
    let own = |field| given.spec.get_of(given.absorber, field);
    let offset = offsets.into_iter().find_map(|field| Some((field, own(field)?)));
    match offset {
        Some((field, value))
            if error.field == given.path(FieldId::GapDisplacement)
                && given.get(FieldId::GapDisplacement).is_none() =>
        {
            let rule = "the mass starts at y = 0, outside the gap; give start.gap_displacement too";
            Invalid::new(given.path(field), number(value), rule)
        }
        _ => error,
    }
}
