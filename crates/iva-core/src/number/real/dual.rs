//! Numbers with derivatives: forward-mode automatic differentiation, for the tangents of power series.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Real;
use super::mixed::beside_doubles;
use crate::number::compensated::DoubleDouble;

/// A value and its derivatives with respect to N variables.
#[derive(Debug, Clone, Copy)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// The derivatives, one for each variable.
    pub slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// A constant: all derivatives are 0.
    pub const fn constant(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }

    /// f of this number, by the chain rule from f and f′ at its value.
    fn through(self, f: f64, slope: f64) -> Self {
        Self { value: f, slopes: self.slopes.map(|it| if it == 0.0 { 0.0 } else { slope * it }) }
    }

    #[inline(always)]
    fn with(self, other: Self, value: f64, rule: impl Fn(f64, f64) -> f64) -> Self {
        let slopes = std::array::from_fn(|i| rule(self.slopes[i], other.slopes[i]));
        Self { value, slopes }
    }
}

/// The values have the bits of doubles.
impl<const N: usize> Real for Dual<N> {
    const ZERO: Self = Self::constant(0.0);
    const ONE: Self = Self::constant(1.0);
    const EPSILON: Self = Self::constant(f64::EPSILON);
    const NAN: Self = Self::constant(f64::NAN);
    const INFINITY: Self = Self::constant(f64::INFINITY);
    const TURN: DoubleDouble<Self> = DoubleDouble {
        value: Self::constant(f64::TURN.value),
        rest: Self::constant(f64::TURN.rest),
    };
    const QUARTER: DoubleDouble<Self> = DoubleDouble {
        value: Self::constant(f64::QUARTER.value),
        rest: Self::constant(f64::QUARTER.rest),
    };
    const LEFT_OUT: Self = Self::constant(f64::LEFT_OUT);
    const NEGLIGIBLE: Self = Self::constant(f64::NEGLIGIBLE);
    const FAST_PATHS: bool = f64::FAST_PATHS;

    fn reciprocal(n: usize) -> Self {
        Self::constant(Real::reciprocal(n))
    }

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let (p, q) = (self.value, factor.value);
        let slope = |i: usize| self.slopes[i] * q + p * factor.slopes[i] + addend.slopes[i];
        Self { value: p.mul_add(q, addend.value), slopes: std::array::from_fn(slope) }
    }

    fn hypot(self, other: impl Into<Self>) -> Self {
        let other = other.into();
        let length = libm::hypot(self.value, other.value);
        let [p, q] = [self, other].map(|it| if length > 0.0 { it.value / length } else { 0.0 });
        self.with(other, length, |a, b| p * a + q * b)
    }

    fn powi(self, n: i32) -> Self {
        let slope = if n == 0 { 0.0 } else { f64::from(n) * self.value.powi(n - 1) };
        self.through(self.value.powi(n), slope)
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.through(root, 0.5 / root)
    }

    fn ln(self) -> Self {
        self.through(libm::log(self.value), 1.0 / self.value)
    }

    fn about(a: Self, b: Self) -> Self {
        let quotient = a.value / b.value;
        a.with(b, f64::about(a.value, b.value), |da, db| (da - quotient * db) / b.value)
    }

    fn sincos(self) -> (Self, Self) {
        let (s, c) = libm::sincos(self.value);
        (self.through(s, c), self.through(c, -s))
    }

    fn atan2(self, x: Self) -> Self {
        let (y, square) = (self.value, self.value * self.value + x.value * x.value);
        self.with(x, libm::atan2(y, x.value), |dy, dx| (dy * x.value - dx * y) / square)
    }

    fn precise_sincos(angle: DoubleDouble<Self>) -> (DoubleDouble<Self>, DoubleDouble<Self>) {
        crate::number::trigonometry::close_sine_cosine(angle)
    }
}

impl<const N: usize> Default for Dual<N> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl<const N: usize> From<Dual<N>> for f64 {
    fn from(number: Dual<N>) -> f64 {
        number.value
    }
}

/// Compares the values; derivatives have no effect.
impl<const N: usize> PartialEq for Dual<N> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<const N: usize> PartialOrd for Dual<N> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, self.value + other.value, |a, b| a + b)
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, self.value - other.value, |a, b| a - b)
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // the product rule
impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (p, q) = (self.value, other.value);
        self.with(other, p * q, |a, b| a * q + p * b)
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // the quotient rule
impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (quotient, q) = (self.value / other.value, other.value);
        self.with(other, quotient, |a, b| (a - quotient * b) / q)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self, -self.value, |a, _| -a)
    }
}

beside_doubles!(Dual<N>, N);

#[cfg(test)]
mod tests {
    use super::{Dual, Real};

    /// Derivatives agree with central differences, whose error is some 1e-9.
    #[test]
    fn derivatives_are_those_of_the_functions() {
        let f = |x: Dual<1>| {
            let (s, c) = (x * 0.7).sincos();
            (s / (1.0 + c * c)).atan2(x.ln()) * (2.0 - x).sqrt()
        };
        for x in [0.3, 0.9, 1.7] {
            let h = 1e-5;
            let difference = (f(Dual::constant(x + h)) - f(Dual::constant(x - h))) / (2.0 * h);
            let [slope] = f(Dual { value: x, slopes: [1.0] }).slopes;
            assert!((slope - difference.value).abs() < 1e-8, "{x}: {slope} {}", difference.value);
        }
    }
}
