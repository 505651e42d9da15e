//! Free masses and pendulums on their structure: what drives it, impulses and energy.

use super::{Mixed, MixedState, OneOf, total};
use crate::absorber::{OnStructure, Point};
use crate::host::{Host, Phase};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

impl<R: Real, H: Host<Real = R>> OnStructure for Mixed<H> {
    type Real = R;
    type Excitation = H;
    type State = MixedState<H>;

    fn excitation(&self) -> &H {
        &self.host
    }

    fn phase(state: &Self::State) -> &Phase<H> {
        &state.phase
    }

    fn with_drive_of(&self, state: &Self::State, like: &Self::State) -> Self::State {
        MixedState { phase: like.phase, ..*state }
    }

    /// That of all together.
    fn mass_ratio(&self) -> R {
        total(&self.members)
    }

    fn mass_ratio_of(&self, absorber: usize) -> R {
        self.members.get(absorber).map_or(R::ZERO, |it| it.pendulum.mass_ratio)
    }

    fn primary(&self, state: &Self::State) -> Point<R> {
        Point { x: state.primary.x.value, v: state.primary.v.value }
    }

    fn energy(&self, state: &Self::State) -> R {
        let Point { x, v } = self.primary(state);
        let structure = (x * x + v * v) * 0.5;
        (0..self.members.len()).fold(structure, |sum, k| {
            let (member, seen) = (&self.members[k], self.seen(state, k));
            match &member.one {
                OneOf::Mass(_) => {
                    let w = seen.w.value;
                    sum + member.pendulum.mass_ratio * 0.5 * ((v + w) * (v + w))
                }
                OneOf::Pendulum(piva) => piva.energy_with(sum, &seen),
            }
        })
    }

    /// The structure takes the impulse with the stuck absorbers whose walls it pushes against them; the others are left
    /// behind.
    fn apply_impulse(&self, state: &Self::State, velocity: R, _stuck: bool) -> Self::State {
        let mut after = *state;
        after.phase = self.host.after_impulse(&state.phase);
        for place in &mut after.places {
            place.stuck &= place.wall.sign() * velocity.double() <= 0.0;
        }
        let together = self.together(&after, |_| false);
        self.jumped(&after, DoubleDouble::new(velocity).over_sum(together), |_| false)
    }
}
