//! The impact law of a mass with friction: that of a free mass. Friction is finite and changes no velocity in an instant.

use super::{Sliding, SlidingState};
use crate::absorber::impact::Impact;
use crate::absorber::{ImpactLaw, LawAt, Wall};
use crate::number::real::Real;

impl<R: Real> ImpactLaw for Sliding<R> {
    fn law_of(&self, absorber: usize, wall: Wall, approach: R) -> LawAt<R> {
        self.level.law_of(absorber, wall, approach)
    }

    fn impact(&self, state: &SlidingState<R>, time: R) -> (SlidingState<R>, Impact<R>) {
        let (after, impact) = self.going(state.direction).impact(&state.seen, time);
        (self.leaving(&after), impact)
    }

    fn stick(&self, state: &SlidingState<R>) -> (SlidingState<R>, R) {
        let (seen, loss) = self.going(state.direction).stick(&state.seen);
        (SlidingState { seen, ..*state }, loss)
    }
}
