//! Numbers of twice the precision: unevaluated sums of two doubles.
//!
//! Relative errors are some 2⁻¹⁰⁴ of the larger operand (T. J. Dekker, Numer. Math. 18, 1971; Y. Hida, X. S.
//! Li, D. H. Bailey, ARITH-15, 2001). Above 1e290 products lose the extra precision.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Real;
use super::mixed::beside_doubles;
use crate::number::compensated::{DoubleDouble, two_product, two_sum};
use crate::number::trigonometry::sine_cosine;

/// A number as the unevaluated sum of its rounded value and the rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twofold {
    high: f64,
    low: f64,
}

impl Twofold {
    const LN_2: Self = Self::new(std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);

    /// The sum of a high part and a low part of at most half a unit in the last place of the high part.
    pub const fn new(high: f64, low: f64) -> Self {
        Self { high, low }
    }

    /// The normalised sum of a number and a much smaller one.
    #[inline]
    fn renormalised(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: if sum.is_finite() { low - (sum - high) } else { 0.0 } }
    }

    /// The high part: the number rounded to double.
    pub fn high(self) -> f64 {
        self.high
    }

    /// The low part: the number minus its high part.
    pub fn low(self) -> f64 {
        self.low
    }

    /// eˣ of a double of moderate size.
    fn exp_of(x: f64) -> Self {
        const HALVINGS: i32 = 9;
        let halvings = (x / std::f64::consts::LN_2).round();
        let small = (Self::from(x) - Self::LN_2 * halvings) * 0.5f64.powi(HALVINGS);
        let term = |sum: Self, k: i32| Self::ONE + small * sum / f64::from(k);
        let mut power = (1..=11).rev().fold(Self::ONE, term);
        for _ in 0..HALVINGS {
            power = power * power;
        }
        let scale = 2f64.powi(halvings as i32);
        Self::new(power.high * scale, power.low * scale)
    }
}

impl Real for Twofold {
    const ZERO: Self = Self::new(0.0, 0.0);
    const ONE: Self = Self::new(1.0, 0.0);
    const EPSILON: Self = Self::new(f64::EPSILON * f64::EPSILON, 0.0);
    const NAN: Self = Self::new(f64::NAN, 0.0);
    const INFINITY: Self = Self::new(f64::INFINITY, 0.0);
    /// 2π to twice the precision of a double; its rest, which is not needed, is 0.
    const TURN: DoubleDouble<Self> =
        DoubleDouble::new(Self::new(std::f64::consts::TAU, 2.449_293_598_294_706_4e-16));
    const QUARTER: DoubleDouble<Self> = DoubleDouble {
        value: Self::new(std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17),
        rest: Self::new(-1.497_384_904_859_169_8e-33, 0.0),
    };
    const LEFT_OUT: Self = Self::new(1e-22, 0.0);
    const NEGLIGIBLE: Self = Self::new(1e-22, 0.0);
    /// With order 20 what is left out is smaller by a factor of 1e9.
    const STEP: f64 = 0.375;
    /// Every stretch of flight is searched, as a check of the proofs that replace the search in doubles.
    const FAST_PATHS: bool = false;

    fn reciprocal(n: usize) -> Self {
        Self::ONE / n as f64
    }

    /// Product and sum, each rounded.
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    /// For numbers whose squares are in range.
    fn hypot(self, other: impl Into<Self>) -> Self {
        let other = other.into();
        (self * self + other * other).sqrt()
    }

    fn powi(self, n: i32) -> Self {
        (0..n).fold(Self::ONE, |power, _| power * self)
    }

    fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        if root == 0.0 || !root.is_finite() {
            return Self::from(root);
        }
        let rest = self - Self::from(root) * root;
        Self::renormalised(root, rest.high / (2.0 * root))
    }

    fn ln(self) -> Self {
        let log = self.high.ln();
        if !log.is_finite() {
            return Self::from(log);
        }
        // One step of Newton's method for eʸ = x.
        Self::from(log) + (self * Self::exp_of(-log) - 1.0)
    }

    fn sincos(self) -> (Self, Self) {
        sine_cosine(self)
    }

    fn atan2(self, x: Self) -> Self {
        let angle = libm::atan2(self.high, x.high);
        let (s, c) = Self::from(angle).sincos();
        let radius = x * c + self * s;
        if radius == 0.0 { Self::from(angle) } else { (self * c - x * s) / radius + angle }
    }

    fn precise_sincos(angle: DoubleDouble<Self>) -> (DoubleDouble<Self>, DoubleDouble<Self>) {
        sine_cosine(angle)
    }

    // Of calls these are calls as well: inlined they make half of the code.
    #[inline(never)]
    fn sum_with_parts(sum: DoubleDouble<Self>, increment: Self, rest: Self) -> DoubleDouble<Self> {
        sum.plus_parts_inline(increment, rest)
    }

    #[inline(never)]
    fn product_of_parts(a: DoubleDouble<Self>, b: DoubleDouble<Self>) -> DoubleDouble<Self> {
        a.product_inline(b)
    }
}

impl From<f64> for Twofold {
    fn from(number: f64) -> Self {
        Self::new(number, 0.0)
    }
}

impl From<Twofold> for f64 {
    fn from(number: Twofold) -> f64 {
        number.high
    }
}

impl PartialOrd for Twofold {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.high.partial_cmp(&other.high) {
            Some(Ordering::Equal) => self.low.partial_cmp(&other.low),
            order => order,
        }
    }
}

impl Neg for Twofold {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.high, -self.low)
    }
}

// Not inlined: inlined into the core these operations make programs of many megabytes that take minutes to
// compile.
impl Add for Twofold {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let (sum, lost) = two_sum(self.high, other.high);
        let (low, lower) = two_sum(self.low, other.low);
        let first = Self::renormalised(sum, lost + low);
        Self::renormalised(first.high, first.low + lower)
    }
}

impl Sub for Twofold {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twofold {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let (product, lost) = two_product(self.high, other.high);
        Self::renormalised(product, lost + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Twofold {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        if first == 0.0 || !first.is_finite() || !other.high.is_finite() {
            return Self::from(first);
        }
        let rest = self - other * first;
        let second = rest.high / other.high;
        let rest = rest - other * second;
        Self::renormalised(first, second) + rest.high / other.high
    }
}

beside_doubles!(Twofold);

#[cfg(test)]
mod tests {
    use super::{Real, Twofold};

    /// Fails unless two numbers agree within this number of units of 2⁻¹⁰⁴.
    fn within(units: f64, a: Twofold, b: Twofold) {
        let off = f64::from((a - b).abs() / b.abs() / Twofold::EPSILON);
        assert!(off <= units, "{a:?} {b:?}: {off} units");
    }

    fn near(a: Twofold, b: Twofold) {
        within(8.0, a, b);
    }

    #[test]
    fn what_is_undone_comes_back() {
        for x in [1.0 / 3.0, 0.7, 1.9, 2.5e-7, 3.1e5] {
            let number = Twofold::from(x) / 3.0 + 1e-20;
            near(number.sqrt() * number.sqrt(), number);
            near((Twofold::ONE / number) * number, Twofold::ONE);
            // Each of nine squarings doubles the relative error.
            within(2048.0, (number * number).ln(), 2.0 * number.ln());
        }
    }

    #[test]
    fn angles_come_back() {
        for x in [-3.0, -1.0, -1e-9, 0.3, 1.5, 2.9] {
            let angle = Twofold::from(x) / 3.0 * 3.0 + 1e-19;
            let (s, c) = angle.sincos();
            near(s.atan2(c), angle);
            near(s * s + c * c, Twofold::ONE);
        }
    }

    /// ln 2 and ln 10 to 32 digits (A. Brousseau and D. E. Knuth's tables, OEIS A002162, A002392).
    #[test]
    fn logarithms_are_known() {
        within(2048.0, Twofold::from(2.0).ln(), Twofold::LN_2);
        let ln_10 = Twofold::new(std::f64::consts::LN_10, -2.170_756_223_382_249_4e-16);
        within(2048.0, Twofold::from(10.0).ln(), ln_10);
    }

    #[test]
    fn infinity_and_nan_behave_as_in_doubles() {
        let infinity = Twofold::INFINITY;
        assert!(infinity > 1e308 && !infinity.is_finite() && (infinity - infinity).is_nan());
        assert_eq!(Twofold::ONE / infinity, 0.0);
        assert_eq!(infinity.min(1.0), 1.0);
        assert_eq!((Twofold::ZERO / Twofold::ZERO).max(2.0), 2.0);
    }
}
