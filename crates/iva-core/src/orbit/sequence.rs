//! From an orbit to its chain of impacts and back.

use nalgebra::Vector4;

use super::chain::{Chain, flown};
use super::coordinates::Coordinates;
use super::episode::Lapse;
use super::periodic::{Missed, Orbit, through};
use super::{Cycle, Trajectory};
use crate::absorber::{Clock, Wall};
use crate::engine::observe::{Contact, Observer};
use crate::engine::simulate::{Instant, Limits, Outcome, resume};
use crate::run::side_by_side::Tier;

/// An impact of a run, or the first one of a stick episode.
#[derive(Debug)]
struct Struck {
    time: f64,
    wall: Wall,
    /// The coordinates just after.
    after: Vector4<f64>,
    /// True if it begins a stick episode.
    sticks: bool,
}

/// The impacts of a run. As in [`StickEpisode`](crate::engine::observe::StickEpisode), an episode begins with the first
/// impact after which only its wall is met until the stick.
#[derive(Debug, Default)]
struct Sequence {
    impacts: Vec<Struck>,
    /// The index of the first of the last impacts, which are on one wall, since the last stick.
    streak: Option<usize>,
    /// True if there was a stick without an impact.
    at_rest: bool,
}

impl<S: Coordinates> Observer<S> for Sequence {
    fn looks_within(&self) -> bool {
        false
    }

    fn contact(&mut self, system: &S, contact: &Contact<'_, S::State>) {
        let Contact { time, states: [before, after], summed } = *contact;
        if summed {
            return;
        }
        let wall = system.wall(before);
        let goes_on = self.impacts.last().is_some_and(|last| last.wall == wall);
        if self.streak.is_none() || !goes_on {
            self.streak = Some(self.impacts.len());
        }
        self.impacts.push(Struck { time, wall, after: system.coordinates(after), sticks: false });
    }

    fn stick(&mut self, _system: &S, _from: &Instant<S::State>) {
        let Some(first) = self.streak.take() else {
            self.at_rest = true;
            return;
        };
        self.impacts.truncate(first + 1);
        if let Some(first) = self.impacts.last_mut() {
            first.sticks = true;
        }
    }
}

/// Why an orbit has no chain of impacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoChain {
    /// There are no impacts, or a stick without one, or the run did not end.
    NoImpacts,
    /// The second half of the cycle is not the mirror image of the first.
    NotSymmetric,
}

impl Chain {
    /// The chain of an orbit that takes some cycles of the drive, with the values of its unknowns.
    ///
    /// # Errors
    /// [`NoChain`] if it has none.
    pub fn of<S: Coordinates>(orbit: &Orbit<S>, cycles: u32) -> Result<(Self, Vec<f64>), NoChain> {
        let Trajectory { system, state, cycle, .. } = &orbit.trajectory;
        let from = Instant { time: Clock::new(cycle.begin), state: *state };
        let limits = Limits::new(cycle.begin + cycle.length, system.clearance());
        let mut seen = Sequence::default();
        let tally = resume(system, &from, &limits, None, &mut seen);
        if !tally.is_ok_and(|tally| tally.outcome == Outcome::Finished) {
            return Err(NoChain::NoImpacts);
        }
        let Sequence { impacts, at_rest, .. } = seen;
        let Some(&Struck { time: begin, after, .. }) = impacts.first().filter(|_| !at_rest) else {
            return Err(NoChain::NoImpacts);
        };
        let count = if orbit.symmetric { impacts.len() / 2 } else { impacts.len() };
        let (first, second) = impacts.split_at(count);
        if orbit.symmetric {
            let alike =
                |(a, b): (&Struck, &Struck)| a.wall == b.wall.opposite() && a.sticks == b.sticks;
            if count == 0 || second.len() != count || !first.iter().zip(second).all(alike) {
                return Err(NoChain::NotSymmetric);
            }
        }
        let chain = Chain {
            walls: first.iter().map(|impact| impact.wall).collect(),
            sticks: first.iter().map(|impact| impact.sticks).collect(),
            symmetric: orbit.symmetric,
            cycles,
        };
        let mut unknowns = vec![begin, after[0], after[1], after[3]];
        unknowns.extend(first[1..].iter().map(|impact| impact.time));
        Ok((chain, unknowns))
    }

    /// The orbit of values of the unknowns, where a cycle of the scene has a length. It begins in the middle of the longest
    /// flight, not before an instant and within a cycle from there; its multipliers and residual are those of a run from there. At a grazing, and where an impact vanishes, the run
    /// may have an impact more or less than the chain.
    ///
    /// # Errors
    /// [`Missed`] if there is no such orbit, or one of its chatters does not end in stick.
    pub fn orbit<S: Coordinates + Clone>(
        &self,
        system: &S,
        cycle: f64,
        unknowns: &[f64],
        not_before: f64,
    ) -> Result<Orbit<S>, Missed> {
        let lost = Missed::Stalled(f64::INFINITY);
        let passed = self.passed(system, self.length(cycle), unknowns, false);
        let passed = passed.map_err(|lapse| match lapse {
            Lapse::Leaves(_) => Missed::NoStick,
            Lapse::Undefined => lost.clone(),
        })?;
        let longest = passed.flights.iter().max_by(|a, b| a.length.total_cmp(&b.length));
        let flight = longest.ok_or(lost.clone())?;
        let half = 0.5 * flight.length;
        let (middle, _) = flown(system, &flight.from, half).ok_or(lost.clone())?;
        let at = system.coordinates(&middle);
        let start = system.start_at(&at).ok_or(lost)?;
        let length = cycle * f64::from(self.cycles);
        let begin = not_before + (flight.begin + half - not_before).rem_euclid(length);
        let state = system.begin_at(&start, Clock::new(begin));
        let cycle = Cycle { begin, length };
        let trajectory = Trajectory { system: system.clone(), state, cycle, tier: Tier::Exact };
        let orbit = through(trajectory, self.symmetric, None)?;
        // Where a stick begins, the run may not show it.
        let sticks = |chain: &Self| chain.sticks.iter().filter(|sticks| **sticks).count();
        let shows = |(shown, _): (Self, _)| sticks(&shown) >= sticks(self);
        if sticks(self) == 0 || Self::of(&orbit, self.cycles).is_ok_and(shows) {
            Ok(orbit)
        } else {
            Err(Missed::NoStick)
        }
    }
}
