//! Gravity along the motion of a structure.
//!
//! On a line of motion that rises by the angle α, gravity pulls every mass back by G = g sin α. With x measured from where
//! the structure rests with the absorber on its lower stop, and a_g the acceleration of the base,
//!
//! ```text
//! ẍ + 2ζ ẋ + x = f/M + μG − a_g,    ẍ₁ = −G − a_g                 in flight,
//! (1 + μ) ẍ + 2ζ ẋ + x = f/M − (1 + μ) a_g                        with the absorber stuck to the structure:
//! ```
//!
//! while the absorber flies, the spring lifts more than it has to carry. A uniform field of gravity cannot be told from an
//! acceleration of the base, so A = ẍ + a_g + G takes the place of ẍ + a_g: the gap obeys ÿ = −A, a stuck absorber presses
//! with A per unit of its mass, and everything written for a base that moves holds.

use crate::compensated::DoubleDouble;
use crate::real::Real;

/// Gravity along the motion, on a structure by itself or with its absorber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weight<R = f64> {
    /// G = g sin α, in ωn² × length.
    pub(crate) gravity: R,
    /// What the spring lifts more than it has to carry, over the mass of the structure: μG in flight, else 0.
    pub(super) lift: DoubleDouble<R>,
}

impl<R: Real> Weight<R> {
    /// On the structure while an absorber of mass ratio μ flies; `None` for G = 0.
    pub(super) fn new(gravity: R, mass_ratio: R) -> Option<Self> {
        let lift = DoubleDouble::new(gravity).times(mass_ratio);
        (gravity != 0.0).then_some(Self { gravity, lift })
    }

    /// The same with the absorber stuck to it.
    pub(super) fn loaded(self) -> Self {
        Self { lift: DoubleDouble::ZERO, ..self }
    }
}
