//! The limits of a run, and the ways in which it can end.

use crate::error::Invalid;
use crate::number::real::Real;
use crate::range;

/// The length of a run and its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits<R = f64> {
    /// The instant at which the run ends, in 1/ωn: its length, if it begins at time zero.
    pub duration: R,
    /// Largest number of listed impacts. Rebounds at or below the floor are counted only after their chatter
    /// ends without sticking.
    pub max_impacts: u64,
    /// Largest number of segments of flight or stick episode, and of impulses; steps of a coast do not count.
    pub max_work: u64,
    /// Chatter floor: rebounds of a stick episode at or below this approach speed are not listed.
    pub chatter_floor: R,
}

impl Limits {
    /// Default of `max_impacts`.
    pub const MAX_IMPACTS: u64 = 10_000_000;
    /// Default of `max_work`.
    pub const MAX_WORK: u64 = 100_000_000;
    /// Default of `chatter_floor` as a share of the clearance, times ωn.
    pub const CHATTER_FLOOR: f64 = 1e-6;
}

impl<R: Real> Limits<R> {
    /// Default limits for a run of this duration with this clearance.
    pub fn new(duration: R, clearance: R) -> Self {
        Self {
            duration,
            max_impacts: Limits::MAX_IMPACTS,
            max_work: Limits::MAX_WORK,
            chatter_floor: clearance * Limits::CHATTER_FLOOR,
        }
    }

    /// Checks that duration and chatter floor are in [`crate::range`].
    ///
    /// # Errors
    /// [`Invalid`] naming field and value.
    pub fn check(&self) -> Result<(), Invalid> {
        range::positive("run.duration", self.duration)?;
        range::positive("run.chatter_floor", self.chatter_floor)
    }
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// The whole duration was run.
    Finished,
    /// `max_impacts` was reached.
    ImpactLimit,
    /// `max_work` was reached.
    WorkLimit,
    /// A state overflowed.
    NotFinite,
    /// The caller asked to stop.
    Cancelled,
    /// An observer had seen enough.
    Stopped,
}

impl Outcome {
    /// The name in the tables.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Finished => "finished",
            Outcome::ImpactLimit => "impact_limit",
            Outcome::WorkLimit => "work_limit",
            Outcome::NotFinite => "not_finite",
            Outcome::Cancelled => "cancelled",
            Outcome::Stopped => "stopped",
        }
    }
}
