//! Distributions of one parameter, evaluated by their quantiles.

use super::normal::{Interval, quantile};

/// Distribution of one parameter. Bounds truncate it: between them the density is scaled to probability 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// Uniform between two bounds.
    Uniform {
        /// Least value, finite.
        low: f64,
        /// Greatest value, finite; at least `low`.
        high: f64,
    },
    /// Normal, truncated to the bounds.
    Normal {
        /// Mean before truncation, finite.
        mean: f64,
        /// Standard deviation before truncation, finite and greater than 0.
        deviation: f64,
        /// Least value; −∞ for no bound.
        low: f64,
        /// Greatest value, at least `low`; ∞ for no bound.
        high: f64,
    },
    /// Log-normal: the logarithm is normal with mean ln `median` and standard deviation `sigma`.
    LogNormal {
        /// Median before truncation, finite and greater than 0.
        median: f64,
        /// Standard deviation of the logarithm before truncation, finite and greater than 0.
        sigma: f64,
        /// Least value; 0 or less for no bound.
        low: f64,
        /// Greatest value, greater than 0 and at least `low`; ∞ for no bound.
        high: f64,
    },
}

/// The error for parameters of a distribution that are out of range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{field} = {value}: {allowed}")]
pub struct Unfit {
    /// The name of the parameter, as in [`Distribution`].
    pub field: &'static str,
    /// The value of that parameter.
    pub value: f64,
    /// The range that is allowed.
    pub allowed: &'static str,
}

impl Distribution {
    /// Checks that its parameters are within their ranges.
    ///
    /// # Errors
    /// [`Unfit`] with the first that is not.
    pub fn check(&self) -> Result<(), Unfit> {
        const FINITE: &str = "give a finite number";
        const POSITIVE: &str = "give a finite number greater than 0";
        const LOW: &str = "give less than infinity, or nothing";
        const HIGH: &str = "give `low` or greater";
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let require = |holds, field, value, allowed| {
            if holds { Ok(()) } else { Err(Unfit { field, value, allowed }) }
        };
        match *self {
            Self::Uniform { low, high } => {
                require(low.is_finite(), "low", low, FINITE)?;
                require(high >= low, "high", high, HIGH)?;
                require((high - low).is_finite(), "high", high, "give a finite range")
            }
            Self::Normal { mean, deviation, low, high } => {
                require(mean.is_finite(), "mean", mean, FINITE)?;
                require(positive(deviation), "deviation", deviation, POSITIVE)?;
                require(low < f64::INFINITY, "low", low, LOW)?;
                require(high >= low && high > f64::NEG_INFINITY, "high", high, HIGH)
            }
            Self::LogNormal { median, sigma, low, high } => {
                require(positive(median), "median", median, POSITIVE)?;
                require(positive(sigma), "sigma", sigma, POSITIVE)?;
                require(low < f64::INFINITY, "low", low, LOW)?;
                require(high >= low, "high", high, HIGH)?;
                require(high > 0.0, "high", high, "give more than 0")
            }
        }
    }

    /// The quantile of `u`, 0 ≤ `u` < 1: the value below which the probability is `u`. Always within the
    /// bounds; finite for 0 < `u`, and the lower end of the distribution for `u` = 0.
    ///
    /// It increases with `u` apart from rounding: 2⁻⁴⁹ of the largest of value, deviation and mean, or of the
    /// bound next to the mean if the mean is excluded; for a log-normal value, 2⁻⁵⁰ of it times 1 +
    /// |ln(value/median)|. Meaningless, but without panic, for parameters that [`check`](Self::check)
    /// rejects.
    pub fn quantile(&self, u: f64) -> f64 {
        match *self {
            Self::Uniform { low, high } => confined(low + u * (high - low), low, high),
            Self::Normal { low, .. } if u <= 0.0 => low,
            Self::Normal { mean, deviation, low, high } => {
                let (origin, steps) = quantile(
                    u,
                    &Interval {
                        low: (low - mean) / deviation,
                        high: (high - mean) / deviation,
                        width: (high - low) / deviation,
                    },
                );
                confined(origin.of(low, mean, high) + deviation * steps, low, high)
            }
            Self::LogNormal { low, .. } if u <= 0.0 => low.max(0.0),
            Self::LogNormal { median, sigma, low, high } => {
                let low = low.max(0.0);
                let (origin, steps) = quantile(
                    u,
                    &Interval {
                        low: log_ratio(low, median) / sigma,
                        high: log_ratio(high, median) / sigma,
                        width: log_ratio(high, low) / sigma,
                    },
                );
                confined(origin.of(low, median, high) * libm::exp(sigma * steps), low, high)
            }
        }
    }
}

/// A value limited to the bounds, which rounding may exceed, and to finite numbers.
fn confined(value: f64, low: f64, high: f64) -> f64 {
    value.max(low).min(high).clamp(f64::MIN, f64::MAX)
}

/// ln(a/b) for 0 ≤ a, b ≤ ∞.
fn log_ratio(a: f64, b: f64) -> f64 {
    let ratio = a / b;
    if ratio.is_normal() { libm::log(ratio) } else { libm::log(a) - libm::log(b) }
}

#[cfg(test)]
mod tests {
    use super::super::philox::{Stream, Use};
    use super::super::uniform;
    use super::*;

    const INFINITY: f64 = f64::INFINITY;
    /// The last number below 1.
    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;

    /// The four parameters of a distribution, and some of its quantiles.
    type Known<'a> = ([f64; 4], &'a [(f64, f64)]);

    /// Compares quantiles with known ones, within `units` of 2⁻⁵³.
    fn compare(known: &[Known], units: f64, distribution: impl Fn([f64; 4]) -> Distribution) {
        for (numbers, quantiles) in known {
            let distribution = distribution(*numbers);
            assert_eq!(distribution.check(), Ok(()));
            for (u, expected) in *quantiles {
                let x = distribution.quantile(*u);
                let error = (x - expected) / expected * 2f64.powi(53);
                assert!(error.abs() < units, "{distribution:?} at {u}: {x}, off by {error} units");
            }
        }
    }

    fn normal([mean, deviation, low, high]: [f64; 4]) -> Distribution {
        Distribution::Normal { mean, deviation, low, high }
    }

    fn log_normal([median, sigma, low, high]: [f64; 4]) -> Distribution {
        Distribution::LogNormal { median, sigma, low, high }
    }

    /// Computed from the defining integrals with mpmath 1.4.1, 330 digits. `norm.ppf` of scipy 1.17.1 agrees
    /// to 2 units; `truncnorm.ppf` does too, except near 0, where it has fewer digits.
    #[test]
    #[rustfmt::skip]
    fn normal_quantiles() {
        compare(&[
            ([0.0, 1.0, -INFINITY, INFINITY], &[(1e-300, -37.0470962993612),
                (1e-20, -9.262340089798407), (1e-05, -4.264890793922825),
                (0.025, -1.9599639845400543), (0.3, -0.5244005127080408),
                (0.4999, -0.00025066283008800747), (0.5001, 0.00025066283008800747),
                (0.75, 0.6744897501960817), (0.999, 3.090232306167813), (LAST, 8.209536151601387)]),
            ([0.0, 1.0, 0.0, INFINITY], &[(1e-300, 1.2533141373155002e-300),
                (1e-12, 1.2533141373155002e-12), (0.5, 0.6744897501960817),
                (0.999, 3.2905267314918945)]),
            ([0.0, 1.0, -1.0, 2.0], &[(1e-12, -0.9999999999966169), (0.3, -0.24240381788922682),
                (0.9, 1.2557153641502152), (LAST, 1.9999999999999982)]),
            ([0.0, 1.0, 40.0, INFINITY], &[(1e-09, 40.00000000002498), (0.5, 40.01731412676465),
                (LAST, 40.907563906503476)]),
            ([0.0, 1.0, -1000000.0, -100000.0], &[(1e-09, -100000.00020723266),
                (0.5, -100000.00000693147), (0.75, -100000.00000287683)]),
            ([0.0, 1.0, 8.0, 8.0001], &[(0.001, 8.000000099960051), (0.5, 8.000049989999937),
                (0.999, 8.000099899960029)]),
            ([-5.0, 1.0, 0.0, 1e-06], &[(1e-09, 9.999975000040024e-16),
                (0.25, 2.4999953125035153e-07), (0.999, 9.989999975024955e-07)]),
            ([1000000.0, 1.0, 0.0, 0.001], &[(1e-09, 0.0009792767341425658),
                (0.25, 0.0009986137056374961), (0.999, 0.0009999989994996655)]),
        ], 16.0, normal);
    }

    /// Computed as in [`normal_quantiles`]; `lognorm.ppf` of scipy 1.17.1 agrees to 32 units.
    #[test]
    #[rustfmt::skip]
    fn log_normal_quantiles() {
        compare(&[
            ([2.0, 0.5, 0.0, INFINITY], &[(1e-300, 1.804493196562424e-08),
                (0.01, 0.6249855456579326), (0.5, 2.0), (0.99, 6.400148015885924)]),
            ([2.0, 0.5, 1.0, 3.0], &[(1e-09, 1.0000000023211153), (0.5, 1.847691547304942),
                (0.999, 2.9963051374094176)]),
            ([1.0, 0.1, 50.0, INFINITY], &[(1e-09, 50.00000000012773), (0.5, 50.08859252730227),
                (0.999, 50.88812918334601)]),
            ([1.0, 0.1, 0.0, 0.02], &[(1e-300, 0.004536283031704306), (0.5, 0.01996462566711014)]),
        ], 32.0, log_normal);
    }

    #[test]
    fn uniform_quantiles() {
        let distribution = Distribution::Uniform { low: -3.0, high: 5.0 };
        assert_eq!([0.0, 0.25, 0.875].map(|u| distribution.quantile(u)), [-3.0, -1.0, 4.0]);
    }

    /// Bounds of every size, from deep in one tail to deep in the other, in random distributions.
    fn wild(number: u64) -> Distribution {
        let random = Stream::new(number, 0, Use::Coordinates);
        let part = |n| uniform(random.word(n));
        let size = |n| 10f64.powf(16.0 * part(n) - 8.0);
        let sign = |n| if random.word(n).is_multiple_of(2) { 1.0 } else { -1.0 };
        let width = if number.is_multiple_of(5) { INFINITY } else { size(0) };
        if number.is_multiple_of(2) {
            let low = if number.is_multiple_of(3) { -INFINITY } else { sign(1) * size(2) };
            let high = if low.is_finite() { low + width } else { sign(1) * size(2) };
            normal([sign(3) * size(4), size(5), low, high])
        } else {
            let low = if number.is_multiple_of(3) { 0.0 } else { size(2) };
            log_normal([size(3), 10f64.powf(4.0 * part(4) - 3.0), low, low + width])
        }
    }

    /// The values of `u` are too far apart for rounding to change their order.
    #[test]
    fn quantiles_rise_within_the_bounds() {
        for number in 0..2000 {
            let distribution = wild(number);
            assert_eq!(distribution.check(), Ok(()));
            let (Distribution::Uniform { low, high }
            | Distribution::Normal { low, high, .. }
            | Distribution::LogNormal { low, high, .. }) = distribution;
            let random = Stream::new(number, 1, Use::Coordinates);
            let mut parts: Vec<f64> = random.words().take(200).map(uniform).collect();
            parts.sort_by(f64::total_cmp);
            let values = parts.iter().map(|u| distribution.quantile(*u));
            assert!(values.is_sorted(), "{distribution:?}");
            for u in parts.into_iter().chain([f64::MIN_POSITIVE, 1e-300, 1e-20, LAST]) {
                let x = distribution.quantile(u);
                assert!(x.is_finite() && low <= x && x <= high, "{distribution:?} at {u}: {x}");
            }
        }
    }

    #[test]
    fn the_lower_end_is_the_quantile_of_nothing() {
        assert_eq!(normal([0.0, 1.0, -INFINITY, 1.0]).quantile(0.0), -INFINITY);
        assert_eq!(normal([0.0, 1.0, -9.0, 1.0]).quantile(0.0), -9.0);
        assert_eq!(log_normal([1.0, 1.0, -INFINITY, INFINITY]).quantile(0.0), 0.0);
        assert_eq!(normal([0.0, 1.0, 2.0, 2.0]).quantile(0.3), 2.0);
    }

    /// Quantiles stay finite for the most extreme bounds and parameters.
    #[test]
    fn extremes_stay_finite() {
        for distribution in [
            normal([0.0, f64::MIN_POSITIVE, 1.0, INFINITY]),
            normal([0.0, f64::MAX, -INFINITY, INFINITY]),
            normal([-f64::MAX, 1.0, f64::MAX, INFINITY]),
            log_normal([f64::MAX, 1e3, 0.0, INFINITY]),
            log_normal([f64::MIN_POSITIVE, 1e-300, f64::MAX, INFINITY]),
        ] {
            assert_eq!(distribution.check(), Ok(()));
            for u in [f64::MIN_POSITIVE, 1e-9, 0.5, LAST] {
                let x = distribution.quantile(u);
                assert!(x.is_finite(), "{distribution:?} at {u}: {x}");
            }
        }
    }

    #[test]
    fn unfit_numbers_are_named() {
        let field = |distribution: Distribution| distribution.check().unwrap_err().field;
        assert_eq!(field(Distribution::Uniform { low: 1.0, high: 0.0 }), "high");
        assert_eq!(field(normal([f64::NAN, 1.0, 0.0, 1.0])), "mean");
        assert_eq!(field(normal([0.0, 1.0, f64::NAN, 1.0])), "low");
        assert_eq!(field(log_normal([0.0, 1.0, 0.0, 1.0])), "median");
        assert_eq!(field(log_normal([1.0, INFINITY, 0.0, 1.0])), "sigma");
        assert_eq!(field(log_normal([1.0, 1.0, -2.0, -1.0])), "high");
        let text = normal([0.0, -1.0, 0.0, 1.0]).check().unwrap_err().to_string();
        assert_eq!(text, "deviation = -1: give a finite number greater than 0");
    }
}
