//! The absorber stuck on a wall: one mass 1 + μ on the primary's spring and damper, in closed form,
//! until the pressure on the wall changes sign.

use super::{Siva, SivaState};
use crate::compensated::Sum;
use crate::flight::{Curve, GapPoint, Jet, Motion};
use crate::oscillator::{Oscillator, Primary};
use crate::real::{Real, ZERO, dispatched};
use crate::system::Wall;

/// The ride from one state.
#[derive(Debug, Clone, Copy)]
pub struct SivaRide<'a> {
    loaded: &'a Oscillator,
    from: SivaState,
    acceleration: Sum,
    clearance: Real,
}

impl<'a> SivaRide<'a> {
    pub(super) fn new(siva: &'a Siva, from: SivaState) -> Self {
        let loaded = siva.loaded();
        let acceleration = loaded.acceleration(&from.primary);
        Self { loaded, from, acceleration, clearance: siva.clearance }
    }
}

impl Motion for SivaRide<'_> {
    type State = SivaState;
    const RIDING: bool = true;

    fn origin(&self) -> &SivaState {
        &self.from
    }

    fn reach(&self) -> Real {
        self.loaded.reach
    }

    fn state(&self, h: Real) -> SivaState {
        let primary = dispatched(
            #[inline(always)]
            || self.from.primary.arrived(self.loaded, self.acceleration, h).0,
        );
        SivaState { primary, ..self.from }
    }

    fn primary(&self, h: Real) -> Jet {
        let Primary { x, v } = self.from.primary;
        dispatched(
            #[inline(always)]
            || self.loaded.jet(x.value, v.value, self.acceleration.value, h),
        )
    }

    fn gap(&self, _h: Real) -> GapPoint {
        GapPoint { y: self.from.side * self.clearance, w: ZERO }
    }

    fn wall(&self) -> Option<Wall> {
        Some(if self.from.side > 0.0 { Wall::Plus } else { Wall::Minus })
    }

    fn viscous_loss(&self, h: Real) -> Real {
        let Primary { x, v } = &self.from.primary;
        dispatched(
            #[inline(always)]
            || self.loaded.viscous_loss(x.value, v.value, h),
        )
    }
}

impl Curve for SivaRide<'_> {
    type Sample = SivaState;

    fn sample(&self, h: Real) -> SivaState {
        self.state(h)
    }

    /// The pressure on the wall; the ride ends where it changes sign.
    fn jet(&self, sample: &SivaState) -> Jet {
        let factor = -sample.side;
        let Primary { x, v } = &sample.primary;
        let second = self.loaded.next_derivative(x.value, v.value);
        let third = self.loaded.next_derivative(v.value, second);
        let fourth = self.loaded.next_derivative(second, third);
        let fifth = self.loaded.next_derivative(third, fourth);
        Jet {
            value: factor * second,
            rate: factor * third,
            curvature: factor * fourth,
            jerk: factor * fifth,
        }
    }

    /// The magnitude is that of the terms: plain evaluation is precise enough.
    fn precise(&self, h: Real) -> Sum {
        Sum::new(self.jet(&self.state(h)).value)
    }

    /// The fourth derivative of ẍ is x⁽⁶⁾, bounded by Λ⁵ρ.
    fn fourth(&self) -> Real {
        let Primary { x, v } = &self.from.primary;
        let radius = self.loaded.radius(x.value, v.value);
        self.loaded.growth.powi(5) * radius
    }

    /// ẍ is bounded by Λρ.
    fn magnitude(&self) -> Real {
        let Primary { x, v } = &self.from.primary;
        let radius = self.loaded.radius(x.value, v.value);
        self.loaded.growth * radius
    }
}
