//! The state of a free mass and its structure, and what an impact makes of it.

use super::Law;
use crate::absorber::impact::Impact;
use crate::absorber::plain::State;
use crate::host::oscillator::Primary;
use crate::host::{HostState, Structure};
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::{Real, pick};
use crate::segment::flight::GapPoint;

/// The state of structure and gap between events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SivaState<P = (), R = f64> {
    pub(crate) host: HostState<P, R>,
    /// Sign of the wall that distances are measured from: +1 for y = +d, −1 for y = −d.
    pub(crate) side: R,
    pub(crate) distance: DoubleDouble<R>,
    pub(crate) rate: DoubleDouble<R>,
}

laned!(SivaState<P>, SivaStates {
    host: HostState<P>,
    side: f64,
    distance: DoubleDouble,
    rate: DoubleDouble,
});

impl<R: Real, P> SivaState<P, R> {
    /// Gap displacement from the middle of a gap of one-sided clearance d, and gap velocity.
    #[inline(always)]
    pub(crate) fn gap(&self, clearance: R) -> GapPoint<R> {
        let d = clearance;
        // The flight is proved to stay in the gap; rounding errors could exceed the far wall.
        let y = self.side * (d - self.distance.value);
        GapPoint { y: y.clamp(-d, d), w: self.gap_velocity() }
    }

    /// The state in plain doubles, without its force.
    #[inline(always)]
    pub(crate) fn in_doubles(&self) -> State {
        let Primary { x, v } = &self.host.primary;
        State {
            x: x.value.double(),
            v: v.value.double(),
            distance: self.distance.value.double(),
            rate: self.rate.value.double(),
            side: self.side.double(),
            ..State::default()
        }
    }

    /// Gap velocity w = −s Ḋ.
    #[inline(always)]
    pub(crate) fn gap_velocity(&self) -> R {
        -self.side * self.rate.value
    }
}

impl<P: Copy> SivaState<P> {
    /// The state just before the impact that it follows, as exactly as a row of the table tells it.
    #[inline(always)]
    pub(crate) fn before(&self, impact: &Impact) -> Self {
        let Primary { x, .. } = self.host.primary;
        let primary = Primary { x, v: DoubleDouble::new(impact.velocity_before) };
        let rate = DoubleDouble::new(-self.side * impact.gap_velocity_before);
        Self { host: HostState { primary, ..self.host }, rate, ..*self }
    }
}

/// The state after an impact; with A computed anew only, if there is none.
#[inline(always)]
pub(crate) fn collided<R: Real, S: Structure<Real = R>>(
    free: &S,
    state: &SivaState<S::Phase, R>,
    hit: bool,
    law: &Law<R>,
) -> SivaState<S::Phase, R> {
    let DoubleDouble { value, rest } = state.rate;
    let closing = DoubleDouble { value: pick(hit, value, R::ZERO), rest: pick(hit, rest, R::ZERO) };
    let primary = state.host.primary.jumped(-state.side, closing, law.share);
    let acceleration = free.acceleration(&state.host.phase, &primary);
    let rebound = closing.product(DoubleDouble::new(-law.restitution));
    let rate = DoubleDouble {
        value: pick(hit, rebound.value, value),
        rest: pick(hit, rebound.rest, rest),
    };
    SivaState { host: HostState { primary, acceleration, ..state.host }, rate, ..*state }
}
