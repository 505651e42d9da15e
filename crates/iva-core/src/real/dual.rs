//! The numbers that the motion is carried in: doubles with a derivative by one variable.

use iva_core::dual::Dual;
pub use iva_core::real::dispatched;

/// A real number.
pub type Real = Dual;

/// 0
pub const ZERO: Real = Dual::ZERO;
/// 1
pub const ONE: Real = Dual::ONE;
/// 2π, and what that lacks.
pub const TURN: [Real; 2] =
    [Dual::constant(iva_core::real::TURN[0]), Dual::constant(iva_core::real::TURN[1])];
/// π/2, and what that lacks.
pub const QUARTER: [Real; 2] =
    [Dual::constant(iva_core::real::QUARTER[0]), Dual::constant(iva_core::real::QUARTER[1])];
/// As in doubles.
pub const LEFT_OUT: Real = Dual::constant(iva_core::real::LEFT_OUT);
/// As in doubles: a chatter is summed from the same rebound on.
pub const NEGLIGIBLE: Real = Dual::constant(iva_core::real::NEGLIGIBLE);

/// What a number given by the user enters as.
pub fn given(value: f64, differentiated: bool) -> Real {
    if differentiated { Dual::variable(value, 0) } else { value.into() }
}

/// The largest power of two that a number > 0 is not below.
pub fn power_of_two(number: Real) -> Real {
    iva_core::real::power_of_two(f64::from(number)).into()
}

/// log₂ of a number > 0, at most 0.09 too large.
pub fn log2_above(number: Real) -> f64 {
    iva_core::real::log2_above(number.into())
}

/// As in doubles, so that values have the same bits and a run makes the same decisions.
pub const STRIDES: bool = iva_core::real::STRIDES;

/// The whole number below, of a number ≥ 0.
pub fn whole(number: Real) -> usize {
    f64::from(number) as usize
}

/// 1/n.
pub fn reciprocal(n: usize) -> Real {
    Dual::constant(iva_core::real::reciprocal(n))
}

/// Sine and cosine.
pub fn sincos(angle: Real) -> (Real, Real) {
    angle.sincos()
}

/// Angle of the point (x, y) from the x axis.
pub fn atan2(y: Real, x: Real) -> Real {
    y.atan2(x)
}

/// The root of a function that is at h: how it moves with the variable follows from the derivatives
/// of the function there, not from the way it was found (the implicit function theorem).
pub fn settled(h: Real, f: impl Fn(Real) -> [Real; 2]) -> Option<Real> {
    let mut root = Dual::constant(h.value);
    let [value, slope] = f(root);
    root.slopes = value.slopes.map(|moved| -moved / slope.value);
    Some(root)
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
    crate::trigonometry::close_sine_cosine(angle)
}
