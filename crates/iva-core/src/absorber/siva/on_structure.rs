//! A free mass on its structure: what drives it, impulses and energy.

use super::{Siva, SivaState};
use crate::absorber::{OnStructure, Point};
use crate::host::oscillator::Primary;
use crate::host::{Host, Phase, Sinusoidal};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

impl<R: Real, H: Host<Real = R>> OnStructure for Siva<H> {
    type Real = R;
    type Excitation = H;
    type State = SivaState<Phase<H>, R>;

    fn excitation(&self) -> &H {
        &self.host
    }

    fn phase(state: &Self::State) -> &Phase<H> {
        &state.host.phase
    }

    fn mass_ratio(&self) -> R {
        self.mass.mass_ratio
    }

    fn with_drive_of(&self, state: &Self::State, like: &Self::State) -> Self::State {
        let host = self.host.state(like.host.phase, state.host.primary);
        SivaState { host, ..*state }
    }

    fn primary(&self, state: &Self::State) -> Point<R> {
        let Primary { x, v } = state.host.primary;
        Point { x: x.value, v: v.value }
    }

    const SINUSOIDAL: bool = R::FAST_PATHS;

    fn sinusoidal(&self) -> Option<Sinusoidal> {
        self.host.sinusoidal()
    }

    fn apply_impulse(&self, state: &Self::State, velocity: R, stuck: bool) -> Self::State {
        let phase = self.host.after_impulse(&state.host.phase);
        let Primary { x, v } = state.host.primary;
        let mass = DoubleDouble::new(R::ONE).plus(self.mass.mass_ratio);
        let gained = if stuck {
            DoubleDouble::new(velocity).over_sum(mass)
        } else {
            DoubleDouble::new(velocity)
        };
        let host = self.host.state(phase, Primary { x, v: v + gained });
        let rate = if stuck { state.rate } else { state.rate.plus(state.side * velocity) };
        SivaState { host, rate, ..*state }
    }

    fn energy(&self, state: &Self::State) -> R {
        let Point { x, v } = self.primary(state);
        let absorber = v + state.gap_velocity();
        let moving = (x * x + v * v) * 0.5 + self.mass.mass_ratio * 0.5 * (absorber * absorber);
        let gravity = self.host.gravity();
        if gravity == 0.0 {
            return moving;
        }
        moving + self.mass.mass_ratio * gravity * self.height(state)
    }
}
