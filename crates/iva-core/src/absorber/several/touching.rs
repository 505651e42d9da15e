//! Several masses in contact with their walls.

use super::{AT_ONCE_ULPS, InGap, Several, SeveralState};
use crate::absorber::{Wall, impact};
use crate::host::oscillator::Primary;
use crate::host::{Host, HostState, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// The structure a short time later, at the rates that it has.
#[inline(always)]
pub(crate) fn soon<R: Real, S: Structure<Real = R>>(
    structure: &S,
    state: &HostState<S::Phase, R>,
    later: R,
) -> HostState<S::Phase, R> {
    let HostState { primary: Primary { x, v }, acceleration, phase } = *state;
    let [base, ..] = structure.base(&phase);
    let gained = acceleration.value * later;
    let primary = Primary { x: x.plus(v.value * later), v: v.plus(gained - base * later) };
    HostState { primary, acceleration, phase: structure.later(&phase, later) }
}

impl<R: Real> InGap<R> {
    /// How much later the mass touches its wall: the time in which it covers what rounding has left of the distance.
    #[inline(always)]
    pub(crate) fn delay(&self, structure: &HostState<impl Copy, R>) -> R {
        impact::delay(self.distance.value, self.rate.value, structure.acceleration.value)
    }

    /// The place at its wall.
    #[inline(always)]
    pub(crate) fn at_wall(&self) -> Self {
        Self { distance: DoubleDouble::ZERO, ..*self }
    }

    /// True if the mass meets its wall at once, as an event.
    #[inline(always)]
    pub(crate) fn meets_at_once(&self) -> bool {
        let within = R::EPSILON * AT_ONCE_ULPS;
        (self.rate.value < 0.0) & (self.distance.value <= -self.rate.value * within)
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> Several<H, N> {
    /// The state in contact, and how much later it is. Other masses that are about to meet their walls touch them as well.
    #[inline(always)]
    pub(super) fn touching(
        &self,
        state: &SeveralState<H, N>,
        wall: Wall,
    ) -> (SeveralState<H, N>, R) {
        let at_hand = usize::from(state.at_hand);
        let Some((mass, place)) = self.seen(state) else { return (*state, R::ZERO) };
        let met = place.measured_from(wall, mass);
        let later = met.delay(&state.host);
        let gained = state.host.acceleration.value * later;
        let host = soon(self.structure(&state.masses), &state.host, later);
        let mut masses = state.masses;
        let all = masses[..self.count].iter_mut().zip(self.masses()).enumerate();
        for (k, (place, mass)) in all.filter(|(_, (place, _))| !place.stuck) {
            if k == at_hand {
                *place = met.moved(later, gained).at_wall();
                continue;
            }
            *place = place.moved(later, gained);
            let seen = [*place, place.across(mass.clearance)];
            if let Some(seen) = seen.iter().find(|seen| seen.meets_at_once()) {
                *place = seen.at_wall();
            }
        }
        (SeveralState { host, masses, at_hand: state.at_hand }, later)
    }
}
