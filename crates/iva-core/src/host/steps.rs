//! The motion of a structure without drive over a whole number of steps of one length, by matrices that are computed
//! once.

use crate::host::oscillator::{Oscillator, Primary};
use crate::number::compensated::{DoubleDouble, two_product};
use crate::number::real::Real;

/// Largest number of steps at once: all bits of an index.
pub(crate) const MOST: usize = 31;
/// Length of a step in units of the longest flight of the structure.
const STEP: f64 = 0.4;

/// The steps of a structure of mass 1 without drive that is not overdamped.
#[derive(Debug, Clone, PartialEq)]
pub struct Steps<R = f64> {
    /// Length of a step.
    length: R,
    /// The reciprocal of the length; δ = ζ; 1/ω.
    pub(crate) over_length: f64,
    decay: f64,
    over_omega: f64,
    damping: R,
    /// The responses after 0, 1, … steps.
    by: [Responses<R>; MOST + 1],
}

/// The responses C to unit displacement and S to unit velocity, and Ṡ.
pub(crate) type Responses<R = f64> = [DoubleDouble<R>; 3];

impl<R: Real> Steps<R> {
    /// The steps of a structure.
    pub fn new(oscillator: &Oscillator<R>) -> Self {
        let (one, length) = (DoubleDouble::new(R::ONE), oscillator.reach * STEP);
        let damping = oscillator.equation.damping;
        let slope = |[c, s]: [DoubleDouble<R>; 2]| [c, s, c - s.times(damping)];
        let pushed = oscillator.precise(one, DoubleDouble::new(-damping), length);
        let first = [
            one + oscillator.precise(DoubleDouble::ZERO, -one, length),
            DoubleDouble::new(length) + pushed,
        ];
        let mut by = [slope([one, DoubleDouble::ZERO]); MOST + 1];
        for k in 1..=MOST {
            let [c, s, rate] = by[k - 1];
            by[k] = slope([first[0] * c - first[1] * s, first[0] * s + first[1] * rate]);
        }
        let decay = 0.5 * damping.double();
        let over_omega = 1.0 / (1.0 - decay * decay).sqrt();
        Self { length, over_length: 1.0 / length.double(), decay, damping, over_omega, by }
    }

    /// (v + δx)/ω of a state: with x it makes the radius |Z| of the motion, which |x| never exceeds
    /// ([`crate::host::sinusoid`]).
    #[inline(always)]
    pub(crate) fn turned(&self, x: f64, v: f64) -> f64 {
        self.decay.mul_add(x, v) * self.over_omega
    }

    /// The responses after a number of steps.
    #[inline(always)]
    pub(crate) fn responses(&self, steps: usize) -> Responses<R> {
        self.by[steps & MOST]
    }

    /// The time that a number of steps takes, high and low part.
    #[inline(always)]
    pub(crate) fn time(&self, steps: f64) -> DoubleDouble<R> {
        let (value, rest) = two_product(self.length, R::from(steps));
        DoubleDouble { value, rest }
    }

    /// x and ẋ after steps with these responses, and ẍ there.
    #[inline(always)]
    pub(crate) fn after(
        &self,
        from: &Primary<R>,
        [c, s, rate]: Responses<R>,
    ) -> (Primary<R>, DoubleDouble<R>) {
        let Primary { x, v } = *from;
        let to = Primary { x: c.product(x) + s.product(v), v: rate.product(v) - s.product(x) };
        (to, -(to.x + to.v.product(DoubleDouble::new(self.damping))))
    }
}
