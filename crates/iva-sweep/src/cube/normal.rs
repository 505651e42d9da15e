//! Quantiles of the standard normal distribution within an interval, however narrow or far out.
//!
//! The part of probability beyond x falls as exp(−H(x)), with H the cumulative hazard: of the
//! quantile H is known, and is inverted. Nothing underflows or cancels where the density has, since
//! the hazard is 1/m(x) with Mills' ratio m(x) = (1 − Φ(x))/φ(x), which falls no faster than 1/x.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use libm::{erf, erfc, exp, expm1, log, log1p};

/// Below this, a cumulative hazard is summed as a series.
const SMALL: f64 = 0.25;
/// Most terms of that series.
const TERMS: u32 = 32;
/// Terms that small, two in a row, end it: it begins with 1.
const NEGLIGIBLE: f64 = 0.125 * f64::EPSILON;
/// From here Mills' ratio is a continued fraction, of this many levels in double precision.
const FAR: f64 = 8.0;
const LEVELS: u32 = 12;
/// Most steps towards a quantile; two or three are enough.
const STEPS: u32 = 20;
/// The steps converge cubically: behind one that small there is nothing left to mend.
const SMALL_STEP: f64 = 1e-6;
/// √(π/2)
const MILLS_RATIO_AT_0: f64 = 1.253_314_137_315_500_1;
/// Tails that begin further out are taken to begin here: its square is finite.
const FARTHEST: f64 = 1e150;

/// An interval in standard deviations from the mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    pub(super) low: f64,
    pub(super) high: f64,
    /// high − low, without cancellation.
    pub(super) width: f64,
}

/// What a distance is measured from.
#[derive(Debug, Clone, Copy)]
pub(super) enum Origin {
    Low,
    Mean,
    High,
}

impl Origin {
    /// The one of three values.
    pub(super) fn of(self, low: f64, mean: f64, high: f64) -> f64 {
        match self {
            Self::Low => low,
            Self::Mean => mean,
            Self::High => high,
        }
    }
}

/// The quantile of 0 < `u` < 1 of the normal distribution within an interval: from which of its
/// low end, the mean and its high end it can be told best, and how far from there it is.
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

/// The quantile of an interval about the mean, its ends in √2 standard deviations: twice the
/// probability between it and the mean, and beyond it, are those of |x|.
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

/// How far from the near end of an interval in a tail the part `within` of its probability ends,
/// of which `beyond` = 1 − `within` is left.
fn into_tail(near: f64, width: f64, within: f64, beyond: f64) -> f64 {
    let tail = Tail::new(near.min(FARTHEST));
    let all = tail.cumulative_hazard(width, mills_ratio(tail.near + width));
    let total = -expm1(-all);
    tail.distance(hazard(within * total, exp(-all) + beyond * total))
}

/// The cumulative hazard where probability 1 divides into what is passed and what is left, by the
/// one of them that is known to more digits.
fn hazard(passed: f64, left: f64) -> f64 {
    const LEAST: f64 = f64::MIN_POSITIVE * f64::EPSILON;
    if passed < 0.5 { -log1p(-passed) } else { -log(left.max(LEAST)) }
}

/// The normal distribution beyond a place.
struct Tail {
    /// The place, 0 or greater.
    near: f64,
    /// Mills' ratio there.
    mills_ratio: f64,
}

impl Tail {
    /// Half of the distribution.
    const HALF: Self = Self { near: 0.0, mills_ratio: MILLS_RATIO_AT_0 };

    fn new(near: f64) -> Self {
        Self { near, mills_ratio: mills_ratio(near) }
    }

    /// How far into the tail the cumulative hazard from its beginning is `wanted`, by Halley's
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

    /// −ln((1 − Φ(near + distance))/(1 − Φ(near))), with Mills' ratio at that distance.
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
        // The square of half the digits is exact; that of x would lose those of exp(x²).
        let half = f64::from(x as f32);
        exp(half * half) * exp((x - half) * (x + half)) * erfc(x)
    } else {
        // Laplace's continued fraction: M. Abramowitz and I. A. Stegun, Handbook of Mathematical
        // Functions (1964), 7.1.14.
        let levels = (1..=LEVELS).rev().map(|level| 0.5 * f64::from(level));
        1.0 / (PI.sqrt() * levels.fold(x, |tail, numerator| x + numerator / tail))
    }
}
