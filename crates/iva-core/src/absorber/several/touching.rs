//! Several masses in contact with their walls.

use super::{AT_ONCE_ULPS, InGap, Several, SeveralState};
use crate::absorber::{Wall, impact};
use crate::host::oscillator::Primary;
use crate::host::{Host, HostState, Structure};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

impl<R: Real, H: Host<Real = R>, const N: usize> Several<H, N> {
    /// The state in contact, and how much later it is. Other masses that are about to meet their walls touch them as well.
    #[inline(always)]
    pub(super) fn touching(
        &self,
        state: &SeveralState<H, N>,
        wall: Wall,
    ) -> (SeveralState<H, N>, R) {
        let at_hand = usize::from(state.at_hand);
        let a = state.host.acceleration.value;
        let Some((mass, place)) = self.seen(state) else { return (*state, R::ZERO) };
        let met = place.measured_from(wall, mass);
        let later = impact::delay(met.distance.value, met.rate.value, a);
        let structure = self.structure(&state.masses);
        let HostState { primary: Primary { x, v }, acceleration, phase } = state.host;
        let [base, ..] = structure.base(&phase);
        let gained = a * later;
        let primary = Primary { x: x.plus(v.value * later), v: v.plus(gained - base * later) };
        let host = HostState { primary, acceleration, phase: structure.later(&phase, later) };
        let mut masses = state.masses;
        let all = masses[..self.count].iter_mut().zip(self.masses()).enumerate();
        for (k, (place, mass)) in all.filter(|(_, (place, _))| !place.stuck) {
            if k == at_hand {
                *place = InGap { distance: DoubleDouble::ZERO, ..met.moved(later, gained) };
                continue;
            }
            *place = place.moved(later, gained);
            let within = R::EPSILON * AT_ONCE_ULPS;
            let meets = |seen: &InGap<R>| {
                seen.rate.value < 0.0 && seen.distance.value <= -seen.rate.value * within
            };
            let opposite = if place.side > 0.0 { Wall::Minus } else { Wall::Plus };
            let across = place.measured_from(opposite, mass);
            if let Some(seen) = [*place, across].into_iter().find(meets) {
                *place = InGap { distance: DoubleDouble::ZERO, ..seen };
            }
        }
        (SeveralState { host, masses, at_hand: state.at_hand }, later)
    }
}
