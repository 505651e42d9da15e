//! Several masses on a structure with modes: what drives it, impulses and energy.

use super::{Modal, ModalState};
use crate::absorber::{OnStructure, Point};
use crate::host::{Host, Phase, Sinusoidal};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

impl<R: Real, H: Host<Real = R>, const N: usize, const M: usize> OnStructure for Modal<H, N, M> {
    type Real = R;
    type Excitation = H;
    type State = ModalState<H, N, M>;

    fn excitation(&self) -> &H {
        &self.host
    }

    fn phase(state: &Self::State) -> &Phase<H> {
        &state.phase
    }

    fn with_drive_of(&self, state: &Self::State, like: &Self::State) -> Self::State {
        ModalState { phase: like.phase, ..*state }.renewed()
    }

    /// That of all masses together.
    fn mass_ratio(&self) -> R {
        self.total()
    }

    fn mass_ratio_of(&self, absorber: usize) -> R {
        self.masses[self.index(absorber)].mass_ratio
    }

    fn has_points(&self) -> bool {
        true
    }

    /// Displacement and velocity of the point that the run sees.
    fn primary(&self, state: &Self::State) -> Point<R> {
        let [x, v] = state.modes.of_point(self.whole.shape(self.seen));
        Point { x: x.value, v: v.value }
    }

    /// Those of the structure itself, without the coordinates of masses that are tied to it.
    fn modes_of(&self, state: &Self::State) -> Vec<Point<R>> {
        let each = state.modes.places.iter().zip(&state.modes.velocities);
        let own = each.take(self.own_modes());
        own.map(|(q, rate)| Point { x: q.value, v: rate.value }).collect()
    }

    /// That of all modes, masses and springs; a weight has none on its lower stop.
    fn energy(&self, state: &Self::State) -> R {
        let mut sum = R::ZERO;
        for (j, stiffness) in self.whole.stiffness.iter().enumerate() {
            let (q, v) = (state.modes.places[j].value, state.modes.velocities[j].value);
            sum += (stiffness.value * (q * q) + v * v) * 0.5;
        }
        for (k, (mass, gap)) in self.masses().iter().zip(self.each_gap(state)).enumerate() {
            if self.weights[k] != 0.0 {
                let height = mass.clearance + (gap.y - mass.offset);
                sum += mass.mass_ratio * self.weights[k] * height;
            }
            if let Some(tied) = &self.tied[k] {
                // It moves as a coordinate does.
                sum += tied.tie.stored(gap.y);
                continue;
            }
            let [_, v] = state.modes.of_point(self.shape(k));
            if let Some(is) = self.hanging(k) {
                sum += self.energy_of_pendulum(k, is, &state.places[k], v.value);
                continue;
            }
            let speed = v.value + gap.w;
            sum += mass.mass_ratio * 0.5 * (speed * speed);
        }
        sum
    }

    const SINUSOIDAL: bool = R::FAST_PATHS;

    /// A structure alone is measured as it moves.
    fn sinusoidal(&self) -> Option<Sinusoidal> {
        let logged = self.oscillates() && self.count() > 0 && self.goes_by_steps();
        self.host.sinusoidal().filter(|_| logged)
    }

    /// The structure takes the impulse with the stuck masses that their walls push; the others are left behind.
    fn apply_impulse(&self, state: &Self::State, velocity: R, _stuck: bool) -> Self::State {
        let phase = self.host.after_impulse(&state.phase);
        let kicked = ModalState { phase, ..*state };
        let mut after = self.blown(&kicked, DoubleDouble::new(velocity));
        self.settle(&mut after);
        if self.count() > 1 {
            return after;
        }
        // The event loop asks for one mass only whether it presses on its wall still.
        let mut free = after.renewed();
        free.places[0].stuck = false;
        free.places[0] = self.directed(0, &free.places[0]);
        if after.places[0].stuck && self.pressure(&free, 0) <= 0.0 { free } else { after }
    }
}
