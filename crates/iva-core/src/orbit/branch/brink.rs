//! Where a branch ends within a stick episode: at the last orbit before one that has another chatter, or no stick.
//!
//! Beyond, the equations of the chain have no solution, or none that this branch goes over into. So that orbit is approached by
//! steps along the branch, down to rounding. Where the stick begins, how long the absorber sticks is no smooth number, and steps
//! fail a little before it does not stick any more; from there on the point is sought on the tangent of the branch, by the
//! late rebounds (`orbit/episode.rs`), which are the same to rounding.

use super::super::conditions::Condition;
use super::super::coordinates::Coordinates;
use super::super::episode::Late;
use super::SpecialPoint;
use super::follower::{Follower, Stop};

/// Length of a step, in scales, below which the end of a branch within an episode is sought.
pub(super) const BRINK: f64 = 1e-4;
/// Beyond a step of this length the reason is seen why there is no orbit.
const CLOSE: f64 = 1e-8;
/// Smallest step, and most steps that are tried.
const FINEST: f64 = 1e-15;
const MOST_TRIALS: u32 = 400;
/// How far the tangent is the branch to rounding, in scales.
const STRAIGHT: f64 = 1e-6;

impl<S: Coordinates> Follower<'_, S> {
    /// The last point within a step, and what ends the branch there; `None` if another episode is not what ends it.
    pub fn brink(&self, now: &Stop, step: f64) -> Option<(Stop, SpecialPoint)> {
        let (mut last, mut step, mut beyond, mut seen) = (now.clone(), step, None, false);
        for _ in 0..MOST_TRIALS {
            if step < FINEST {
                break;
            }
            match self.next(&last, step) {
                Ok(stop) => last = stop,
                Err(met) => {
                    beyond = met.or(beyond);
                    seen |= met.is_some() && step < CLOSE;
                    step *= 0.5;
                }
            }
        }
        let condition = beyond?;
        let at = match condition {
            Condition::StickBegins { impact } => self.before_stick_begins(&last, impact),
            _ => None,
        };
        // Of a stick that begins the late rebounds tell as much.
        if !seen && at.is_none() {
            return None;
        }
        let mut special = SpecialPoint { condition, at: last.at.clone() };
        if let Some(length) = at {
            let point = self.ahead(&last, length);
            let (unknowns, numbers) = point.as_slice().split_at(last.at.unknowns.len());
            special.at.value = numbers[0];
            special.at.unknowns = unknowns.to_vec();
            special.at.length += self.towards * length;
        }
        Some((last, special))
    }

    /// How far a point is from that at which the stick after an impact begins, along the tangent; `None` if it is not seen.
    fn before_stick_begins(&self, last: &Stop, impact: usize) -> Option<f64> {
        let (_, restitution) = self.family.rebounds(&last.on.point, impact)?;
        let late = Late::of(last.tests.episode(impact)?, restitution)?;
        let sticks = |length: f64| {
            let rebounds = self.family.rebounds(&self.ahead(last, length), impact);
            rebounds.is_some_and(|(rebounds, _)| late.sticks(&rebounds))
        };
        let [mut low, mut high] = [0.0, FINEST];
        while sticks(high) {
            (low, high) = (high, 2.0 * high);
            if high > STRAIGHT {
                return None;
            }
        }
        while high - low > 0.1 * FINEST {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if sticks(middle) { low = middle } else { high = middle }
        }
        Some(low)
    }
}
