//! The impacts of lanes, and the states after them, until their runs take them.

use super::{FreeMasses, Tier, TierRun};
use crate::absorber::impact::Impact;
use crate::absorber::plain::State;
use crate::absorber::siva::trial::FreeMass as _;
use crate::absorber::siva::{Siva, SivaState};
use crate::absorber::{Clock, Wall};
use crate::host::{Host, Phase};
use crate::number::arrays::Lanes as _;

/// The impacts of a lane that its run has not taken yet.
#[derive(Debug)]
pub(super) struct Struck<State> {
    impacts: Vec<Impact>,
    /// The states after them, if the errors of the run are estimated.
    after: Option<Vec<State>>,
}

/// Number of states after which the errors of a run are estimated, so that a long run needs no more memory.
const MOST_STATES: usize = 512;

impl<State> Struck<State> {
    /// True if the states are to be taken.
    pub fn is_full(&self) -> bool {
        self.after.as_ref().is_some_and(|after| after.len() >= MOST_STATES)
    }
}

impl<T: Tier, const W: usize> FreeMasses<T, W> {
    /// Lists the impacts that the trials have found; true if a list is full.
    #[inline(never)]
    pub(super) fn list(&mut self) -> bool {
        let mut full = false;
        for (i, struck) in self.struck.iter_mut().enumerate() {
            let (round, lane) = (self.rounds.get(i), self.lanes.get(i));
            if round.hit {
                let after = self.states.get(i);
                let State { x, v, side, rate, .. } = T::Mass::in_doubles(&after);
                if let Some(states) = &mut struck.after {
                    states.push(after);
                }
                full |= struck.is_full();
                struck.impacts.push(Impact {
                    time: lane.progress.clock.value,
                    absorber: 0,
                    wall: if side > 0.0 { Wall::Plus } else { Wall::Minus },
                    displacement: x,
                    velocity_before: round.v,
                    velocity_after: v,
                    gap_velocity_before: side * -round.rate,
                    gap_velocity_after: -side * rate,
                    lever: 1.0,
                    energy_loss: lane.law(side).lost(round.rate),
                });
            }
        }
        full
    }
}

impl<H: Host<Real = f64>, T: Tier<System = Siva<H>>, const W: usize> FreeMasses<T, W> {
    /// Lists the impacts of a lane from now on, if its run wants them.
    pub fn listen(&mut self, i: usize, run: &TierRun<'_, T>) {
        let ((events, errors), (extremes, passes)) = &run.observer.beside;
        if extremes.is_some() || !passes.is_empty() {
            self.keep(i);
        }
        if events.is_some() || errors.is_some() {
            self.list_impacts(i, errors.is_some());
        }
    }

    /// Lists the impacts of a lane from now on, with the states after them or without.
    pub fn list_impacts(&mut self, i: usize, states: bool) {
        self.struck.resize_with(W, || Struck { impacts: Vec::new(), after: None });
        self.struck[i].after = states.then(Vec::new);
    }

    /// Hands the impacts of a lane to its run.
    pub fn tell(&mut self, i: usize, run: &mut TierRun<'_, T>) {
        let system = run.system;
        let ((events, errors), looks) = &mut run.observer.beside;
        self.show(i, system, looks);
        if let Some(errors) = errors {
            self.struck_states(i, system, |impact, states| {
                errors.struck(system, impact.time, states);
                errors.list(impact);
            });
        }
        let Some(struck) = self.struck.get_mut(i) else { return };
        match events {
            Some(events) => events.impacts.append(&mut struck.impacts),
            None => struck.impacts.clear(),
        }
    }

    /// Hands out the listed impacts of a lane, each with the states before and after it.
    fn struck_states(
        &mut self,
        i: usize,
        system: &T::System,
        mut take: impl FnMut(&Impact, [&SivaState<Phase<H>>; 2]),
    ) {
        let Some(Struck { impacts, after: Some(after) }) = self.struck.get_mut(i) else { return };
        {
            for (impact, after) in impacts.iter().zip(after.drain(..)) {
                let after = self.tier.shown(&after, system, Clock::new(impact.time));
                take(impact, [&after.before(impact), &after]);
            }
        };
    }

    /// Hands out the listed impacts of a lane, each with the states before and after it, and forgets them.
    pub fn take_struck(
        &mut self,
        i: usize,
        system: &T::System,
        take: impl FnMut(&Impact, [&SivaState<Phase<H>>; 2]),
    ) {
        self.struck_states(i, system, take);
        if let Some(struck) = self.struck.get_mut(i) {
            struck.impacts.clear();
        }
    }
}
