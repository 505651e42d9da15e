//! How far a sweep is: counts of what was done.

use std::ops::AddAssign;

use iva_core::simulate::Outcome;

/// What some points came to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Done {
    /// Points run.
    pub points: u64,
    /// Those with another outcome than `finished`.
    pub failed: u64,
    /// Segments of flight and ride computed.
    pub work: u64,
}

impl Done {
    /// One point, by the name of its outcome.
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
