//! The numbers that the motion is carried in: of twice the precision of doubles.

use iva_core::twofold::Twofold;

/// A real number.
pub type Real = Twofold;

/// 0
pub const ZERO: Real = Twofold::ZERO;
/// 1
pub const ONE: Real = Twofold::ONE;
/// 2π, and what that lacks of the precision of [`crate::compensated`]: unknown here.
pub const TURN: [Real; 2] =
    [Twofold::new(std::f64::consts::TAU, 2.449_293_598_294_706_4e-16), Twofold::ZERO];
/// π/2, and what that lacks.
pub const QUARTER: [Real; 2] = [
    Twofold::new(std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17),
    Twofold::new(-1.497_384_904_859_169_8e-33, 0.0),
];
/// What a step of a pendulum's flight may leave out, over the size of each variable.
pub const LEFT_OUT: Real = Twofold::new(1e-22, 0.0);
/// Largest estimated error of the summed duration of a chatter, in 1/ωn.
pub const NEGLIGIBLE: Real = Twofold::new(1e-22, 0.0);

/// What a number given by the user enters as.
pub fn given(value: f64, _differentiated: bool) -> Real {
    value.into()
}

/// The largest power of two that a number > 0 is not below.
pub fn power_of_two(number: Real) -> Real {
    iva_core::real::power_of_two(f64::from(number)).into()
}

/// log₂ of a number > 0, at most 0.09 too large.
pub fn log2_above(number: Real) -> f64 {
    iva_core::real::log2_above(number.into())
}

/// Every stretch of flight is searched as if it were a hard one: a check of those that are not.
pub const STRIDES: bool = false;

/// Runs code.
pub fn dispatched<R>(code: impl FnOnce() -> R) -> R {
    code()
}

/// The whole number below, of a number ≥ 0.
pub fn whole(number: Real) -> usize {
    f64::from(number) as usize
}

/// 1/n.
pub fn reciprocal(n: usize) -> Real {
    Twofold::ONE / n as f64
}

/// Sine and cosine of an angle within [−2π, 2π].
pub fn sincos(angle: Real) -> (Real, Real) {
    angle.sincos()
}

/// Angle of the point (x, y) from the x axis.
pub fn atan2(y: Real, x: Real) -> Real {
    y.atan2(x)
}

/// The root of a function close to h: h itself.
pub fn settled(_h: Real, _f: impl Fn(Real) -> [Real; 2]) -> Option<Real> {
    None
}

/// The larger of two numbers, by one comparison: of a number and none the second.
#[inline(always)]
pub fn larger(a: Real, b: Real) -> Real {
    if a > b { a } else { b }
}

/// Sine and cosine of an angle within [−π, π], closer than the number can tell.
#[inline(always)]
pub fn precise_sincos(
    angle: crate::compensated::Sum,
) -> (crate::compensated::Sum, crate::compensated::Sum) {
    crate::trigonometry::sine_cosine(angle)
}
