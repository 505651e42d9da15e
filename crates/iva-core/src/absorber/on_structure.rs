//! What a run sees of the structure that an absorber is on.

use crate::host::{Excitation, Sinusoidal};
use crate::number::real::Real;
use crate::segment::place::Point;

/// A structure with what is on it, as a run sees the structure: its motion, what drives it, and its energy.
pub trait OnStructure {
    /// The number type of the motion.
    type Real: Real;
    /// What drives the structure.
    type Excitation: Excitation<Real = Self::Real>;
    /// The state of the structure and of what is on it, between events.
    type State: Copy + std::fmt::Debug;

    /// What drives the structure.
    fn excitation(&self) -> &Self::Excitation;
    /// The state of the drive in a state.
    fn phase(state: &Self::State) -> &<Self::Excitation as Excitation>::Phase;
    /// The same places and velocities with the drive of another state.
    fn with_drive_of(&self, state: &Self::State, _like: &Self::State) -> Self::State {
        *state
    }
    /// Mass ratio μ; 0 without absorber.
    fn mass_ratio(&self) -> Self::Real;
    /// That of the absorber of this index, where there are several.
    fn mass_ratio_of(&self, _absorber: usize) -> Self::Real {
        self.mass_ratio()
    }
    /// True if the structure has several points, so that a run sees it at one and absorbers meet it at others.
    fn has_points(&self) -> bool {
        false
    }
    /// Displacement and velocity of the primary.
    fn primary(&self, state: &Self::State) -> Point<Self::Real>;
    /// q and q̇ of each mode of a structure with points, in the order of its modes.
    fn modes_of(&self, _state: &Self::State) -> Vec<Point<Self::Real>> {
        Vec::new()
    }
    /// Total energy per primary mass.
    fn energy(&self, state: &Self::State) -> Self::Real;
    /// The state after the impulse that is due, of P/M = `velocity`, with the absorber free or stuck to its
    /// wall.
    fn apply_impulse(
        &self,
        state: &Self::State,
        _velocity: Self::Real,
        _stuck: bool,
    ) -> Self::State {
        *state
    }
    /// False if [`OnStructure::sinusoidal`] is never there, so that nothing for it is compiled.
    const SINUSOIDAL: bool = false;
    /// The structure of a free mass in doubles, if its motion between events is a damped sinusoid in closed form
    /// (`host/sinusoid.rs`). The measures of its decays are computed from a log.
    fn sinusoidal(&self) -> Option<Sinusoidal> {
        None
    }
}
