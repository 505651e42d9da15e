//! Double-doubles: numbers held as the unevaluated sum of a high and a low part.

use crate::number::arrays::laned;
use crate::number::real::Real;

/// A double-double: a number held as its rounded value and the rounding error of that value (T. J. Dekker,
/// Numer. Math. 18, 1971; the addition is D. Knuth's two-sum).
///
/// A sum of many small increments keeps full accuracy; only the rounding of the increments themselves
/// remains.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DoubleDouble<R = f64> {
    /// High part: the number rounded to double precision.
    pub value: R,
    /// Low part: the number minus `value`; at most half a unit in the last place of `value`.
    pub rest: R,
}

laned!(DoubleDouble, DoubleDoubles { value: f64, rest: f64 });

impl<R: Real> DoubleDouble<R> {
    /// Zero.
    pub const ZERO: DoubleDouble<R> = DoubleDouble { value: R::ZERO, rest: R::ZERO };

    /// A plain number as a double-double, with low part 0.
    pub const fn new(value: R) -> Self {
        Self { value, rest: R::ZERO }
    }

    /// The sum with a plain number.
    #[inline(always)]
    pub fn plus(self, increment: impl Into<R>) -> Self {
        self.plus_parts(increment.into(), R::ZERO)
    }

    /// The sum with a number given by its high and low part.
    #[inline(always)]
    pub fn plus_parts(self, increment: R, rest: R) -> Self {
        R::sum_with_parts(self, increment, rest)
    }

    /// [`Self::plus_parts`] here, not in a call.
    #[inline(always)]
    pub(crate) fn plus_parts_inline(self, increment: R, rest: R) -> Self {
        let (sum, lost) = two_sum(self.value, increment);
        let rest = lost + (self.rest + rest);
        // `rest` is small against `sum`, so this renormalisation is exact.
        let value = sum + rest;
        Self { value, rest: rest - (value - sum) }
    }

    /// The product with a plain number.
    #[inline(always)]
    pub fn times(self, factor: impl Into<R>) -> Self {
        let factor = factor.into();
        let (product, lost) = two_product(self.value, factor);
        Self { value: product, rest: R::ZERO }.plus_parts(R::ZERO, lost + self.rest * factor)
    }

    /// The product with another double-double.
    #[inline(always)]
    pub fn times_sum(self, factor: DoubleDouble<R>) -> Self {
        self.times(factor.value).plus_parts(R::ZERO, self.value * factor.rest)
    }

    /// The product with another double-double by the shortest formula, not renormalised: the low part may be
    /// some units in the last place of the high part.
    #[inline(always)]
    pub(crate) fn product(self, factor: DoubleDouble<R>) -> Self {
        R::product_of_parts(self, factor)
    }

    /// [`Self::product`] here, not in a call.
    #[inline(always)]
    pub(crate) fn product_inline(self, factor: DoubleDouble<R>) -> Self {
        let (value, lost) = two_product(self.value, factor.value);
        Self { value, rest: lost + (self.value * factor.rest + self.rest * factor.value) }
    }

    /// The sum with two other double-doubles.
    #[inline(always)]
    pub(crate) fn plus_both(self, a: DoubleDouble<R>, b: DoubleDouble<R>) -> Self {
        let (increment, lost) = two_sum(a.value, b.value);
        self.plus_parts(increment, lost + (a.rest + b.rest))
    }

    /// The quotient by a plain number.
    #[inline(always)]
    pub fn over(self, divisor: impl Into<R>) -> Self {
        self.over_sum(DoubleDouble::new(divisor.into()))
    }

    /// The quotient by another double-double.
    #[inline(always)]
    pub fn over_sum(self, divisor: DoubleDouble<R>) -> Self {
        let quotient = self.value / divisor.value;
        let (product, lost) = two_product(quotient, divisor.value);
        let remainder = ((self.value - product) - lost) + (self.rest - quotient * divisor.rest);
        Self::new(quotient).plus_parts(R::ZERO, remainder / divisor.value)
    }

    /// The difference to a plain number, rounded to a plain number.
    #[inline(always)]
    pub fn minus(self, other: impl Into<R>) -> R {
        (self.value - other.into()) + self.rest
    }

    /// Half of the number, exactly.
    #[inline(always)]
    pub fn half(self) -> Self {
        Self { value: self.value * 0.5, rest: self.rest * 0.5 }
    }

    /// The number with the opposite sign, exactly.
    #[inline(always)]
    pub fn negated(self) -> Self {
        Self { value: -self.value, rest: -self.rest }
    }
}

impl<R: Real> std::ops::Neg for DoubleDouble<R> {
    type Output = DoubleDouble<R>;

    #[inline(always)]
    fn neg(self) -> DoubleDouble<R> {
        self.negated()
    }
}

impl<R: Real> std::ops::Add for DoubleDouble<R> {
    type Output = DoubleDouble<R>;

    #[inline(always)]
    fn add(self, other: DoubleDouble<R>) -> DoubleDouble<R> {
        self.plus_parts(other.value, other.rest)
    }
}

impl<R: Real> std::ops::Sub for DoubleDouble<R> {
    type Output = DoubleDouble<R>;

    #[inline(always)]
    fn sub(self, other: DoubleDouble<R>) -> DoubleDouble<R> {
        self.plus_parts(-other.value, -other.rest)
    }
}

impl<R: Real> std::ops::Mul for DoubleDouble<R> {
    type Output = DoubleDouble<R>;

    #[inline(always)]
    fn mul(self, other: DoubleDouble<R>) -> DoubleDouble<R> {
        let DoubleDouble { value, rest } = self.product(other);
        // The rest is small, so this renormalisation is exact.
        let sum = value + rest;
        DoubleDouble { value: sum, rest: rest - (sum - value) }
    }
}

impl<R: Real> std::ops::Div for DoubleDouble<R> {
    type Output = DoubleDouble<R>;

    fn div(self, other: DoubleDouble<R>) -> DoubleDouble<R> {
        self.over_sum(other)
    }
}

/// `a + b` as the rounded sum and its exact error.
#[inline(always)]
pub(crate) fn two_sum<R: Real>(a: R, b: R) -> (R, R) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// `a · b` as the rounded product and its exact error, provided that the error does not underflow.
#[inline(always)]
pub(crate) fn two_product<R: Real>(a: R, b: R) -> (R, R) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_million_tenths_keep_their_sum() {
        // 0.1 is a double slightly above 1/10; 10^7 of them sum to 10^6 + 10^7 · 5.55e-18.
        let total = (0..10_000_000).fold(DoubleDouble::<f64>::ZERO, |sum, _| sum.plus(0.1));
        assert_eq!(total.value, 1e6);
        assert!((total.rest - 1e7 * 5.551_115_123_125_783e-18).abs() < 1e-14);
    }

    #[test]
    fn a_third_times_three_is_one() {
        let third = DoubleDouble::new(1.0).over(3.0);
        assert_eq!(third.value, 1.0 / 3.0);
        // 1/3 = 6004799503160661 · 2⁻⁵⁴ + 2⁻⁵⁴/3.
        assert_eq!(third.rest, (1.0 / 3.0) * 2f64.powi(-54));
        let one = third.times(3.0);
        assert!((one.value - 1.0 + one.rest).abs() < 2f64.powi(-105));
    }
}
