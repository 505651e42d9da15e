//! The flight of a SIVA: free in its gap.

use super::stride::{turn, turning};
use super::{Siva, SivaState};
use crate::compensated::Sum;
use crate::flight::{Curve, GapPoint, Jet, Motion, Turns};
use crate::oscillator::{Oscillator, Primary};
use crate::quintic::root;
use crate::real::{Real, STRIDES, dispatched};
use crate::system::{System, Wall};

/// The absorber free in its gap.
#[derive(Debug, Clone, Copy)]
pub struct SivaFlight<'a> {
    siva: &'a Siva,
    from: SivaState,
}

impl<'a> SivaFlight<'a> {
    #[inline]
    pub(super) fn new(siva: &'a Siva, from: SivaState) -> Self {
        Self { siva, from }
    }
}

/// The state after a flight.
#[inline(always)]
pub(crate) fn arrived(free: &Oscillator, from: &SivaState, h: Real) -> SivaState {
    let (primary, arrival) = from.primary.arrived(free, from.acceleration, h);
    let side = |sum: Sum| Sum { value: from.side * sum.value, rest: from.side * sum.rest };
    SivaState {
        primary,
        acceleration: free.acceleration(&primary),
        side: from.side,
        distance: from.distance.plus_both(from.rate.product(Sum::new(h)), side(arrival.curved)),
        rate: from.rate + side(arrival.velocity),
    }
}

impl Motion for SivaFlight<'_> {
    type State = SivaState;
    const RIDING: bool = false;

    fn origin(&self) -> &SivaState {
        &self.from
    }

    #[inline]
    fn reach(&self) -> Real {
        self.siva.free().reach
    }

    fn state(&self, h: Real) -> SivaState {
        dispatched(
            #[inline(always)]
            || arrived(self.siva.free(), &self.from, h),
        )
    }

    fn primary(&self, h: Real) -> Jet {
        let Primary { x, v } = self.from.primary;
        let (free, a) = (self.siva.free(), self.from.acceleration);
        dispatched(
            #[inline(always)]
            || free.jet(x.value, v.value, a.value, h),
        )
    }

    fn gap(&self, h: Real) -> GapPoint {
        let state = self.state(h);
        let d = self.siva.clearance;
        // Certified to stay in the gap; seen from the far wall rounding could say otherwise.
        let y = state.side * (d - state.distance.value);
        GapPoint { y: y.clamp(-d, d), w: state.gap_velocity() }
    }

    fn wall(&self) -> Option<Wall> {
        None
    }

    fn viscous_loss(&self, h: Real) -> Real {
        let Primary { x, v } = self.from.primary;
        let free = self.siva.free();
        dispatched(
            #[inline(always)]
            || free.viscous_loss(x.value, v.value, h),
        )
    }

    fn turns(&self, length: Real, end: &SivaState) -> Turns {
        if !STRIDES || self.from.primary.v.value * end.primary.v.value >= 0.0 {
            return Turns::Unknown;
        }
        let (h, x, exact) = dispatched(
            #[inline(always)]
            || {
                let free = self.siva.free();
                let guess = length * root(&turn(free, &self.from, end, length));
                turning(free, &self.from, guess, length)
            },
        );
        if exact { Turns::Once(h, x) } else { Turns::Unknown }
    }
}

impl Curve for SivaFlight<'_> {
    type Sample = SivaState;

    #[inline]
    fn sample(&self, h: Real) -> SivaState {
        self.state(h)
    }

    #[inline]
    fn jet(&self, sample: &SivaState) -> Jet {
        self.siva.distance(sample)
    }

    fn precise(&self, h: Real) -> Sum {
        let SivaState { primary, side: s, distance, rate, .. } = self.from;
        let travelled = rate.times(h);
        let curved = self.siva.free().precise(primary.v, self.from.acceleration, h);
        distance
            .plus_parts(travelled.value, travelled.rest)
            .plus_parts(s * curved.value, s * curved.rest)
    }

    /// D⁗ = s x⁗, bounded by Λ³ρ.
    #[inline]
    fn fourth(&self) -> Real {
        let free = self.siva.free();
        let Primary { x, v } = self.from.primary;
        free.growth * free.growth * free.growth * free.radius(x.value, v.value)
    }

    #[inline]
    fn magnitude(&self) -> Real {
        self.siva.clearance
    }
}
