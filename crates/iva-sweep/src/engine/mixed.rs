//! A scene of free masses and pendulums on one structure.

use iva_core::absorber::mixed::{Mixed, MixedStart, OneOf, Posed};
use iva_core::absorber::{Absorber as _, Point, Start};
use iva_core::force::Force;
use iva_core::piva::{Given as Stated, Parameters, Piva};
use iva_core::real::Real;

use super::free_mass;
use super::given::Given;
use super::pendulum;
use super::scale::Scale;
use super::scene::{Mounted, Scene};
use super::several::{Unit, each_unit, gap, mass, of_owner, shared};
use crate::choices::Kind;
use crate::error::Invalid;
use crate::fields::{FieldId, Part};
use crate::spec::Spec;
use crate::units::UnitSystem;

/// True if a list has a pendulum.
pub(super) fn is_list_with_pendulum(spec: &Spec) -> bool {
    let several = spec.count() > 1 || spec.units_of(0) > 1;
    several && (0..spec.count()).any(|k| spec.choices_of(k).kind == Kind::Piva)
}

/// The scene of all absorbers of a list, with all units of each. Gravity is that on the first pendulum, if all have a length.
///
/// # Errors
/// [`Invalid`] as of several free masses and of one pendulum.
pub(super) fn scene<R: Real>(
    given: &Given<'_, R>,
    start: Start<R>,
    force: Force<R>,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<Scene<R>, Invalid> {
    let (mut absorbers, mut posed) = (Vec::new(), Vec::new());
    let mut gravities = Vec::new();
    each_unit(given, |given, unit| {
        if given.choices().kind == Kind::Siva {
            let at = gap(given, scale);
            posed.push(Posed { place: Stated::Gap(at.y), rate: Stated::Gap(at.w) });
            // Refuses gravity, which does nothing to a mass on a level line.
            free_mass::weight(given, scale)?;
            absorbers.push(OneOf::Mass(mass(given, unit, scale, units)?));
            return Ok(());
        }
        let (piva, gravity) = one_pendulum(given, unit, scale, units)?;
        absorbers.push(OneOf::pendulum(piva).map_err(|error| of_absorber(given, error))?);
        gravities.push(gravity);
        let at = gap(given, scale);
        let start = Start { gap_displacement: at.y, gap_velocity: at.w, ..start };
        let begun = pendulum::start(given, start, scale);
        posed.push(Posed { place: begun.place, rate: begun.rate });
        Ok(())
    })?;
    let start = MixedStart::of(Point { x: start.displacement, v: start.velocity }, &posed);
    let system = Mixed::new(given.damping_ratio(scale, units)?, absorbers)?;
    system.check_start(&start).map_err(|error| of_owner(given, error))?;
    let gravity =
        if gravities.contains(&None) { None } else { gravities.into_iter().flatten().next() };
    let system = system.under(force);
    Ok(Scene::Mixed(Box::new(Mounted { system, start, gravity })))
}

/// One unit of a pendulum, and the acceleration of gravity if its length is known.
fn one_pendulum<R: Real>(
    given: &Given<'_, R>,
    unit: Unit,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<(Piva<iva_core::host::UndrivenHost<R>>, Option<R>), Invalid> {
    given.at_most_one(&[FieldId::GapDisplacement, FieldId::Angle])?;
    given.at_most_one(&[FieldId::GapVelocity, FieldId::AngularVelocity])?;
    let mut common = given.common(scale, units)?;
    [common.mass_ratio, common.clearance] =
        shared(given, unit, [common.mass_ratio, common.clearance])?;
    let (parameters, gravity) = pendulum::parameters(given, common, scale)?;
    // A list flies at full accuracy.
    let parameters = Parameters { tolerance: R::ZERO, ..parameters };
    let mut piva = Piva::new(parameters).map_err(|error| of_absorber(given, error))?;
    if let Some(restitution) = given.get(FieldId::RestitutionMinus) {
        piva = piva.with_restitution_minus(restitution)?;
    }
    Ok((piva, gravity))
}

/// An error of the core, whose field names the absorber of the list.
fn of_absorber<R: Real>(given: &Given<'_, R>, error: Invalid) -> Invalid {
    let Some(name) = error.field.strip_prefix("absorber.") else { return error };
    let number = given.slot(FieldId::Clearance).number;
    let field = number.map(|number| format!("{}.{number}.{name}", Part::Absorber.name()));
    Invalid { field: field.unwrap_or_else(|| error.field.clone()), ..error }
}
