//! A free mass whose line of motion may be inclined: gravity along it, and the start of the absorber.

use iva_core::absorber::Start;
use iva_core::compensated::DoubleDouble;
use iva_core::real::Real;

use super::given::Given;
use super::scale::Scale;
use crate::error::{Invalid, number};
use crate::fields::FieldId;

/// Gravity on a free mass whose line of motion is inclined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inclined<R = f64> {
    /// Acceleration of gravity g, in the user's unit.
    pub gravity: R,
    /// G = g sin α along the motion, in natural units.
    pub along: R,
}

/// Gravity along the motion; `None` where the motion is level.
///
/// # Errors
/// [`Invalid`] for gravity without an inclination, or an inclination without gravity.
pub(crate) fn inclined<R: Real>(
    given: &Given<'_, R>,
    scale: &Scale<R>,
) -> Result<Option<Inclined<R>>, Invalid> {
    given.at_most_one(&[FieldId::Inclination, FieldId::InclinationDeg])?;
    let degree = R::TURN.over(360.0);
    let angle = given
        .get(FieldId::Inclination)
        .map(DoubleDouble::new)
        .or_else(|| given.get(FieldId::InclinationDeg).map(|degrees| degree.times(degrees)));
    let gravity = given.get(FieldId::Gravity);
    let Some(angle) = angle else {
        return match gravity {
            None => Ok(None),
            Some(gravity) => Err(Invalid::new(
                FieldId::Gravity.path(),
                number(gravity),
                "gravity acts on a free mass where its line of motion rises; give inclination too \
                 (inclination_deg = 90 upright, 0 level)",
            )),
        };
    };
    if angle.value == 0.0 {
        return Ok(None);
    }
    let standard = given.spec.standard_gravity()?.map(|g| R::given(g, false));
    let gravity = gravity.or(standard).ok_or_else(|| {
        Invalid::missing(
            FieldId::Gravity.path(),
            "the line of motion rises, so give gravity (which has a default in SI units only)",
        )
    })?;
    let (sine, _) = R::precise_sincos(angle);
    let omega = scale.natural_frequency;
    Ok(Some(Inclined { gravity, along: sine.value * gravity / (omega * omega) }))
}

/// The start of a free mass on an inclined line of motion: on its lower stop, unless a gap displacement is
/// given.
pub(crate) fn start<R: Real>(given: &Given<'_, R>, start: Start<R>, lower_stop: R) -> Start<R> {
    match given.get(FieldId::GapDisplacement) {
        Some(_) => start,
        None => Start { gap_displacement: lower_stop, ..start },
    }
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
