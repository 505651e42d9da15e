//! Numbers with their derivatives by the four state variables: a series computed in them is a series
//! and its derivative at once.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Number;

/// A value and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Its derivatives by x, ẋ, y and W.
    pub slopes: [f64; 4],
}

impl Dual {
    /// The variable with this number: its derivative by itself is 1.
    pub fn variable(value: f64, number: usize) -> Self {
        let mut slopes = [0.0; 4];
        slopes[number] = 1.0;
        Self { value, slopes }
    }

    fn with(self, other: Self, value: f64, rule: impl Fn(f64, f64) -> f64) -> Self {
        let slopes = std::array::from_fn(|i| rule(self.slopes[i], other.slopes[i]));
        Self { value, slopes }
    }
}

impl Number for Dual {
    fn from_double(value: f64) -> Self {
        Self { value, slopes: [0.0; 4] }
    }
    fn reciprocal(n: usize) -> Self {
        Self::from_double(f64::reciprocal(n))
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.with(other, self.value + other.value, |a, b| a + b)
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.with(other, self.value - other.value, |a, b| a - b)
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // the product rule
impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (p, q) = (self.value, other.value);
        self.with(other, p * q, |a, b| a * q + p * b)
    }
}

#[allow(clippy::suspicious_arithmetic_impl)] // the quotient rule
impl Div for Dual {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let (quotient, q) = (self.value / other.value, other.value);
        self.with(other, quotient, |a, b| (a - quotient * b) / q)
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self.with(self, -self.value, |a, _| -a)
    }
}
