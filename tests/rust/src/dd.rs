//! Double-double numbers: a value as the unevaluated sum of two doubles, about 31 decimal digits.
//!
//! The exact values of these tests are computed with them, so that their error stays far below the rounding
//! unit in which the simulator is judged. Error-free sums and products after Dekker (1971) and Knuth (TAOCP
//! 2, 4.2.2).

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The number `hi + lo` with `|lo| ≤ ulp(hi)/2`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dd {
    /// High part: the value rounded to a double.
    pub hi: f64,
    /// Low part: the value minus the high part.
    pub lo: f64,
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    (s, b - (s - a))
}

fn split(a: f64) -> (f64, f64) {
    let t = 134_217_729.0 * a; // 2^27 + 1
    let hi = t - (t - a);
    (hi, a - hi)
}

fn two_prod(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    let (ah, al) = split(a);
    let (bh, bl) = split(b);
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl Dd {
    /// Zero.
    pub const ZERO: Self = Self { hi: 0.0, lo: 0.0 };
    /// One.
    pub const ONE: Self = Self { hi: 1.0, lo: 0.0 };

    /// The exact sum of two doubles.
    pub fn sum(a: f64, b: f64) -> Self {
        let (hi, lo) = two_sum(a, b);
        Self { hi, lo }
    }

    /// Reads a decimal such as `-12.345e-7` to about 31 digits.
    ///
    /// # Panics
    /// On anything that is not a decimal.
    pub fn parse(text: &str) -> Self {
        let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let mut exponent: i32 = exponent.parse().expect("an exponent");
        let negative = mantissa.starts_with('-');
        let (mut value, mut after_point) = (Self::ZERO, false);
        for byte in mantissa.trim_start_matches(['-', '+']).bytes() {
            match byte {
                b'.' => after_point = true,
                b'0'..=b'9' => {
                    value = value * 10.0 + f64::from(byte - b'0');
                    exponent -= i32::from(after_point);
                }
                _ => panic!("not a decimal: {text}"),
            }
        }
        let mut power = Self::ONE;
        for _ in 0..exponent.unsigned_abs() {
            power = power * 10.0;
        }
        let value = if exponent < 0 { value / power } else { value * power };
        if negative { -value } else { value }
    }

    /// Absolute value.
    pub fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// Square root of a number ≥ 0.
    pub fn sqrt(self) -> Self {
        if self.hi <= 0.0 {
            return Self::ZERO;
        }
        let guess = Self::from(self.hi.sqrt());
        guess + (self - guess * guess) / (guess * 2.0)
    }

    /// The nearest double.
    pub fn value(self) -> f64 {
        self.hi
    }
}

impl From<f64> for Dd {
    fn from(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }
}

impl Neg for Dd {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl<T: Into<Dd>> Add<T> for Dd {
    type Output = Self;
    fn add(self, other: T) -> Self {
        let other = other.into();
        let (s, e) = two_sum(self.hi, other.hi);
        let (t, f) = two_sum(self.lo, other.lo);
        let (s, e) = quick_two_sum(s, e + t);
        let (hi, lo) = quick_two_sum(s, e + f);
        Self { hi, lo }
    }
}

impl<T: Into<Dd>> Sub<T> for Dd {
    type Output = Self;
    fn sub(self, other: T) -> Self {
        self + -other.into()
    }
}

impl<T: Into<Dd>> Mul<T> for Dd {
    type Output = Self;
    fn mul(self, other: T) -> Self {
        let other = other.into();
        let (p, e) = two_prod(self.hi, other.hi);
        let (hi, lo) = quick_two_sum(p, e + (self.hi * other.lo + self.lo * other.hi));
        Self { hi, lo }
    }
}

impl<T: Into<Dd>> Div<T> for Dd {
    type Output = Self;
    fn div(self, other: T) -> Self {
        let other = other.into();
        let first = self.hi / other.hi;
        let rest = self - other * first;
        let second = rest.hi / other.hi;
        let rest = rest - other * second;
        let (hi, lo) = quick_two_sum(first, second);
        Self { hi, lo } + rest.hi / other.hi
    }
}

impl PartialOrd for Dd {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        match self.hi.partial_cmp(&other.hi) {
            Some(Ordering::Equal) => self.lo.partial_cmp(&other.lo),
            order => order,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_keeps_31_digits() {
        let third = Dd::ONE / 3.0;
        assert!((third * 3.0 - 1.0).abs().hi < 1e-31);
        let root = Dd::from(2.0).sqrt();
        // sqrt(2) to 40 digits (OEIS A002193)
        let known = Dd::parse("1.414213562373095048801688724209698078570");
        assert!((root - known).abs().hi < 1e-31);
        assert!((root * root - 2.0).abs().hi < 1e-31);
    }

    #[test]
    fn decimals_are_read_to_the_last_digit() {
        let tenth = Dd::parse("0.1");
        assert_eq!(tenth.hi, 0.1);
        // 0.1 as a double is 0.1000000000000000055511151231257827…
        assert!((tenth.lo + 5.551_115_123_125_783e-18).abs() < 1e-32);
        assert_eq!(Dd::parse("-1.25e3").hi, -1250.0);
        assert_eq!(Dd::parse("8.56e-06").hi, 8.56e-6);
    }
}
