//! What lists of any absorbers have in common.

use iva_core::absorber::Start;
use iva_core::compensated::DoubleDouble;
use iva_core::flight::GapPoint;
use iva_core::piva::{Parameters, PivaStart};
use iva_core::real::Real;
use iva_core::siva::FreeMass;

use super::free_mass::{self, Weight};
use super::given::Given;
use super::pendulum::{self, Common};
use super::restitution;
use super::scale::Scale;
use crate::choices::Kind;
use crate::error::{Invalid, number};
use crate::fields::{FieldId, Part};
use crate::spec::MOST_ABSORBERS;
use crate::units::UnitSystem;

/// A unit of an absorber.
pub(super) struct Member<R: Real> {
    /// Its mass in its gap.
    pub mass: FreeMass<R>,
    /// How it hangs, if it is a pendulum, and the acceleration of gravity if its length is known.
    pub hanging: Option<(Parameters<R>, Option<R>)>,
    /// Its place in its gap at the start.
    pub gap: GapPoint<R>,
    /// By which angle the line rises on which a pendulum moves with its point, in rad.
    pub rising: DoubleDouble<R>,
    /// What weight does to a free mass, or friction to a pendulum.
    pub weight: Option<Weight<R>>,
}

/// All units of all absorbers of a list, each with the number of its absorber.
///
/// # Errors
/// [`Invalid`] for an absorber that a list does not take, too many units, a field out of range, and those of `take`.
pub(super) fn each<R: Real>(
    given: &Given<'_, R>,
    scale: &Scale<R>,
    units: UnitSystem,
    mut take: impl FnMut(usize, Member<R>) -> Result<(), Invalid>,
) -> Result<(), Invalid> {
    each_unit(given, |given, unit| {
        let (mass, mut gap) = (mass(given, unit, scale, units)?, gap(given, scale));
        if given.choices().kind == Kind::Piva {
            let hanging = hanging(given, unit, scale, units)?;
            let gap = hanged(given, &hanging.0, scale, &mass)?;
            let weight = pendulum::friction(given, &hanging)?;
            let rising = pendulum::rising(given)?;
            let hanging = Some(hanging);
            return take(given.absorber, Member { mass, hanging, gap, rising, weight });
        }
        let rising = DoubleDouble::ZERO;
        if given.choices().kind == Kind::Stop {
            return take(given.absorber, Member { mass, hanging: None, gap, rising, weight: None });
        }
        let weight = free_mass::weight(given, scale)?;
        if weight.is_some_and(|weight| weight.along != 0.0) {
            let lower_stop = mass.offset() - mass.clearance();
            gap.y = free_mass::starting_place(given, gap.y, lower_stop);
        }
        take(given.absorber, Member { mass, hanging: None, gap, rising, weight })
    })
}

/// How a unit of a pendulum hangs, and the acceleration of gravity if its length is known.
fn hanging<R: Real>(
    given: &Given<'_, R>,
    unit: Unit,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<(Parameters<R>, Option<R>), Invalid> {
    given.at_most_one(&[FieldId::GapDisplacement, FieldId::Angle])?;
    given.at_most_one(&[FieldId::GapVelocity, FieldId::AngularVelocity])?;
    let mut common = given.common(scale, units)?;
    [common.mass_ratio, common.clearance] =
        shared(given, unit, [common.mass_ratio, common.clearance])?;
    pendulum::parameters(given, common, scale)
}

/// The place of a pendulum in its gap at the start.
fn hanged<R: Real>(
    given: &Given<'_, R>,
    parameters: &Parameters<R>,
    scale: &Scale<R>,
    mass: &FreeMass<R>,
) -> Result<GapPoint<R>, Invalid> {
    let GapPoint { y, w } = gap(given, scale);
    let start = Start { gap_displacement: y, gap_velocity: w, ..Start::default() };
    let PivaStart { place, rate, .. } = pendulum::start(given, start, scale);
    let named = |error| Invalid { field: given.path(FieldId::Angle), ..error };
    parameters.gap(place, rate, mass).map_err(named)
}

/// The gap displacement and velocity at the start.
pub(super) fn gap<R: Real>(given: &Given<'_, R>, scale: &Scale<R>) -> GapPoint<R> {
    GapPoint {
        y: given.get(FieldId::GapDisplacement).unwrap_or(R::ZERO),
        w: given.get(FieldId::GapVelocity).unwrap_or(R::ZERO) / scale.natural_frequency,
    }
}

/// A unit of an absorber, and the number of its units.
pub(super) type Unit = (usize, usize);

/// All units of all absorbers of a list, each with the fields of its absorber.
///
/// # Errors
/// [`Invalid`] for too many units, and those of `take`.
pub(super) fn each_unit<'a, R: Real>(
    given: &Given<'a, R>,
    mut take: impl FnMut(&Given<'a, R>, Unit) -> Result<(), Invalid>,
) -> Result<(), Invalid> {
    let all = given.spec.owners().count();
    if all > MOST_ABSORBERS {
        let rule = format!("give {MOST_ABSORBERS} units of all absorbers at most");
        return Err(Invalid::new("absorber", format!("{all} units"), rule));
    }
    for (absorber, unit) in given.spec.members() {
        take(&given.of_unit(absorber, unit), (unit, given.spec.units_of(absorber)))?;
    }
    Ok(())
}

/// Mass ratio and clearance of one unit: units share the mass, and their gaps spread.
///
/// # Errors
/// [`Invalid`] for a spread that leaves the narrowest gap no width.
pub(super) fn shared<R: Real>(
    given: &Given<'_, R>,
    (unit, count): Unit,
    [mass_ratio, clearance]: [R; 2],
) -> Result<[R; 2], Invalid> {
    if count == 1 {
        return Ok([mass_ratio, clearance]);
    }
    let spread = given.get(FieldId::ClearanceSpread).unwrap_or(R::ZERO);
    let place = 2.0 * unit as f64 / (count - 1) as f64 - 1.0;
    let clearance = clearance * (R::ONE + spread * place);
    if clearance <= 0.0 {
        let rule = "the narrowest gap has no width; give less than 1";
        return Err(Invalid::new(given.path(FieldId::ClearanceSpread), number(spread), rule));
    }
    Ok([mass_ratio / count as f64, clearance])
}

/// An error of the start, whose field names the absorber of the list, with its unit only where that has a start of its own.
pub(super) fn of_owner<R: Real>(given: &Given<'_, R>, error: Invalid) -> Invalid {
    let named = error.field.strip_prefix("start.").and_then(|rest| rest.split_once('.'));
    let found = named.and_then(|(place, name)| {
        let (absorber, unit) = given.spec.members().nth(place.parse().ok()?)?;
        let owner = given.of_unit(absorber, unit);
        Some((owner, owner.path(FieldId::find(Part::Start, name)?)))
    });
    match found {
        Some((owner, field)) => free_mass::misplaced(&owner, Invalid { field, ..error }),
        None => error,
    }
}

/// An error of a unit of a list, whose field names the absorber instead.
pub(super) fn of_unit<R: Real>(given: &Given<'_, R>, error: Invalid) -> Invalid {
    let named = error.field.strip_prefix("absorber.").and_then(|rest| rest.split_once('.'));
    let found = named.and_then(|(place, name)| {
        let owner = given.of(given.spec.owners().nth(place.parse().ok()?)?);
        let number = owner.slot(FieldId::Clearance).number;
        let number = number.map_or_else(String::new, |number| format!(".{number}"));
        Some(format!("{}{number}.{name}", Part::Absorber.name()))
    });
    Invalid { field: found.unwrap_or_else(|| error.field.clone()), ..error }
}

/// One unit of an absorber as a mass in its gap.
pub(super) fn mass<R: Real>(
    given: &Given<'_, R>,
    unit: Unit,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<FreeMass<R>, Invalid> {
    let offset = given.length(FieldId::GapOffset, FieldId::GapOffsetMm, units)?;
    let mut mass = if given.choices().kind == Kind::Stop {
        let clearance = given.clearance(given.displacement(units)?, units)?;
        FreeMass::on_ground(restitution::restitution(given)?, clearance)?
    } else {
        let Common { mass_ratio, restitution, clearance, .. } = given.common(scale, units)?;
        let [mass_ratio, clearance] = shared(given, unit, [mass_ratio, clearance])?;
        FreeMass::new(mass_ratio, restitution, clearance)?
    };
    if let Some(wall) = given.choices().walls.only() {
        mass = mass.with_only(wall);
    }
    if let Some(offset) = offset {
        mass = mass.with_offset(offset)?;
    }
    if let Some(restitution) = given.get(FieldId::RestitutionMinus) {
        mass = mass.with_restitution_minus(restitution)?;
    }
    let laws = restitution::laws(given, scale.natural_frequency)?;
    Ok(laws.map_or(mass, |laws| mass.with_restitution_laws(laws)))
}
