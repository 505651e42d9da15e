//! The quintic between two jets: where it has its root, without branches.

use crate::real::Real;

/// The coefficients of a quintic on [0, 1] from value, slope and half the second derivative at both ends.
#[inline(always)]
pub(crate) fn monomials<R: Real>(begin: &[R; 3], end: &[R; 3]) -> [R; 6] {
    let ([f, g, k], [u, v, w]) = (*begin, *end);
    let (p, q, r) = (u - f - g - k, v - g - k * 2.0, w - k);
    [f, g, k, p * 10.0 - q * 4.0 + r, q * 7.0 - p * 15.0 - r * 2.0, p * 6.0 - q * 3.0 + r]
}

/// Close to the only root of a quintic on [0, 1]: Halley's method from its chord.
#[inline(always)]
pub(crate) fn root<R: Real>(c: &[R; 6]) -> R {
    let last = c[0] + c[1] + c[2] + c[3] + c[4] + c[5];
    let mut t = c[0] / (c[0] - last);
    for _ in 0..2 {
        let value = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
        let slope =
            c[1] + t * (c[2] * 2.0 + t * (c[3] * 3.0 + t * (c[4] * 4.0 + t * (c[5] * 5.0))));
        let bend = c[2] * 2.0 + t * (c[3] * 6.0 + t * (c[4] * 12.0 + t * (c[5] * 20.0)));
        t -= value * 2.0 * slope / (slope * 2.0 * slope - value * bend);
    }
    t
}
