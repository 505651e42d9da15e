//! What a lane has done by itself, until its run does the same.

use super::RunOf;
use super::round::State;
use crate::absorber::Clock;
use crate::absorber::several::{Several, SeveralState};
use crate::run::side_by_side::SideBySide;
use crate::run::structures::Structures;

/// Number of stretches after which the run takes them, so that a long run needs no more memory.
const FULL: usize = 64;

/// A stretch of a lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch<P, const K: usize> {
    /// Its length, and the state at its end.
    pub h: f64,
    pub end: State<P, K>,
    /// The impact after it.
    pub impact: Option<Impact<P, K>>,
}

/// The impact of one mass of a lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Impact<P, const K: usize> {
    /// The index of the mass.
    pub which: usize,
    /// The instant.
    pub clock: Clock,
    /// The state in contact.
    pub touching: State<P, K>,
}

/// The stretches of a lane, in order of time: those that end with an impact, or all if observers look within them.
#[derive(Debug)]
pub(super) struct Log<P, const K: usize> {
    stretches: Vec<Stretch<P, K>>,
    /// True if observers look within stretches.
    pub looks: bool,
}

impl<P, const K: usize> Default for Log<P, K> {
    fn default() -> Self {
        Self { stretches: Vec::new(), looks: false }
    }
}

impl<P: Copy, const K: usize> Log<P, K> {
    /// True if the run is to take the stretches.
    pub fn is_full(&self) -> bool {
        self.stretches.len() >= FULL
    }

    /// Logs a stretch.
    pub fn push(&mut self, stretch: &Stretch<P, K>) {
        self.stretches.push(*stretch);
    }

    /// Lets a run go through the stretches.
    pub fn tell<S: Structures<Phase = P>>(&mut self, run: &mut RunOf<'_, S>)
    where
        Several<S::Host>: SideBySide<State = SeveralState<S::Host>>,
    {
        let mut state = run.tally.state;
        for Stretch { h, end, impact } in self.stretches.drain(..) {
            if let Some(Impact { which, .. }) = impact {
                run.turn_to(which);
            }
            if self.looks {
                end.put_into(&mut state);
                run.flown(h, &state);
            } else if let Some(decay) = &mut run.observer.measures.decay {
                decay.v_before = end.host.primary.v.value;
            }
            if let Some(Impact { which, clock, touching }) = impact {
                run.progress.clock = clock;
                touching.put_into(&mut state);
                run.strike_by(which, &state);
                run.observer.measures.begins(run.system, clock, &run.tally.state, false);
            }
        }
    }
}
