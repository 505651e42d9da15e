//! A scene of several free masses on one structure.

use iva_core::absorber::several::{Several, Starts};
use iva_core::absorber::{Absorber as _, Point, Start};
use iva_core::flight::GapPoint;
use iva_core::force::Force;
use iva_core::real::Real;
use iva_core::siva::FreeMass;

use super::given::Given;
use super::pendulum::Common;
use super::scale::Scale;
use super::scene::{Mounted, Scene};
use crate::choices::Kind;
use crate::error::{Invalid, number};
use crate::fields::FieldId;
use crate::units::UnitSystem;

/// The scene of all absorbers of a list.
///
/// # Errors
/// [`Invalid`] for an absorber that a list does not take, a field out of range, and a start outside of its gap.
pub(super) fn scene<R: Real>(
    given: &Given<'_, R>,
    start: Start<R>,
    force: Force<R>,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<Scene<R>, Invalid> {
    let all = || (0..given.spec.count()).map(|absorber| given.of(absorber));
    let masses = all().map(|it| mass(&it, scale, units)).collect::<Result<Vec<_>, _>>()?;
    let gap = |it: Given<'_, R>| GapPoint {
        y: it.get(FieldId::GapDisplacement).unwrap_or(R::ZERO),
        w: it.get(FieldId::GapVelocity).unwrap_or(R::ZERO) / scale.natural_frequency,
    };
    let gaps: Vec<GapPoint<R>> = all().map(gap).collect();
    let start = Starts::of(Point { x: start.displacement, v: start.velocity }, &gaps);
    let system = Several::of(given.damping_ratio(scale, units)?, &masses)?;
    system.check_start(&start)?;
    let gravity = None;
    if force.is_none() {
        return Ok(Scene::Several(Box::new(Mounted { system, start, gravity })));
    }
    let system = system.under(force);
    Ok(Scene::DrivenSeveral(Box::new(Mounted { system, start, gravity })))
}

/// One of the masses.
fn mass<R: Real>(
    given: &Given<'_, R>,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<FreeMass<R>, Invalid> {
    let kind = given.choices().kind;
    if kind != Kind::Siva {
        let field = format!("absorber.{}.kind", given.absorber);
        let rule = "of several absorbers all are free masses (kind \"siva\")";
        return Err(Invalid::new(field, format!("\"{}\"", kind.name()), rule));
    }
    for field in [FieldId::Inclination, FieldId::InclinationDeg, FieldId::Gravity] {
        if let Some(value) = given.get(field).filter(|value| *value != 0.0) {
            let rule = "the line of motion of several absorbers is level; leave it out";
            return Err(Invalid::new(given.path(field), number(value), rule));
        }
    }
    let Common { mass_ratio, restitution, clearance, .. } = given.common(scale, units)?;
    let offset = given.length(FieldId::GapOffset, FieldId::GapOffsetMm, units)?;
    let mut mass = FreeMass::new(mass_ratio, restitution, clearance)?;
    if let Some(offset) = offset {
        mass = mass.with_offset(offset)?;
    }
    match given.get(FieldId::RestitutionMinus) {
        Some(restitution) => mass.with_restitution_minus(restitution),
        None => Ok(mass),
    }
}
