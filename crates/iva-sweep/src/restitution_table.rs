//! A restitution as measured: a table of it over the approach speed, which a user gives in the place of a number.

use std::sync::Arc;

use iva_core::absorber::restitution::RestitutionLaw;
use iva_core::real::Real;

use crate::error::{Invalid, number};
use crate::fields::Allowed;

/// Its name among the fields of an absorber.
pub const NAME: &str = "restitution_table";

/// What the core calls the points of a table in its errors.
const POINTS: &str = "absorber.restitution.points";

/// Points (approach speed, restitution): between them the restitution is linear, outside of them constant. Speeds are in
/// the user's unit, as `reference_speed` is.
#[derive(Debug, Clone, PartialEq)]
pub struct RestitutionTable(Arc<[[f64; 2]]>);

impl RestitutionTable {
    /// A table of points that stands at this path.
    ///
    /// # Errors
    /// As [`RestitutionLaw::table`], with the path in the place of its field, and for a speed that is neither 0 nor from
    /// 1e-30 to 1e30.
    pub(crate) fn new(path: &str, points: &[[f64; 2]]) -> Result<Self, Invalid> {
        for (index, [speed, _]) in points.iter().enumerate() {
            if !Allowed::NonNegative.contains(*speed) {
                let field = format!("{path}[{index}].speed");
                let rule = format!("give {}", Allowed::NonNegative.words());
                return Err(Invalid::new(field, number(*speed), rule));
            }
        }
        RestitutionLaw::table(points).map_err(|error| named(path, error))?;
        Ok(Self(points.into()))
    }

    /// The points.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.0
    }

    /// The law, with speeds over ω.
    ///
    /// # Errors
    /// As [`RestitutionTable::new`]: in natural units a speed may be out of range, or equal to the one before it.
    pub(crate) fn law<R: Real>(&self, path: &str, omega: R) -> Result<RestitutionLaw<R>, Invalid> {
        let given = |value| R::from(value);
        let point = |[speed, e]: &[f64; 2]| [given(*speed) / omega, given(*e)];
        let points: Vec<[R; 2]> = self.0.iter().map(point).collect();
        RestitutionLaw::table(&points).map_err(|error| named(path, error))
    }

    /// What stands for it in a message.
    pub(crate) fn shown(&self) -> String {
        match self.0.len() {
            1 => "a table of 1 point".to_owned(),
            count => format!("a table of {count} points"),
        }
    }
}

/// An error of the core about a table that stands at this path.
fn named(path: &str, error: Invalid) -> Invalid {
    match error.field.strip_prefix(POINTS) {
        Some(place) => Invalid { field: format!("{path}{place}"), ..error },
        None => error,
    }
}
