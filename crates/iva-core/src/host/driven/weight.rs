//! Gravity along the motion of a structure.
//!
//! On a line of motion that rises by the angle α, gravity pulls every mass back by G = g sin α. Let x be
//! measured from the position of rest with the absorber on its lower stop, and let a_g be the acceleration of
//! the base:
//!
//! ```text
//! ẍ + 2ζ ẋ + x = f/M + μG − a_g,    ẍ₁ = −G − a_g                 in flight,
//! (1 + μ) ẍ + 2ζ ẋ + x = f/M − (1 + μ) a_g                        with the absorber stuck to the structure.
//! ```
//!
//! While the absorber flies, the spring carries less than at rest: the excess μG lifts the structure. A
//! uniform field of gravity is equivalent to an acceleration of the base, so A = ẍ + a_g + G takes the place
//! of ẍ + a_g: the gap obeys ÿ = −A, a stuck absorber presses with A per unit of its mass, and all equations
//! for a moving base hold.

use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;

/// Gravity along the motion, for a structure with its absorber in flight or stuck to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight<R = f64> {
    /// G = g sin α, in ωn² × length.
    pub(crate) gravity: R,
    /// Excess of the spring force over the weight to carry, per mass of the structure: μG in flight, 0 if
    /// stuck.
    pub(crate) lift: DoubleDouble<R>,
}

impl<R: Real> Weight<R> {
    /// No gravity along the motion.
    pub(crate) const NONE: Self = Self { gravity: R::ZERO, lift: DoubleDouble::ZERO };

    /// The weight on a structure whose absorber of mass ratio μ is in flight; `None` for G = 0.
    pub(super) fn new(gravity: R, mass_ratio: R) -> Option<Self> {
        let lift = DoubleDouble::new(gravity).times(mass_ratio);
        (gravity != 0.0).then_some(Self { gravity, lift })
    }

    /// The weight on a structure with the absorber stuck to it.
    pub(super) fn loaded(self) -> Self {
        Self { lift: DoubleDouble::ZERO, ..self }
    }
}
