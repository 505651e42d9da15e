//! Linear dashpots between free masses and their structure.
//!
//! A mass with a dashpot is a coordinate of the structure (`absorber/modal/dashpot.rs` of the core), so a structure that moves
//! as one is run as one of a single mode.

use iva_core::absorber::modal::ModalStructure;
use iva_core::real::Real;

use super::given::Given;
use super::scale::Scale;
use crate::error::Invalid;
use crate::fields::FieldId;
use crate::units::UnitSystem;

/// The fields that tell a dashpot.
const FIELDS: [FieldId; 2] = [FieldId::GapDamping, FieldId::GapDampingRatio];
/// The name of the only point of a structure that moves as one.
pub(super) const PRIMARY: &str = "primary";

/// c/(M ωn) of an absorber, of all its units together; 0 without a dashpot.
///
/// # Errors
/// [`Invalid`] if it is given twice, or in N s/m without a mass.
pub(super) fn damping<R: Real>(
    given: &Given<'_, R>,
    scale: &Scale<R>,
    units: UnitSystem,
) -> Result<R, Invalid> {
    given.at_most_one(&FIELDS)?;
    match given.get(FieldId::GapDamping) {
        Some(c) if units == UnitSystem::Si => Ok(c / (scale.mass * scale.natural_frequency)),
        Some(c) if c != 0.0 => {
            Err(given.needs_mass(FieldId::GapDamping, c, "or give gap_damping_ratio"))
        }
        _ => Ok(given.get(FieldId::GapDampingRatio).unwrap_or(R::ZERO) * 2.0),
    }
}

/// The first field that gives a dashpot to an absorber, with its path and value.
pub(crate) fn given<R: Real>(given: &Given<'_, R>) -> Option<(String, f64)> {
    (0..given.spec.count()).find_map(|absorber| {
        FIELDS.into_iter().find_map(|field| {
            let value = given.spec.get_of(absorber, field).filter(|value| *value != 0.0)?;
            Some((given.of(absorber).path(field), value))
        })
    })
}

/// The structure that moves as one.
///
/// # Errors
/// [`Invalid`] for a damping ratio out of range.
pub(super) fn primary<R: Real>(damping_ratio: R) -> Result<ModalStructure<R>, Invalid> {
    let one = [R::ONE];
    ModalStructure::new(&one, &[damping_ratio])?.with_point(PRIMARY, &one)?.with_base(&one)
}
