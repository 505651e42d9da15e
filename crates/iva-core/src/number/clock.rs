//! Instants.

use super::compensated::DoubleDouble;

/// An instant of the run in 1/ωn, in double-double.
pub type Clock<R = f64> = DoubleDouble<R>;

/// Relative distance within which an instant counts as that of an event: times in tables were rounded to the
/// user's unit and are converted back.
pub(crate) const SLACK: f64 = 4.0 * f64::EPSILON;
