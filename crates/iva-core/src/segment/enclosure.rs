//! Bounds on a function over a stretch, from both ends.

use crate::number::real::Real;

/// Bounds on a function over a stretch and on its rate, from both at both ends and a bound on the fourth
/// derivative: by the Bernstein coefficients of the cubic between them and its error, as in
/// [`crate::segment::roots`].
pub(crate) struct Enclosure<R = f64> {
    pub low: R,
    pub high: R,
    slowest: R,
    fastest: R,
}

impl<R: Real> Enclosure<R> {
    #[inline(always)]
    pub fn new(values: [R; 2], rates: [R; 2], length: R, fourth: R) -> Self {
        let ([begin, end], [rate, rate_end]) = (values, rates);
        let third = length * (1.0 / 3.0);
        let inner = [begin + third * rate, end - third * rate_end];
        let middle = (end - begin) * 3.0 / length - (rate + rate_end);
        let cube = fourth * (length * length * length);
        // 1/384, and √3/216.
        let (off, rate_off) = (cube * length * (1.0 / 384.0), cube * 8.1e-3);
        let smallest = |a: R, b: R| -R::larger(-a, -b);
        Self {
            low: smallest(smallest(begin, end), smallest(inner[0], inner[1])) - off,
            high: R::larger(R::larger(begin, end), R::larger(inner[0], inner[1])) + off,
            slowest: smallest(smallest(rate, rate_end), middle) - rate_off,
            fastest: R::larger(R::larger(rate, rate_end), middle) + rate_off,
        }
    }

    /// True if it rises all the way, by more than the doubt about its rate.
    #[inline(always)]
    pub fn rises(&self, doubt: R) -> bool {
        self.slowest > doubt
    }

    /// True if it falls all the way, by more than the doubt about its rate.
    #[inline(always)]
    pub fn falls(&self, doubt: R) -> bool {
        self.fastest < -doubt
    }
}
