//! A pendulum on its structure: what drives it, impulses and energy.

use super::{Parameters, Piva, PivaState};
use crate::absorber::{OnStructure, Point};
use crate::host::{Host, Phase};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{Pendulum, Spring};

impl<R: Real, H: Host<Real = R>> OnStructure for Piva<H> {
    type Real = R;
    type Excitation = H;
    type State = PivaState<Phase<H>, R>;

    fn excitation(&self) -> &H {
        &self.host
    }

    fn phase(state: &Self::State) -> &Phase<H> {
        &state.phase
    }

    fn mass_ratio(&self) -> R {
        self.parameters.mass_ratio
    }

    fn with_drive_of(&self, state: &Self::State, like: &Self::State) -> Self::State {
        PivaState { phase: like.phase, ..*state }
    }

    fn primary(&self, state: &Self::State) -> Point<R> {
        Point { x: state.primary.x.value, v: state.primary.v.value }
    }

    fn energy(&self, state: &Self::State) -> R {
        let Point { x, v } = self.primary(state);
        self.energy_with((x * x + v * v) * 0.5, state)
    }

    fn apply_impulse(&self, state: &Self::State, velocity: R, stuck: bool) -> Self::State {
        let Pendulum { mass_ratio, coupling, .. } = self.pendulum;
        let mass = DoubleDouble::new(R::ONE).plus(mass_ratio);
        let phase = self.host.after_impulse(&state.phase);
        if stuck {
            let gained = DoubleDouble::new(velocity).over_sum(mass);
            let primary = state.primary.faster_by(gained);
            return PivaState { phase, primary, released: false, ..*state };
        }
        let gained = DoubleDouble::new(velocity).over_sum(self.pendulum.inertia(state.y()));
        let swing = gained.times(-coupling).times_sum(state.cosine);
        PivaState {
            phase,
            primary: state.primary.faster_by(gained),
            w: state.w + swing,
            released: false,
            ..*state
        }
    }
}

impl<R: Real, H: Host<Real = R>> Piva<H> {
    /// An energy and that of the pendulum in a state.
    pub(crate) fn energy_with<P>(&self, moving: R, state: &PivaState<P, R>) -> R {
        let v = state.primary.v.value;
        let Parameters { mass_ratio, inertia_ratio, length, .. } = self.parameters;
        let Pendulum { lever, contact_distance, .. } = self.pendulum;
        let (y, w, c) = (state.y().value, state.w.value, state.cosine.value);
        let sine = y / contact_distance;
        // 1 − cosθ without cancellation (θ²/2 at small angles).
        let rise = if c > 0.0 { sine * sine / (R::ONE + c) } else { R::ONE - c };
        let kinetic = v * v + v * 2.0 * lever * (c * w) + inertia_ratio * (lever * w) * (lever * w);
        let whole = moving + mass_ratio * (kinetic * 0.5 + self.gravity() * length * rise);
        let Spring { stiffness, .. } = self.pendulum.spring;
        if stiffness == 0.0 {
            return whole;
        }
        let turned = self.angle_of(state) * length;
        whole + mass_ratio * inertia_ratio * 0.5 * (stiffness * (turned * turned))
    }
}
