//! The progress of a sweep: counts of what was done.

use std::ops::AddAssign;

use iva_core::simulate::Outcome;

/// Counts over some points.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Done {
    /// Number of points run.
    pub points: u64,
    /// Number of points with another outcome than `finished`.
    pub failed: u64,
    /// Number of segments of flight and stick episode computed.
    pub work: u64,
}

impl Done {
    /// The counts of one point, from the name of its outcome.
    pub(crate) fn run(outcome: &str, work: u64) -> Self {
        Self { points: 1, failed: u64::from(outcome != Outcome::Finished.name()), work }
    }
}

impl AddAssign for Done {
    fn add_assign(&mut self, other: Self) {
        self.points += other.points;
        self.failed += other.failed;
        self.work += other.work;
    }
}
