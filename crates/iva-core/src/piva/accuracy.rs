//! Order and step of the flight, from its tolerance.

use crate::real::{LEFT_OUT, Real};
use crate::taylor::ORDER;

/// How accurately a flight is computed, and at what cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Accuracy {
    /// What a step may leave out, relative to the size of each variable.
    pub tolerance: Real,
    /// Order of the series.
    pub order: usize,
    /// Longest step, over the fastest time scale of the motion.
    pub longest_step: f64,
}

impl Accuracy {
    /// Order and step that are cheap for a tolerance; 0 means full accuracy.
    pub fn of(tolerance: Real) -> Self {
        let tolerance = tolerance.max(LEFT_OUT);
        let (order, longest_step) = match tolerance {
            t if t >= 1e-7 => (10, 0.9),
            t if t >= 1e-10 => (16, 1.2),
            t if t >= 1e-13 => (18, 1.0),
            _ => (ORDER, 0.75),
        };
        Self { tolerance, order, longest_step }
    }
}
