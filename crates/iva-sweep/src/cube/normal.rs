//! Quantiles of the standard normal distribution within an interval, however narrow or far out.
//!
//! The probability beyond x decreases as exp(−H(x)), where H is the cumulative hazard. For a quantile H is
//! known, and is inverted. Nothing underflows or cancels as the density would: the hazard is 1/m(x) with
//! Mills' ratio m(x) = (1 − Φ(x))/φ(x), which decreases no faster than 1/x.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use libm::{erf, erfc, exp, expm1, log, log1p};

/// Exponent below which a cumulative hazard is summed as a series.
const SMALL: f64 = 0.25;
/// Largest number of terms of that series.
const TERMS: u32 = 32;
/// The series, which begins with 1, ends after two consecutive terms of this total size.
const NEGLIGIBLE: f64 = 0.125 * f64::EPSILON;
/// Argument from which Mills' ratio is computed as a continued fraction.
const FAR: f64 = 8.0;
/// Number of levels of that continued fraction, enough for double precision.
const LEVELS: u32 = 12;
/// Largest number of iterations for a quantile; two or three are enough.
const STEPS: u32 = 20;
/// Relative size of the last step: convergence is cubic, so the next one would be below rounding.
const SMALL_STEP: f64 = 1e-6;
/// Mills' ratio at 0: √(π/2)
const MILLS_RATIO_AT_0: f64 = 1.253_314_137_315_500_1;
/// Begin of the farthest tail: tails further out are treated as this one, so that squares stay finite.
const FARTHEST: f64 = 1e150;

/// An interval in standard deviations from the mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) high: f64,
    /// high − low, computed without cancellation.
    pub(super) width: f64,
}

/// The point that a distance is measured from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Origin {
    Low,
    Mean,
    High,
}

impl Origin {
    /// The value of the three that belongs to this origin.
    pub(super) fn of(self, low: f64, mean: f64, high: f64) -> f64 {
        match self {
            Self::Low => low,
            Self::Mean => mean,
            Self::High => high,
        }
    }
}

/// The quantile of 0 < `u` < 1 of the normal distribution within an interval: the origin from which it is
/// known most accurately (low end, mean or high end), and its distance from there.
pub(super) fn quantile(u: f64, interval: &Interval) -> (Origin, f64) {
    let Interval { low, high, width } = *interval;
    if low > 0.0 {
        (Origin::Low, into_tail(low, width, u, 1.0 - u))
    } else if high < 0.0 {
        (Origin::High, -into_tail(-high, width, 1.0 - u, u))
    } else {
        (Origin::Mean, about_mean(u, low * FRAC_1_SQRT_2, high * FRAC_1_SQRT_2))
    }
}

/// The quantile of an interval that contains the mean, with its ends in √2 standard deviations. Twice the
/// probabilities between the quantile and the mean, and beyond the quantile, are those of |x|.
fn about_mean(u: f64, low: f64, high: f64) -> f64 {
    let below = erf(-low);
    let total = below + erf(high);
    let signed = u * total - below;
    if signed < 0.0 {
        -Tail::HALF.distance(hazard(-signed, erfc(-low) + u * total))
    } else {
        Tail::HALF.distance(hazard(signed, erfc(high) + (1.0 - u) * total))
    }
}

/// The distance from the near end of an interval in a tail at which the share `within` of its probability is
/// reached; `beyond` = 1 − `within`.
fn into_tail(near: f64, width: f64, within: f64, beyond: f64) -> f64 {
    let tail = Tail::new(near.min(FARTHEST));
    let all = tail.cumulative_hazard(width, mills_ratio(tail.near + width));
    let total = -expm1(-all);
    tail.distance(hazard(within * total, exp(-all) + beyond * total))
}

/// The cumulative hazard where the probabilities passed and left add up to 1, from the one with more correct
/// digits.
fn hazard(passed: f64, left: f64) -> f64 {
    const LEAST: f64 = f64::MIN_POSITIVE * f64::EPSILON;
    if passed < 0.5 { -log1p(-passed) } else { -log(left.max(LEAST)) }
}

/// The normal distribution beyond a point.
struct Tail {
    /// The point, 0 or greater.
    near: f64,
    /// Mills' ratio at that point.
    mills_ratio: f64,
}

impl Tail {
    /// The upper half of the distribution.
    const HALF: Self = Self { near: 0.0, mills_ratio: MILLS_RATIO_AT_0 };

    fn new(near: f64) -> Self {
        Self { near, mills_ratio: mills_ratio(near) }
    }

    /// The distance into the tail at which the cumulative hazard from its begin is `wanted`, by Halley's
    /// method: the hazard h = 1/m has the derivative h (h − x).
    fn distance(&self, wanted: f64) -> f64 {
        let first = 1.0 / self.mills_ratio;
        let mut distance = 2.0 * wanted / (first + (first * first + 2.0 * wanted).sqrt());
        for _ in 0..STEPS {
            let x = self.near + distance;
            let mills_ratio = mills_ratio(x);
            let newton = (self.cumulative_hazard(distance, mills_ratio) - wanted) * mills_ratio;
            let step = newton / (1.0 - 0.5 * newton * (1.0 / mills_ratio - x));
            distance -= step;
            if step.abs() <= SMALL_STEP * distance {
                break;
            }
        }
        distance
    }

    /// −ln((1 − Φ(near + distance))/(1 − Φ(near))); the argument is Mills' ratio at that distance.
    fn cumulative_hazard(&self, distance: f64, mills_ratio: f64) -> f64 {
        let exponent = distance * (self.near + 0.5 * distance);
        if exponent < SMALL {
            -log1p(-relative_mass(self.near, distance) / self.mills_ratio)
        } else {
            exponent + log(self.mills_ratio / mills_ratio)
        }
    }
}

/// (Φ(near + distance) − Φ(near))/φ(near), the integral of exp(−near s − s²/2) from 0: by the
/// Taylor series of the integrand, whose coefficients k cₖ = −near cₖ₋₁ − cₖ₋₂.
fn relative_mass(near: f64, distance: f64) -> f64 {
    let (linear, square) = (near * distance, distance * distance);
    let (mut before, mut term, mut sum) = (0.0, 1.0, 1.0);
    for k in 1..TERMS {
        let next = -(linear * term + square * before) / f64::from(k);
        (before, term) = (term, next);
        sum += term / f64::from(k + 1);
        if term.abs() + before.abs() < NEGLIGIBLE {
            break;
        }
    }
    distance * sum
}

/// m(x) = (1 − Φ(x))/φ(x), for x ≥ 0.
fn mills_ratio(x: f64) -> f64 {
    MILLS_RATIO_AT_0 * scaled_erfc(x * FRAC_1_SQRT_2)
}

/// exp(x²) erfc(x), for x ≥ 0.
fn scaled_erfc(x: f64) -> f64 {
    if x < FAR {
        // The square of the rounded half is exact; the rounding of x² would spoil digits of exp(x²).
        let half = f64::from(x as f32);
        exp(half * half) * exp((x - half) * (x + half)) * erfc(x)
    } else {
        // Laplace's continued fraction: M. Abramowitz and I. A. Stegun, Handbook of Mathematical
        // Functions (1964), 7.1.14.
        let levels = (1..=LEVELS).rev().map(|level| 0.5 * f64::from(level));
        1.0 / (PI.sqrt() * levels.fold(x, |tail, numerator| x + numerator / tail))
    }
}
