//! What drives pendulums in lanes: nothing, or one harmonic force.

use super::scene::Scene;
use crate::absorber::piva::PivaState;
use crate::absorber::system::Clock;
use crate::force::{Pushes, Smooth};
use crate::host::{DrivenHost, Host, Moment, Phase, UndrivenHost};
use crate::number::arrays::Laned;

/// A host whose pendulums go in lanes.
pub(crate) trait Swinging: Host<Real = f64> {
    /// True if a force acts.
    const DRIVEN: bool;
    /// What a lane carries of the state of the drive: its instant, from which the force follows.
    type Instant: Laned;
    /// The instant of a state of the drive.
    fn instant(phase: &Phase<Self>) -> Self::Instant;
    /// The state of the drive at an instant.
    fn phase(scene: &Scene, instant: Self::Instant) -> Phase<Self>;
    /// A later instant.
    fn later(instant: Self::Instant, h: f64) -> Self::Instant;
    /// The force at an instant.
    fn pushes(scene: &Scene, instant: Self::Instant) -> Pushes;
}

impl Swinging for UndrivenHost {
    const DRIVEN: bool = false;
    type Instant = ();

    #[inline(always)]
    fn instant(_phase: &()) {}

    #[inline(always)]
    fn phase(_scene: &Scene, _instant: ()) {}

    #[inline(always)]
    fn later(_instant: (), _h: f64) {}

    #[inline(always)]
    fn pushes(_scene: &Scene, _instant: ()) -> Pushes {
        Pushes::NONE
    }
}

impl Swinging for DrivenHost {
    const DRIVEN: bool = true;
    type Instant = Clock;

    #[inline(always)]
    fn instant(phase: &Moment) -> Clock {
        phase.time
    }

    #[inline(always)]
    fn phase(scene: &Scene, time: Clock) -> Moment {
        Moment { time, kicks: 0, smooth: Smooth::ALL, pushes: scene.pushes(time) }
    }

    #[inline(always)]
    fn later(time: Clock, h: f64) -> Clock {
        time.plus(h)
    }

    #[inline(always)]
    fn pushes(scene: &Scene, time: Clock) -> Pushes {
        scene.pushes(time)
    }
}

/// The state of a pendulum in a lane.
pub(super) type Laid<H> = PivaState<<H as Swinging>::Instant>;

/// The state of a pendulum, for a lane.
#[inline(always)]
pub(super) fn laid<H: Swinging>(state: &PivaState<Phase<H>>) -> Laid<H> {
    state.with_phase(H::instant(&state.phase))
}

/// The state of a pendulum in a lane, for the event loop.
#[inline(always)]
pub(super) fn raised<H: Swinging>(scene: &Scene, state: &Laid<H>) -> PivaState<Phase<H>> {
    state.with_phase(H::phase(scene, state.phase))
}
