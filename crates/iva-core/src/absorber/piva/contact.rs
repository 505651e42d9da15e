//! Contact of a pendulum with a wall, and the impact there, without branches: for event loop and lanes.

use super::impact_law::Law;
use super::{PivaState, Stops};
use crate::absorber::Wall;
use crate::absorber::impact::{Impact, delay};
use crate::host::oscillator::Primary;
use crate::number::compensated::DoubleDouble;
use crate::number::real::{Real, pick};
use crate::segment::flight::Jet;
use crate::segment::taylor::Series;

impl<R: Real> Stops<R> {
    /// Moves a state that is at a wall up to rounding exactly onto it; returns the state and how much later it is.
    /// Its drive is left as it was. `ahead`: the first coefficients of the flight from the state.
    #[inline(always)]
    pub fn touching<P: Copy>(
        &self,
        state: &PivaState<P, R>,
        wall: Wall,
        ahead: &Series<R, 3>,
    ) -> (PivaState<P, R>, R) {
        let Series { u, w, y, c, .. } = ahead;
        let left = state.distance_to(wall);
        let flat = delay(left, state.gap_velocity() * -wall.sign(), y[2] * 2.0);
        let steep = delay((state.cosine - self.cosine).value, c[1], c[2] * 2.0);
        let later = pick(self.steep, steep, flat);
        let Primary { x, v } = state.primary;
        let touching = PivaState {
            primary: Primary { x: x.plus(v.value * later), v: v.plus(u[1] * later) },
            w: state.w.plus(w[1] * later),
            wall,
            distance: DoubleDouble::ZERO,
            cosine: self.cosine,
            ..*state
        };
        (touching, later)
    }
}

impl<R: Real> Law<R> {
    /// The state after the impact of a state in contact, and its record.
    #[inline(always)]
    pub fn struck<P: Copy>(
        &self,
        state: &PivaState<P, R>,
        time: R,
        lever: R,
    ) -> (PivaState<P, R>, Impact<R>) {
        let v = state.primary.v;
        let (gained, w) = (self.impact(state.w), state.w.times_sum(-self.rebound));
        let primary = Primary { v: v.plus_parts(gained.value, gained.rest), ..state.primary };
        let after = PivaState { primary, w, released: false, ..*state };
        let impact = Impact {
            time,
            absorber: 0,
            wall: state.wall,
            displacement: state.primary.x.value,
            velocity_before: v.value,
            velocity_after: primary.v.value,
            gap_velocity_before: state.gap_velocity(),
            gap_velocity_after: after.gap_velocity(),
            lever,
            energy_loss: self.impact_loss(v.value, state.w.value),
        };
        (after, impact)
    }
}

/// The distance to the wall last touched and its derivatives, from the first coefficients of a flight.
#[inline(always)]
pub(crate) fn distance<R: Real, P>(state: &PivaState<P, R>, ahead: &Series<R, 4>) -> Jet<R> {
    let s = state.wall.sign();
    Jet {
        value: state.distance.value,
        rate: ahead.y[1] * -s,
        curvature: ahead.y[2] * (-s * 2.0),
        jerk: ahead.y[3] * (-s * 6.0),
    }
}
