//! Sine and cosine, and the angle that has them, to the precision of a number type, at most double-double.

use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::number::series::Number;

/// 1/6 as a double-double: high and low part.
const SIXTH: [f64; 2] = [1.0 / 6.0, 9.251_858_538_542_97e-18];

/// Sine and cosine of an angle within [−π, π] with errors of some 2⁻⁶⁰, without branches: from their series
/// within a quarter turn, the leading two terms in double-double.
#[inline(always)]
pub fn close_sine_cosine<R: Real>(angle: DoubleDouble<R>) -> (DoubleDouble<R>, DoubleDouble<R>) {
    /// The coefficients 1/5!, −1/7!, … of the sine.
    const SINE: [f64; 8] = factorials(5);
    /// The coefficients 1/4!, −1/6!, … of the cosine.
    const COSINE: [f64; 9] = factorials(4);
    let quarter = (angle.value * std::f64::consts::FRAC_2_PI).round();
    let small = angle - R::QUARTER.times(quarter);
    let square = small.product(small);
    let z = square.value;
    let series = |terms: &[f64]| {
        terms.iter().rev().fold(R::ZERO, |sum, term| sum.mul_add(z, R::from(*term)))
    };
    let sixth = square.product(DoubleDouble { value: R::from(SIXTH[0]), rest: R::from(SIXTH[1]) });
    let bent = DoubleDouble::new(z * z * series(&SINE)) - sixth;
    let sine = small.plus_both(small.product(bent), DoubleDouble::ZERO);
    let cosine = DoubleDouble::new(R::ONE)
        .plus_both(-square.half(), DoubleDouble::new(z * z * series(&COSINE)));
    let turned = quarter.abs() == 1.0;
    let (s, c) = (pick(turned, cosine, sine), pick(turned, sine, cosine));
    let (down, left) = ((quarter == -1.0) | (quarter.abs() == 2.0), quarter.abs() == 2.0);
    let left = left | (quarter == 1.0);
    (pick(down, -s, s), pick(left, -c, c))
}

/// Sine and cosine of an angle within [−π, π] with errors of about a unit in the last place, without branches:
/// from their series within a quarter turn.
#[inline(always)]
pub fn plain_sine_cosine<R: Real>(angle: DoubleDouble<R>) -> (R, R) {
    /// The coefficients −1/3!, 1/5!, … of the sine.
    const SINE: [f64; 9] = negated(factorials(3));
    /// The coefficients −1/2!, 1/4!, … of the cosine.
    const COSINE: [f64; 9] = negated(factorials(2));
    let quarter = (angle.value * std::f64::consts::FRAC_2_PI).round();
    let small = (-quarter).mul_add(R::QUARTER.value, angle.value)
        + (-quarter).mul_add(R::QUARTER.rest, angle.rest);
    let z = small * small;
    let series = |terms: &[f64]| {
        terms.iter().rev().fold(R::ZERO, |sum, term| sum.mul_add(z, R::from(*term)))
    };
    let sine = small.mul_add(z * series(&SINE), small);
    let cosine = z.mul_add(series(&COSINE), R::ONE);
    let turned = quarter.abs() == 1.0;
    let (s, c) = if turned { (cosine, sine) } else { (sine, cosine) };
    let (down, left) = ((quarter == -1.0) | (quarter.abs() == 2.0), quarter.abs() == 2.0);
    let left = left | (quarter == 1.0);
    (if down { -s } else { s }, if left { -c } else { c })
}

/// The angle within [−π/2, π/2] that has this sine and cosine, whose squares sum to 1, with an error of about a unit in the
/// last place. In doubles it has no branches.
#[inline(always)]
pub fn plain_angle<R: Real>(sine: R, cosine: R) -> R {
    close_angle(DoubleDouble::new(sine), DoubleDouble::new(cosine)).value
}

/// The angle within [−π/2, π/2] that has this sine and cosine, whose squares sum to 1. In doubles its error is at most
/// 2⁻⁵⁷ of the angle: one step of Newton's method from an angle in plain numbers.
#[inline(always)]
pub fn close_angle<R: Real>(sine: DoubleDouble<R>, cosine: DoubleDouble<R>) -> DoubleDouble<R> {
    let near = DoubleDouble::new(rough_angle(sine.value, cosine.value));
    let (s, c) = R::precise_sincos(near);
    // The sine of what is left.
    near + (sine * c - cosine * s)
}

/// The angle that has this sine and cosine with an error of some units in the last place: 8 arctan(tan θ/8) by the series
/// of the arctangent; in numbers finer than doubles, which have more digits than that series, by their own function.
#[inline(always)]
fn rough_angle<R: Real>(sine: R, cosine: R) -> R {
    /// The coefficients −1/3, 1/5, … of the arctangent.
    const TERMS: [f64; 11] = odd_reciprocals();
    if R::EPSILON < 1e-17 {
        return R::atan2(sine, cosine);
    }
    let halved = |tangent: R| tangent / (R::ONE + tangent.mul_add(tangent, R::ONE).sqrt());
    let eighth = halved(halved(sine / (R::ONE + cosine)));
    let z = eighth * eighth;
    let series = TERMS.iter().rev().fold(R::ZERO, |sum, term| sum.mul_add(z, R::from(*term)));
    eighth.mul_add(z * series, eighth) * 8.0
}

/// The numbers −1/3, 1/5, −1/7, ….
const fn odd_reciprocals<const K: usize>() -> [f64; K] {
    let mut terms = [0.0; K];
    let mut k = 0;
    while k < K {
        let term = 1.0 / (2 * k + 3) as f64;
        terms[k] = if k % 2 == 0 { -term } else { term };
        k += 1;
    }
    terms
}

pub(crate) const fn negated<const K: usize>(mut terms: [f64; K]) -> [f64; K] {
    let mut k = 0;
    while k < K {
        terms[k] = -terms[k];
        k += 1;
    }
    terms
}

#[inline(always)]
fn pick<R: Real>(which: bool, yes: DoubleDouble<R>, no: DoubleDouble<R>) -> DoubleDouble<R> {
    let one = |yes: R, no: R| if which { yes } else { no };
    DoubleDouble { value: one(yes.value, no.value), rest: one(yes.rest, no.rest) }
}

/// The coefficients 1/n!, −1/(n+2)!, 1/(n+4)!, ….
pub(crate) const fn factorials<const K: usize>(n: usize) -> [f64; K] {
    let mut terms = [0.0; K];
    let (mut k, mut factorial, mut i) = (0, 1.0, 1);
    while k < K {
        while i <= n + 2 * k {
            factorial *= i as f64;
            i += 1;
        }
        terms[k] = if k % 2 == 0 { 1.0 / factorial } else { -1.0 / factorial };
        k += 1;
    }
    terms
}

/// Sine and cosine of an angle within [−2π, 2π], from the series at a 64th of the angle and six doublings.
pub fn sine_cosine<R: Real, T: Number<Real = R>>(angle: T) -> (T, T) {
    const HALVINGS: u32 = 6;
    let one = T::reciprocal(1);
    let two = one + one;
    let small = (0..HALVINGS).fold(angle, |angle, _| angle * T::reciprocal(2));
    let square = small * small;
    let (mut versine, mut sine) = (T::from_real(R::ZERO), T::from_real(R::ZERO));
    for k in (1..=9).rev() {
        let n = 2 * k;
        versine = ((one - versine) * square) * T::reciprocal(n * (n - 1));
        sine = ((one - sine) * square) * T::reciprocal(n * (n + 1));
    }
    sine = small * (one - sine);
    for _ in 0..HALVINGS {
        // sin 2α = 2 sinα (1 − (1 − cosα)), 1 − cos 2α = 2 sin²α
        let twice = (sine * (one - versine)) * two;
        versine = (sine * sine) * two;
        sine = twice;
    }
    (sine, one - versine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::compensated::DoubleDouble;

    /// The angle that a sine and a cosine were computed from.
    #[test]
    fn an_angle_is_found_from_its_sine_and_cosine() {
        let quarter = DoubleDouble::new(std::f64::consts::FRAC_PI_2);
        let mut worst = [0.0f64; 2];
        for k in -3000..=3000 {
            let share = f64::from(k) / 3000.0;
            // Small ones too.
            for angle in [quarter.times(share), quarter.times(share.powi(15))] {
                let (s, c) = sine_cosine(angle);
                let (plain, close) = (plain_angle(s.value, c.value), close_angle(s, c));
                let size = angle.value.abs().max(f64::MIN_POSITIVE);
                worst[0] = worst[0].max(angle.minus(plain).abs() / size);
                worst[1] = worst[1].max((close - angle).value.abs() / size);
            }
        }
        assert!(worst[0] <= 3e-16 && worst[1] <= 7e-18, "{worst:?}");
    }

    #[test]
    fn plain_sine_and_cosine_are_off_by_a_unit_in_the_last_place_at_most() {
        // Judged by the series in double-double, whose errors are some 2⁻⁶⁰.
        for k in -4000..=4000 {
            let angle = DoubleDouble::new(std::f64::consts::PI).times(f64::from(k) / 4000.0);
            let (s, c) = plain_sine_cosine(angle);
            let (sine, cosine) = close_sine_cosine(angle);
            let off = sine.minus(s).abs().max(cosine.minus(c).abs());
            assert!(off <= 1.2e-16, "{}: {off:e}", angle.value);
        }
    }
}
