//! A torsional spring in the pivot of a pendulum, of moment −k θ.
//!
//! With the arc φ = b θ and σ² = k/(m κL²) the swing obeys, in the notation of [`super`],
//!
//! ```text
//! Ẇ = −(β a c + r² y + σ² φ + ν W)        φ̇ = W
//! ```
//!
//! Each coefficient of φ follows from that of W before it; that of order 0, b θ, from sinθ and cosθ. At small angles
//! φ = y, and σ² adds to r².

use super::Number;
use crate::number::arrays::laned;
use crate::number::real::Real;

/// The spring in the pivot of a pendulum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring<R = f64> {
    /// σ², in ωn².
    pub stiffness: R,
    /// False without spring, and at small angles, where its stiffness is part of r².
    pub acts: bool,
}

laned!(Spring, Springs { stiffness: f64, acts: bool });

/// A bound on |θ| at the begin of a step, a little more than π/2: with a spring the pendulum stays between its stops, below
/// its pivot.
const QUARTER: f64 = 1.58;

impl<R: Real> Spring<R> {
    /// A pivot without spring.
    pub const NONE: Self = Self { stiffness: R::ZERO, acts: false };

    /// A spring with this σ; `small`: at small angles.
    pub fn new(ratio: R, small: bool) -> Self {
        Self { stiffness: ratio * ratio, acts: ratio != 0.0 && !small }
    }

    /// σ² where the spring has a term of its own, else 0.
    #[inline(always)]
    pub fn acting(&self) -> R {
        if self.acts { self.stiffness } else { R::ZERO }
    }

    /// The same spring in other numbers.
    pub fn map<Q>(&self, number: impl Fn(R) -> Q) -> Spring<Q> {
        Spring { stiffness: number(self.stiffness), acts: self.acts }
    }

    /// The arc φ = b θ of a pendulum with this sinθ and cosθ; 0 where the spring has no term of its own.
    #[inline(always)]
    pub fn arc<T: Number<Real = R>>(&self, b: R, sine: T, cosine: T) -> T {
        if self.acts { T::from_real(b) * T::angle(sine, cosine) } else { T::from_real(R::ZERO) }
    }

    /// The coefficient of φ of order k > 0 in powers of t/h, from that of W before it.
    #[inline(always)]
    pub fn wound<T: Number<Real = R>>(h: T, k: usize, before: T) -> T {
        h * T::reciprocal(k) * before
    }

    /// What the series leaves out of the spring's term in the equation of W: σ² φ of the last order.
    #[inline(always)]
    pub fn defect(&self, arc_last: R) -> R {
        self.acting() * arc_last
    }

    /// A bound on the sum of the partial derivatives of σ² φ c, its term in the equation of a, by φ and by b c;
    /// `turned` bounds how far the pendulum turns in the step.
    #[inline(always)]
    pub fn steepness(&self, turned: R) -> R {
        self.acting() * (turned + (1.0 + QUARTER))
    }
}
