//! The numbers that the motion is carried in: doubles.
//!
//! The core is written for *a* real number. The same source is compiled again with
//! [`Twofold`](crate::twofold::Twofold) in its place, to verify a run (crate `iva-core-twofold`), and
//! with [`Dual`](crate::dual::Dual), to differentiate it (crate `iva-core-dual`). Each has a module
//! like this one and a list of modules beside this crate's root.

pub use libm::{atan2, sincos};

/// A real number.
pub type Real = f64;

/// 0
pub const ZERO: Real = 0.0;
/// 1
pub const ONE: Real = 1.0;
/// 2π, and what that lacks.
pub const TURN: [Real; 2] = [std::f64::consts::TAU, 2.449_293_598_294_706_4e-16];
/// π/2, and what that lacks.
pub const QUARTER: [Real; 2] = [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17];
/// What a step of a pendulum's flight may leave out at full accuracy, over the size of each variable:
/// as much as rounding does. It is a proven bound; what is left out in fact is some ten times less or more.
pub const LEFT_OUT: Real = 1e-16;
/// Largest estimated error of the summed duration of a chatter, in 1/ωn. Rounding of a time of order 1
/// is ten times larger.
pub const NEGLIGIBLE: Real = 1e-17;

/// Numbers up to this have their reciprocal in a table.
const TABLED: usize = 28;

/// 1/n.
#[inline]
pub fn reciprocal(n: usize) -> Real {
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

/// What a number given by the user enters as; `differentiated` if results are to be differentiated by
/// it.
pub fn given(value: f64, _differentiated: bool) -> Real {
    value
}

/// The largest power of two that a number > 0 is not below.
#[inline]
pub fn power_of_two(number: Real) -> Real {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(number.to_bits() & EXPONENT)
}

/// log₂ of a number > 0, at most 0.09 too large.
#[inline(always)]
pub fn log2_above(number: Real) -> f64 {
    // Exponent and mantissa, read as one number, are log₂ from one power of two to the next by a chord.
    const ONE_ABOVE: f64 = (1u64 << 52) as f64;
    number.to_bits() as i64 as f64 / ONE_ABOVE - (1023.0 - 0.0862)
}

/// True if strides ([`crate::siva`]) are to be gone: what verifies a run goes without.
pub const STRIDES: bool = true;

/// Runs code in the best instructions that the machine has. What is inlined into it has a fused
/// multiply-add, the same bits faster.
#[inline]
pub fn dispatched<R>(code: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(code)
}

/// The whole number below, of a number ≥ 0.
#[inline]
pub fn whole(number: Real) -> usize {
    number as usize
}

/// A closer root of a function than h, which is given with value and slope; `None`: h is as close as
/// doubles can tell.
#[inline]
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
    crate::trigonometry::close_sine_cosine(angle)
}
