//! Power series: their highest order, rows of coefficients, and loops over orders without a loop.

use super::compensated::DoubleDouble;
use super::real::Real;
use super::trigonometry::{close_angle, plain_angle};

/// Runs code for each number below an end that the compiler knows, without a loop.
#[cfg(not(target_arch = "wasm32"))]
macro_rules! unrolled {
    ($k:ident < $end:expr => $body:expr) => {{
        const { assert!($end < 22, "a number at or above 21 would be left out") };
        unrolled!($k < $end => $body; 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20)
    }};
    ($k:ident < $end:expr => $body:expr; $($number:literal)*) => {{
        $(if $number < $end {
            let $k: usize = $number;
            $body
        })*
    }};
}

/// Runs code for each number below an end. WebAssembly is sent to the one who runs it, so that its size counts.
#[cfg(target_arch = "wasm32")]
macro_rules! unrolled {
    ($k:ident < $end:expr => $body:expr) => {
        for $k in 0..$end {
            $body
        }
    };
}

pub(crate) use unrolled;

/// Highest order of the series.
pub const ORDER: usize = 20;

/// Coefficients of one variable.
pub type Row<T> = [T; ORDER + 1];

/// Numbers that a series can be computed in: doubles, or doubles with their rounding rests where a
/// grazing is to be decided.
pub trait Number:
    Copy
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<Output = Self>
    + std::ops::Div<Output = Self>
    + std::ops::Neg<Output = Self>
{
    /// The numbers of the motion.
    type Real: Real;
    /// The number without rest.
    fn from_real(value: Self::Real) -> Self;
    /// 1/n.
    fn reciprocal(n: usize) -> Self;
    /// 1/h of the length of a step.
    #[inline(always)]
    fn over(h: Self::Real) -> Self {
        Self::from_real(Self::Real::ONE / h)
    }
    /// True if the orders of a series are to be unrolled: worth it where an operation is an instruction.
    const UNROLLED: bool = false;
    /// self · factor + addend.
    #[inline(always)]
    fn fused(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }
    /// The angle within [−π/2, π/2] that has this sine and cosine.
    fn angle(sine: Self, cosine: Self) -> Self;
}

impl<R: Real> Number for R {
    type Real = R;
    const UNROLLED: bool = !cfg!(target_arch = "wasm32");
    #[inline(always)]
    fn from_real(value: R) -> Self {
        value
    }
    #[inline(always)]
    fn reciprocal(n: usize) -> Self {
        R::reciprocal(n)
    }
    #[inline(always)]
    fn fused(self, factor: Self, addend: Self) -> Self {
        self.mul_add(factor, addend)
    }
    #[inline(always)]
    fn angle(sine: Self, cosine: Self) -> Self {
        plain_angle(sine, cosine)
    }
}

impl<R: Real> Number for DoubleDouble<R> {
    type Real = R;
    #[inline(always)]
    fn from_real(value: R) -> Self {
        DoubleDouble::new(value)
    }
    #[inline(always)]
    fn reciprocal(n: usize) -> Self {
        if n == 1 { DoubleDouble::new(R::ONE) } else { DoubleDouble::new(R::ONE).over(n as f64) }
    }
    #[inline(always)]
    fn over(h: R) -> Self {
        DoubleDouble::new(R::ONE).over(h)
    }
    #[inline(always)]
    fn angle(sine: Self, cosine: Self) -> Self {
        close_angle(sine, cosine)
    }
}
