//! The ranges of numbers that a run accepts.
//!
//! Within these bounds no square, product or quotient of the motion leaves the range of a double, down to the
//! lowest rebound: nothing overflows, and no underflow affects a result.

use crate::error::{Invalid, number};
use crate::number::real::Real;

/// Smallest size of a length, velocity or time other than 0, in natural units.
pub const SMALLEST: f64 = 1e-75;
/// Largest size of a length, velocity or time in natural units.
pub const LARGEST: f64 = 1e75;
/// Largest mass ratio and damping ratio.
pub const LARGEST_RATIO: f64 = 1e9;
/// Largest tolerance of a flight; with a larger one a step is no useful approximation.
pub const LARGEST_TOLERANCE: f64 = 1e-3;

/// The same length or velocity, or 0 if it is smaller than a run accepts.
pub(crate) fn or_zero(value: f64) -> f64 {
    if value.abs() < SMALLEST { 0.0 } else { value }
}

/// Checks a length or velocity of either sign.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn size<R: Real>(field: &str, value: R) -> Result<(), Invalid> {
    let allowed = value == 0.0 || (SMALLEST..=LARGEST).contains(&value.double().abs());
    check(allowed, field, value, || format!("0 or a number of size {SMALLEST:e} to {LARGEST:e}"))
}

/// Checks a length, velocity or time that must be greater than 0.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn positive<R: Real>(field: &str, value: R) -> Result<(), Invalid> {
    let allowed = (SMALLEST..=LARGEST).contains(&value.double());
    check(allowed, field, value, || format!("a number from {SMALLEST:e} to {LARGEST:e}"))
}

/// Checks a mass ratio.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn mass_ratio<R: Real>(field: &str, value: R) -> Result<(), Invalid> {
    let allowed = value > 0.0 && value <= LARGEST_RATIO;
    check(allowed, field, value, || format!("a number greater than 0, at most {LARGEST_RATIO:e}"))
}

/// Checks a damping ratio.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn damping_ratio<R: Real>(field: &str, value: R) -> Result<(), Invalid> {
    let allowed = (0.0..=LARGEST_RATIO).contains(&value.double());
    check(allowed, field, value, || format!("a number from 0 to {LARGEST_RATIO:e}"))
}

/// Checks a coefficient of restitution.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn restitution<R: Real>(field: &str, value: R) -> Result<(), Invalid> {
    check((0.0..=1.0).contains(&value.double()), field, value, || "a number from 0 to 1".to_owned())
}

/// Checks a tolerance of the flight.
///
/// # Errors
/// [`Invalid`] naming field, value and allowed range.
pub fn tolerance<R: Real>(field: &str, value: R) -> Result<(), Invalid> {
    check((0.0..=LARGEST_TOLERANCE).contains(&value.double()), field, value, || {
        format!("a number from 0 to {LARGEST_TOLERANCE:e}")
    })
}

fn check<R: Real>(
    allowed: bool,
    field: &str,
    value: R,
    range: impl FnOnce() -> String,
) -> Result<(), Invalid> {
    if allowed {
        Ok(())
    } else {
        Err(Invalid::new(field, number(value), format!("give {}", range())))
    }
}
