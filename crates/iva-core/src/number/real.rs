//! The number types in which a motion is computed.
//!
//! The core is generic over [`Real`]: a double, or a number of [twice the precision](twofold) to verify and differentiate
//! a run with. A pendulum's series are also computed in numbers with derivatives, for its tangent. Thresholds that depend
//! on the precision are constants of the type. Types are doubles by default: `DoubleDouble` is `DoubleDouble<f64>`.
//!
//! In a formula a double stands to the right of a number, as in `x * 0.5`, and [`Real::ONE`] to the left.

use std::cmp::Ordering;
use std::fmt::Debug;
use std::iter;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::number::compensated::DoubleDouble;

pub(crate) mod dual;
mod mixed;
pub mod twofold;

/// A real number, with the operations of doubles and mixed operations with doubles.
pub trait Real:
    Copy
    + Debug
    + Default
    + Send
    + Sync
    + 'static
    + From<f64>
    + Into<f64>
    + PartialEq
    + PartialOrd
    + PartialEq<f64>
    + PartialOrd<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + AddAssign<f64>
    + SubAssign<f64>
    + MulAssign<f64>
    + DivAssign<f64>
    + iter::Sum
{
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// Not a number.
    const NAN: Self;
    /// ∞
    const INFINITY: Self;
    /// 2π as a double-double: high and low part.
    const TURN: DoubleDouble<Self>;
    /// π/2 as a double-double: high and low part.
    const QUARTER: DoubleDouble<Self>;
    /// Largest relative truncation error of each variable in a step of a pendulum's flight at full accuracy.
    const LEFT_OUT: Self;
    /// Largest estimated error of the summed duration of a chatter, in 1/ωn.
    const NEGLIGIBLE: Self;
    /// The longest step of a power series of fixed order, over that in doubles.
    const STEP: f64 = 1.0;
    /// True if flights decided by a proof in closed form skip the search for a contact.
    const FAST_PATHS: bool;

    /// The number rounded to a double.
    #[inline(always)]
    fn double(self) -> f64 {
        self.into()
    }

    /// The reciprocal 1/n.
    fn reciprocal(n: usize) -> Self;

    /// As [`f64::mul_add`].
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// As [`f64::hypot`].
    fn hypot(self, other: impl Into<Self>) -> Self;

    /// As [`f64::powi`], for n ≥ 0.
    fn powi(self, n: i32) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self;

    /// Sine and cosine of an angle within [−2π, 2π].
    fn sincos(self) -> (Self, Self);

    /// Sine and cosine of an angle within [−π, π], in double-double.
    fn precise_sincos(angle: DoubleDouble<Self>) -> (DoubleDouble<Self>, DoubleDouble<Self>);

    /// Angle of the point (x, self) from the x axis.
    fn atan2(self, x: Self) -> Self;

    /// As [`f64::abs`].
    fn abs(self) -> Self {
        if self < 0.0 { -self } else { self }
    }

    /// As [`f64::signum`]: ±1.
    fn signum(self) -> Self {
        self.double().signum().into()
    }

    /// As [`f64::copysign`].
    fn copysign(self, sign: Self) -> Self {
        self.abs() * sign.signum()
    }

    /// As [`f64::max`].
    fn max(self, other: impl Into<Self>) -> Self {
        let other = other.into();
        if other > self || self.is_nan() { other } else { self }
    }

    /// As [`f64::min`].
    fn min(self, other: impl Into<Self>) -> Self {
        let other = other.into();
        if other < self || self.is_nan() { other } else { self }
    }

    /// As [`f64::clamp`].
    #[inline(always)]
    fn clamp(self, low: impl Into<Self>, high: impl Into<Self>) -> Self {
        self.max(low).min(high)
    }

    /// As [`f64::midpoint`].
    fn midpoint(self, other: Self) -> Self {
        (self + other) * 0.5
    }

    /// As [`f64::round`]; exact where the result is no larger than 2⁵³.
    fn round(self) -> Self {
        self.double().round().into()
    }

    /// As [`f64::ceil`]; exact where the result is no larger than 2⁵³.
    fn ceil(self) -> Self {
        let near = self.round();
        if near < self { near + 1.0 } else { near }
    }

    /// As [`f64::total_cmp`].
    fn total_cmp(&self, other: &Self) -> Ordering {
        let unordered = self.double().total_cmp(&other.double());
        PartialOrd::<Self>::partial_cmp(self, other).unwrap_or(unordered)
    }

    /// As [`f64::is_finite`].
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.double().is_finite()
    }

    /// As [`f64::is_nan`].
    #[inline(always)]
    fn is_nan(self) -> bool {
        self.double().is_nan()
    }

    /// The larger of two numbers, by one comparison. If one is NaN, the result is `b`.
    #[inline(always)]
    fn larger(a: Self, b: Self) -> Self {
        if a > b { a } else { b }
    }

    /// A quotient of which seven digits suffice, in a range from 1e−38 to 1e38: in single precision it takes a
    /// third of the time.
    #[inline(always)]
    fn about(a: Self, b: Self) -> Self {
        a / b
    }

    /// The largest integer not above a number ≥ 0.
    #[inline(always)]
    fn whole(self) -> usize {
        self.double() as usize
    }

    /// The largest power of two not above a number > 0.
    #[inline(always)]
    fn power_of_two(self) -> Self {
        const EXPONENT: u64 = 0x7ff << 52;
        f64::from_bits(self.double().to_bits() & EXPONENT).into()
    }

    /// [`DoubleDouble::plus_parts`].
    #[inline(always)]
    fn sum_with_parts(sum: DoubleDouble<Self>, increment: Self, rest: Self) -> DoubleDouble<Self> {
        sum.plus_parts_inline(increment, rest)
    }

    /// The product of two double-doubles, not renormalised.
    #[inline(always)]
    fn product_of_parts(a: DoubleDouble<Self>, b: DoubleDouble<Self>) -> DoubleDouble<Self> {
        a.product_inline(b)
    }

    /// An upper bound of log₂ of a number > 0, at most 0.09 too large.
    #[inline(always)]
    fn log2_above(self) -> f64 {
        // Exponent and mantissa, read as one integer, interpolate log₂ linearly between powers of two.
        const ONE_ABOVE: f64 = (1u64 << 52) as f64;
        self.double().to_bits() as i64 as f64 / ONE_ABOVE - (1023.0 - 0.0862)
    }
}

/// `yes` if `which`, else `no`, without a branch.
#[inline(always)]
pub(crate) fn pick<T>(which: bool, yes: T, no: T) -> T {
    if which { yes } else { no }
}

/// Reciprocals of integers below this are in a table.
const TABLED: usize = 28;

impl Real for f64 {
    const ZERO: f64 = 0.0;
    const ONE: f64 = 1.0;
    const EPSILON: f64 = f64::EPSILON;
    const NAN: f64 = f64::NAN;
    const INFINITY: f64 = f64::INFINITY;
    const TURN: DoubleDouble =
        DoubleDouble { value: std::f64::consts::TAU, rest: 2.449_293_598_294_706_4e-16 };
    const QUARTER: DoubleDouble =
        DoubleDouble { value: std::f64::consts::FRAC_PI_2, rest: 6.123_233_995_736_766e-17 };
    /// A quarter of a rounding error. It is a proven bound; the true truncation error is smaller by a factor of some
    /// three or more.
    const LEFT_OUT: f64 = 3e-17;
    /// A tenth of the rounding error of a time of order 1.
    const NEGLIGIBLE: f64 = 1e-17;
    const FAST_PATHS: bool = true;

    #[inline]
    fn reciprocal(n: usize) -> f64 {
        const TABLE: [f64; TABLED] = {
            let mut table = [1.0; TABLED];
            let mut n = 1;
            while n < table.len() {
                table[n] = 1.0 / n as f64;
                n += 1;
            }
            table
        };
        TABLE.get(n).copied().unwrap_or(1.0 / n as f64)
    }

    #[inline(always)]
    fn mul_add(self, factor: f64, addend: f64) -> f64 {
        f64::mul_add(self, factor, addend)
    }

    #[inline(always)]
    fn hypot(self, other: impl Into<f64>) -> f64 {
        libm::hypot(self, other.into())
    }

    #[inline(always)]
    fn powi(self, n: i32) -> f64 {
        f64::powi(self, n)
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn ln(self) -> f64 {
        libm::log(self)
    }

    #[inline(always)]
    fn about(a: f64, b: f64) -> f64 {
        f64::from(a as f32 / b as f32)
    }

    #[inline(always)]
    fn sincos(self) -> (f64, f64) {
        libm::sincos(self)
    }

    #[inline(always)]
    fn precise_sincos(angle: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
        crate::number::trigonometry::close_sine_cosine(angle)
    }

    #[inline(always)]
    fn atan2(self, x: f64) -> f64 {
        libm::atan2(self, x)
    }

    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }

    #[inline(always)]
    fn signum(self) -> f64 {
        f64::signum(self)
    }

    #[inline(always)]
    fn copysign(self, sign: f64) -> f64 {
        f64::copysign(self, sign)
    }

    #[inline(always)]
    fn max(self, other: impl Into<f64>) -> f64 {
        f64::max(self, other.into())
    }

    #[inline(always)]
    fn min(self, other: impl Into<f64>) -> f64 {
        f64::min(self, other.into())
    }

    #[inline(always)]
    fn clamp(self, low: impl Into<f64>, high: impl Into<f64>) -> f64 {
        f64::clamp(self, low.into(), high.into())
    }

    #[inline(always)]
    fn midpoint(self, other: f64) -> f64 {
        f64::midpoint(self, other)
    }

    #[inline(always)]
    fn round(self) -> f64 {
        f64::round(self)
    }

    #[inline(always)]
    fn ceil(self) -> f64 {
        f64::ceil(self)
    }

    #[inline(always)]
    fn total_cmp(&self, other: &f64) -> Ordering {
        f64::total_cmp(self, other)
    }
}
