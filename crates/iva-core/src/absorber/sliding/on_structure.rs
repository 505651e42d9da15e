//! A mass with friction on its structure: what drives it, impulses and energy.

use super::{Sliding, SlidingState};
use crate::absorber::{OnStructure, Point};
use crate::host::{DrivenHost, Host, Moment};
use crate::number::real::Real;

impl<R: Real> OnStructure for Sliding<R> {
    type Real = R;
    type Excitation = DrivenHost<R>;
    type State = SlidingState<R>;

    fn excitation(&self) -> &DrivenHost<R> {
        &self.level.host
    }

    fn phase(state: &SlidingState<R>) -> &Moment<R> {
        &state.seen.host.phase
    }

    fn with_drive_of(&self, state: &SlidingState<R>, like: &SlidingState<R>) -> SlidingState<R> {
        let host = &self.going(state.direction).host;
        let phase = host.taken_over(&like.seen.host.phase);
        let mut seen = state.seen;
        seen.host = host.state(phase, seen.host.primary);
        SlidingState { seen, ..*state }
    }

    fn mass_ratio(&self) -> R {
        self.level.mass_ratio()
    }

    fn primary(&self, state: &SlidingState<R>) -> Point<R> {
        self.level.primary(&state.seen)
    }

    /// Friction is no impulse: the mass keeps its velocity unless it is on a wall, and slides from then on.
    fn apply_impulse(&self, state: &SlidingState<R>, velocity: R, stuck: bool) -> SlidingState<R> {
        let seen = self.going(state.direction).apply_impulse(&state.seen, velocity, stuck);
        if stuck { SlidingState { seen, ..*state } } else { self.decided(&seen) }
    }

    fn energy(&self, state: &SlidingState<R>) -> R {
        self.level.energy(&state.seen)
    }
}
