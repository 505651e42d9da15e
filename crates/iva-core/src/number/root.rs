//! Roots of small degree, in any number: Halley's method in doubles, then Newton's in the number itself.
//!
//! Only + − × ÷ are used, so that a root has the same bits on every machine.

use crate::number::real::Real;

/// Steps of Halley's method from a start that is wrong by 12 % at most: each cubes the error.
const IN_DOUBLES: usize = 4;
/// Steps of Newton's method from there: each squares the error.
const IN_THE_NUMBER: usize = 2;

/// xⁿ by multiplication.
pub(crate) fn power<R: Real>(x: R, n: u32) -> R {
    (1..n).fold(x, |power, _| power * x)
}

/// The n-th root of a number ≥ 0, for n from 1 to 8: 0 of 0.
pub(crate) fn root<R: Real>(number: R, n: u32) -> R {
    if number == 0.0 || n == 1 {
        return number;
    }
    let degree = f64::from(n);
    let mut near = R::from(near_root(number.double(), n));
    for _ in 0..IN_THE_NUMBER {
        let slope = power(near, n - 1);
        near -= (near * slope - number) / (slope * degree);
    }
    near
}

/// The root of a double, within some rounding errors.
fn near_root(number: f64, n: u32) -> f64 {
    // Exponent and mantissa, read as one integer, are about linear in the logarithm.
    let one = 1f64.to_bits() as i64;
    let bits = (number.to_bits() as i64 - one) / i64::from(n) + one;
    let (less, more) = (f64::from(n) - 1.0, f64::from(n) + 1.0);
    (0..IN_DOUBLES).fold(f64::from_bits(bits as u64), |root, _| {
        let raised = power(root, n);
        root * ((less * raised + more * number) / (more * raised + less * number))
    })
}

#[cfg(test)]
mod tests {
    use super::{power, root};
    use crate::number::real::{Real, twofold::Twofold};

    const NUMBERS: [f64; 9] = [1e-290, 3e-75, 7.3e-16, 1e-5, 0.4, 1.0, 1.9999, 31.0, 6e74];

    #[test]
    fn powers_of_roots_are_the_numbers() {
        for (number, n) in NUMBERS.into_iter().flat_map(|it| (1..=8).map(move |n| (it, n))) {
            let off = power(root(number, n), n) / number - 1.0;
            assert!(off.abs() <= 2.0 * f64::from(n) * f64::EPSILON, "{number} {n}: {off:e}");
            if number > 1e-200 {
                let exact = Twofold::from(number) / 3.0;
                let off = f64::from(power(root(exact, n), n) / exact - 1.0);
                assert!(off.abs() <= 1e-29, "{number} {n}: {off:e}");
            }
        }
    }

    #[test]
    fn roots_of_zero_and_nan_are_these() {
        assert_eq!(root(0.0, 5), 0.0);
        assert!(root(f64::NAN, 5).is_nan());
        assert!(Real::is_nan(root(Twofold::NAN, 5)));
    }
}
