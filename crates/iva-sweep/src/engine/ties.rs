//! Linear springs and dashpots between free masses and their structure.
//!
//! A mass that has one is a coordinate of the structure (`absorber/modal/ties.rs` of the core), so a structure that moves
//! as one is run as one of a single mode.

use iva_core::absorber::modal::Tie;
use iva_core::range;
use iva_core::real::Real;

use super::given::Given;
use super::scale::Scale;
use crate::choices::Kind;
use crate::error::{Invalid, number};
use crate::fields::FieldId;
use crate::units::UnitSystem;

/// The fields that tell a spring, and those that tell a dashpot.
const FIELDS: [[FieldId; 2]; 2] =
    [[FieldId::Spring, FieldId::SpringRatio], [FieldId::GapDamping, FieldId::GapDampingRatio]];
/// What ties the mass of an absorber to the structure, of all its units together, from the mass ratio of all.
///
/// # Errors
/// [`Invalid`] if it is given twice, or in N/m or N s/m without a mass.
pub(super) fn tie<R: Real>(
    given: &Given<'_, R>,
    mass_ratio: R,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<Tie<R>, Invalid> {
    FIELDS.iter().try_for_each(|fields| given.at_most_one(fields))?;
    let omega = scale.natural_frequency;
    let in_si = |field: FieldId, unit: R, ratio: &str| match given.get(field) {
        Some(value) if units == UnitSystem::Si => Ok(Some(value / unit)),
        Some(value) if value != 0.0 => {
            Err(given.needs_mass(field, value, &format!("or give {ratio}")))
        }
        _ => Ok(None),
    };
    let spring = in_si(FieldId::Spring, scale.mass * omega * omega, "spring_ratio")?;
    let of_ratio = match given.get(FieldId::SpringRatio) {
        Some(ratio) => {
            let spring = mass_ratio * (ratio * ratio);
            let field = given.path(FieldId::SpringRatio);
            range::size(&field, spring).map_err(|error| {
                let rule = format!("{} for k/(M ωn²), which is {}", error.allowed, number(spring));
                Invalid::new(field.clone(), number(ratio), rule)
            })?;
            Some(spring)
        }
        None => None,
    };
    let damping = in_si(FieldId::GapDamping, scale.mass * omega, "gap_damping_ratio")?;
    let of_damping = || given.get(FieldId::GapDampingRatio).map(|ratio| ratio * 2.0);
    Ok(Tie {
        spring: spring.or(of_ratio).unwrap_or(R::ZERO),
        damping: damping.or_else(of_damping).unwrap_or(R::ZERO),
    })
}

/// The first field that ties a free mass to the structure, with its path and value.
pub(crate) fn given<R: Real>(given: &Given<'_, R>) -> Option<(String, f64)> {
    let masses = (0..given.spec.count()).map(|absorber| given.of(absorber));
    masses.filter(|it| it.choices().kind == Kind::Siva).find_map(|own| {
        FIELDS.as_flattened().iter().find_map(|field| {
            let of = own.spec.get_of(own.absorber, *field);
            Some((own.path(*field), of.filter(|value| *value != 0.0)?))
        })
    })
}
