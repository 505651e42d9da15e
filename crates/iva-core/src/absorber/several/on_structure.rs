//! Several masses on their structure: what drives it, impulses and energy.

use super::{Several, SeveralState};
use crate::absorber::{OnStructure, Point};
use crate::host::oscillator::Primary;
use crate::host::{Host, Phase, Sinusoidal};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

impl<R: Real, H: Host<Real = R>, const N: usize> OnStructure for Several<H, N> {
    type Real = R;
    type Excitation = H;
    type State = SeveralState<H, N>;

    fn excitation(&self) -> &H {
        &self.host
    }

    fn phase(state: &Self::State) -> &Phase<H> {
        &state.host.phase
    }

    fn with_drive_of(&self, state: &Self::State, like: &Self::State) -> Self::State {
        let mut driven = *state;
        driven.host.phase = like.host.phase;
        driven.host = self.hosted(&driven, state.host.primary);
        driven
    }

    /// That of all masses together.
    fn mass_ratio(&self) -> R {
        super::total(self.masses())
    }

    fn mass_ratio_of(&self, absorber: usize) -> R {
        self.masses().get(absorber).map_or(R::ZERO, |mass| mass.mass_ratio)
    }

    fn primary(&self, state: &Self::State) -> Point<R> {
        let Primary { x, v } = state.host.primary;
        Point { x: x.value, v: v.value }
    }

    fn energy(&self, state: &Self::State) -> R {
        let Point { x, v } = self.primary(state);
        let structure = (x * x + v * v) * 0.5;
        self.masses().iter().zip(self.gaps(state)).fold(structure, |sum, (mass, gap)| {
            sum + mass.mass_ratio * 0.5 * ((v + gap.w) * (v + gap.w))
        })
    }

    const SINUSOIDAL: bool = N > 0 && R::FAST_PATHS;

    /// A structure alone is measured as it moves.
    fn sinusoidal(&self) -> Option<Sinusoidal> {
        self.host.sinusoidal().filter(|_| N > 0)
    }

    /// The structure takes the impulse with the stuck masses whose walls it pushes against them; the others are left
    /// behind.
    fn apply_impulse(&self, state: &Self::State, velocity: R, _stuck: bool) -> Self::State {
        let mut after = *state;
        after.host.phase = self.host.after_impulse(&state.host.phase);
        for mass in &mut after.masses {
            mass.stuck &= mass.side * velocity <= 0.0;
        }
        let together = self.together(|k| after.masses[k].stuck);
        self.jumped(&after, DoubleDouble::new(velocity).over_sum(together))
    }
}
