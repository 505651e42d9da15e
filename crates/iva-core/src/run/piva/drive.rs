//! What drives pendulums in lanes: nothing, or one harmonic force. Their structure is one that could be driven.

use super::scene::Scene;
use crate::absorber::Clock;
use crate::absorber::piva::PivaState;
use crate::force::{Push, Smooth};
use crate::host::Moment;
use crate::number::arrays::Laned;

/// What drives the pendulums of some lanes.
pub(crate) trait Swinging {
    /// True if a force acts.
    const DRIVEN: bool;
    /// What a lane carries of the state of the drive: its instant, from which the force follows.
    type Instant: Laned;
    /// The instant of a state of the drive.
    fn instant(phase: &Moment) -> Self::Instant;
    /// The state of the drive at an instant with this force.
    fn phase(scene: &Scene, instant: Self::Instant, push: &Push) -> Moment;
    /// A later instant.
    fn later(instant: Self::Instant, h: f64) -> Self::Instant;
    /// The force at an instant.
    fn push(scene: &Scene, instant: Self::Instant) -> Push;
    /// The same with the accuracy of plain numbers.
    fn plain_push(scene: &Scene, instant: Self::Instant) -> Push;
}

/// Nothing.
#[derive(Debug)]
pub(crate) struct Still;

/// A harmonic force.
#[derive(Debug)]
pub(crate) struct Pushed;

impl Swinging for Still {
    const DRIVEN: bool = false;
    type Instant = Clock;

    #[inline(always)]
    fn instant(phase: &Moment) -> Clock {
        phase.time
    }

    #[inline(always)]
    fn phase(scene: &Scene, time: Clock, push: &Push) -> Moment {
        Moment { time, kicks: 0, smooth: Smooth::ALL, pushes: scene.pushes(push) }
    }

    #[inline(always)]
    fn later(time: Clock, h: f64) -> Clock {
        time.plus(h)
    }

    #[inline(always)]
    fn push(_scene: &Scene, _time: Clock) -> Push {
        Push::NONE
    }

    #[inline(always)]
    fn plain_push(_scene: &Scene, _time: Clock) -> Push {
        Push::NONE
    }
}

impl Swinging for Pushed {
    const DRIVEN: bool = true;
    type Instant = Clock;

    #[inline(always)]
    fn instant(phase: &Moment) -> Clock {
        phase.time
    }

    #[inline(always)]
    fn phase(scene: &Scene, time: Clock, push: &Push) -> Moment {
        Moment { time, kicks: 0, smooth: Smooth::ALL, pushes: scene.pushes(push) }
    }

    #[inline(always)]
    fn later(time: Clock, h: f64) -> Clock {
        time.plus(h)
    }

    #[inline(always)]
    fn push(scene: &Scene, time: Clock) -> Push {
        scene.harmonic().push(time)
    }

    #[inline(always)]
    fn plain_push(scene: &Scene, time: Clock) -> Push {
        scene.harmonic().plain_push(time)
    }
}

/// The state of a pendulum in a lane.
pub(super) type Laid<H> = PivaState<<H as Swinging>::Instant>;

/// The state of a pendulum, for a lane.
#[inline(always)]
pub(super) fn laid<H: Swinging>(state: &PivaState<Moment>) -> Laid<H> {
    state.with_phase(H::instant(&state.phase))
}

/// The state of a pendulum in a lane, for the event loop.
#[inline(always)]
pub(super) fn raised<H: Swinging>(scene: &Scene, state: &Laid<H>) -> PivaState<Moment> {
    let push = H::push(scene, state.phase);
    state.with_phase(H::phase(scene, state.phase, &push))
}

/// The same for observers, with the force to the accuracy of plain numbers.
#[inline(always)]
pub(super) fn seen<H: Swinging>(scene: &Scene, state: &Laid<H>) -> PivaState<Moment> {
    let push = H::plain_push(scene, state.phase);
    state.with_phase(H::phase(scene, state.phase, &push))
}
