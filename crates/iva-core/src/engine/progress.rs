//! What each stretch of motion changes in a run, whether the run is alone or in a lane: the clock, the counts, and how
//! far the next stretch may go. After a stretch and after an impact the event loop and the lanes advance the clock and the
//! counts by these functions alone. The event loop sets them in three cases that lanes do not have: at the end of the
//! run, where it lists rebounds of a summed chatter, and where a chatter ends in stick (`engine/simulate/wall.rs`).

use super::counts::{Counted, Counts};
use super::limits::{Limits, Outcome};
use crate::number::arrays::laned;
use crate::number::clock::Clock;
use crate::number::real::{Real, pick};

/// The progress of a run, and its limits.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Progress<R = f64> {
    /// The clock, in 1/ωn.
    pub clock: Clock<R>,
    /// The instant at which the run ends, in 1/ωn.
    pub stop: R,
    /// The longest first search after a rebound on a pressing wall; infinite elsewhere.
    pub first: R,
    /// Chatter floor: impacts of a chatter with an approach speed at or below it may not stay listed.
    pub floor: R,
    /// Limits on the numbers of impacts and of stretches of motion.
    pub max_impacts: f64,
    pub max_work: f64,
    /// Counts and sums.
    pub counts: Counts<R>,
}

laned!(
    Progress,
    ManyProgress {
        clock: Clock,
        stop: f64,
        first: f64,
        floor: f64,
        max_impacts: f64,
        max_work: f64,
        counts: Counts,
    }
);

impl<R: Real> Progress<R> {
    /// That of a run with these limits which begins at an instant.
    pub fn new(clock: Clock<R>, limits: &Limits<R>) -> Self {
        Self {
            clock,
            stop: limits.duration,
            first: R::INFINITY,
            floor: limits.chatter_floor,
            max_impacts: limits.max_impacts as f64,
            max_work: limits.max_work as f64,
            counts: Counts::default(),
        }
    }

    /// That of a lane without a run, which never ends.
    pub fn idle() -> Self {
        let never = R::INFINITY;
        let [max_impacts, max_work] = [f64::INFINITY; 2];
        Self { stop: never, first: never, max_impacts, max_work, ..Self::default() }
    }

    /// The same run once more from an instant.
    pub fn repeated(&self, clock: Clock<R>) -> Self {
        Self { clock, first: R::INFINITY, counts: Counts::default(), ..*self }
    }

    /// The time to the end of the run.
    #[inline(always)]
    pub fn remaining(&self) -> R {
        -self.clock.minus(self.stop)
    }

    /// The longest that the next stretch may be.
    #[inline(always)]
    pub fn ahead(&self) -> R {
        self.remaining().min(self.first)
    }

    /// True if a limit is reached.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        (self.counts.listed() >= self.max_impacts) | (self.counts.work >= self.max_work)
    }

    /// The limit that is reached.
    pub fn limit(&self) -> Option<Outcome> {
        let impacts = self.counts.listed() >= self.max_impacts;
        let limit = if impacts { Outcome::ImpactLimit } else { Outcome::WorkLimit };
        self.is_full().then_some(limit)
    }

    /// Later by a time, high and low part, without a stretch of motion that counts.
    #[inline(always)]
    pub fn later(&self, time: Clock<R>) -> Self {
        Self { clock: self.clock.plus_parts(time.value, time.rest), ..*self }
    }

    /// After a stretch that ends at an instant, if it is completed; `first` is the longest first search from there.
    #[inline(always)]
    pub fn moved(&self, completed: bool, clock: Clock<R>, first: R) -> Self {
        Self {
            clock: Clock {
                value: pick(completed, clock.value, self.clock.value),
                rest: pick(completed, clock.rest, self.clock.rest),
            },
            first: pick(completed, first, self.first),
            counts: Counts { work: self.counts.work + pick(completed, 1.0, 0.0), ..self.counts },
            ..*self
        }
    }

    /// After an impact, if there is one.
    #[inline(always)]
    pub fn struck(&self, hit: bool, impact: &Counted<R>) -> Self {
        Self { counts: self.counts.after(hit, impact), ..*self }
    }
}
