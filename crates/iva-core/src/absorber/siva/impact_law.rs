//! The impact law of a free mass: momentum is conserved, and restitution multiplies the gap velocity by −e.

use super::{Siva, SivaState, collided};
use crate::absorber::impact::{self, Impact};
use crate::absorber::{Absorber, ImpactLaw, LawAt, Wall};
use crate::host::Host;
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// The impact law at one wall.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Law<R = f64> {
    /// Newton's coefficient e on the gap velocity.
    pub restitution: R,
    /// Share of the gap velocity that the primary gains.
    pub share: DoubleDouble<R>,
    /// The energy lost at an approach speed of 1.
    loss: R,
}

laned!(Law, Laws { restitution: f64, share: DoubleDouble, loss: f64 });

impl<R: Real> Law<R> {
    pub(crate) fn new(mass_ratio: R, restitution: R) -> Self {
        let share = impact::primary_share(mass_ratio, restitution);
        Self { restitution, share, loss: impact::energy_loss(mass_ratio, restitution, R::ONE) }
    }

    /// The energy lost in an impact with this approach speed.
    #[inline(always)]
    pub(crate) fn lost(&self, approach: R) -> R {
        self.loss * (approach * approach)
    }
}

impl<R: Real, H: Host<Real = R>> ImpactLaw for Siva<H> {
    fn law_of(&self, _absorber: usize, wall: Wall, approach: R) -> LawAt<R> {
        self.mass.law_at(wall, approach, self.host.damping_ratio())
    }

    fn impact(&self, state: &Self::State, time: R) -> (Self::State, Impact<R>) {
        let s = state.side;
        let approach = -state.rate.value;
        let law = self.mass.law_for(s, approach);
        let after = collided(self.host.free(), state, true, &law);
        let impact = Impact {
            time,
            absorber: 0,
            wall: self.wall(state),
            displacement: state.host.primary.x.value,
            velocity_before: state.host.primary.v.value,
            velocity_after: after.host.primary.v.value,
            gap_velocity_before: s * approach,
            gap_velocity_after: after.gap_velocity(),
            lever: R::ONE,
            energy_loss: law.lost(approach),
        };
        (after, impact)
    }

    fn stick(&self, state: &Self::State) -> (Self::State, R) {
        let loss = impact::energy_loss(self.mass.mass_ratio, R::ZERO, state.rate.value);
        let primary = state.host.primary.jumped(-state.side, state.rate, self.stick_share);
        let host = self.host.state(state.host.phase, primary);
        let stuck =
            SivaState { host, distance: DoubleDouble::ZERO, rate: DoubleDouble::ZERO, ..*state };
        (stuck, loss)
    }
}
