//! The restitution of a free mass as it is given: a number, or a law by which it depends on the approach speed.
//!
//! | given | law |
//! |---|---|
//! | `restitution` | a number |
//! | `restitution`, `reference_speed`, and `restitution_exponent` | a power law |
//! | `yield_speed` | that of elastic and perfectly plastic spheres |
//! | `restitution_table` | linear between points |

use iva_core::absorber::restitution::RestitutionLaw;
use iva_core::real::Real;

use super::given::Given;
use crate::error::{Invalid, number};
use crate::fields::{FieldId, quotient};

/// b of a power law, unless it is given: that of viscoelastic spheres at low speeds.
const EXPONENT: [u32; 2] = [1, 5];

/// The restitution that must be given, of plastic spheres and of a table that of slow impacts.
///
/// # Errors
/// [`Invalid`] if it is missing.
pub(super) fn restitution<R: Real>(given: &Given<'_, R>) -> Result<R, Invalid> {
    if given.get(FieldId::YieldSpeed).is_some() {
        return Ok(R::ONE);
    }
    let table = given.spec.restitution_table(given.absorber);
    if let Some([_, slow]) = table.and_then(|table| table.points().first()) {
        return Ok(R::from(*slow));
    }
    given.get(FieldId::Restitution).ok_or_else(|| {
        Invalid::missing(given.path(FieldId::Restitution), "give a number from 0 to 1")
    })
}

/// The laws at wall + and at wall −; `None` where the restitution is a number.
///
/// # Errors
/// [`Invalid`] for what the law does not have.
pub(super) fn laws<R: Real>(
    given: &Given<'_, R>,
    omega: R,
) -> Result<Option<[RestitutionLaw<R>; 2]>, Invalid> {
    let refused = |fields: &[FieldId], rule: String| {
        let found = fields.iter().find_map(|field| Some((*field, given.get(*field)?)));
        found.map_or(Ok(()), |(field, value)| {
            Err(Invalid::new(given.path(field), number(value), rule))
        })
    };
    use FieldId as F;
    let others = [F::Restitution, F::RestitutionMinus, F::ReferenceSpeed, F::RestitutionExponent];
    if let Some(table) = given.spec.restitution_table(given.absorber) {
        let path = given.spec.table_path(given.absorber);
        let rule = format!("{path} is given as well; give one of them");
        refused(&[F::YieldSpeed], rule.clone())?;
        refused(&others, rule)?;
        return Ok(Some([table.law(&path, omega)?; 2]));
    }
    if let Some(speed) = given.get(F::YieldSpeed) {
        let rule = format!("{} is given as well; give one of them", given.path(F::YieldSpeed));
        refused(&others, rule)?;
        return Ok(Some([RestitutionLaw::plastic(speed / omega)?; 2]));
    }
    let Some(speed) = given.get(FieldId::ReferenceSpeed).map(|speed| speed / omega) else {
        let rule = "it is of a power law; give reference_speed too".to_owned();
        refused(&[FieldId::RestitutionExponent], rule)?;
        return Ok(None);
    };
    let plus = restitution(given)?;
    let minus = given.get(FieldId::RestitutionMinus).unwrap_or(plus);
    let exponent = given.spec.get_of(given.absorber, FieldId::RestitutionExponent);
    let exponent = exponent.and_then(quotient).unwrap_or(EXPONENT);
    let through = |e| RestitutionLaw::through(e, speed, exponent);
    Ok(Some([through(plus)?, through(minus)?]))
}
