//! Order and step of the flight, from its tolerance.

use crate::taylor::ORDER;

/// What a step may leave out at full accuracy: as much as rounding does. It is a proven bound; what
/// is left out in fact is some ten times less or more.
const FULL: f64 = 1e-16;

/// How accurately a flight is computed, and at what cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Accuracy {
    /// What a step may leave out, relative to the size of each variable.
    pub tolerance: f64,
    /// Order of the series.
    pub order: usize,
    /// Longest step, over the fastest time scale of the motion.
    pub longest_step: f64,
}

impl Accuracy {
    /// Order and step that are cheap for a tolerance; 0 means full accuracy.
    pub fn of(tolerance: f64) -> Self {
        let tolerance = tolerance.max(FULL);
        let (order, longest_step) = match tolerance {
            t if t >= 1e-7 => (10, 0.9),
            t if t >= 1e-10 => (16, 1.2),
            t if t >= 1e-13 => (18, 1.0),
            _ => (ORDER, 0.75),
        };
        Self { tolerance, order, longest_step }
    }
}
