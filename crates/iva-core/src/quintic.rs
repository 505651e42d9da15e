//! The quintic between two jets: where it has its root, without branches.

use crate::real::Real;

/// The coefficients of a quintic on [0, 1] from value, slope and half the second derivative at both ends.
#[inline(always)]
pub(crate) fn monomials(begin: &[Real; 3], end: &[Real; 3]) -> [Real; 6] {
    let ([f, g, k], [u, v, w]) = (*begin, *end);
    let (p, q, r) = (u - f - g - k, v - g - 2.0 * k, w - k);
    [f, g, k, 10.0 * p - 4.0 * q + r, 7.0 * q - 15.0 * p - 2.0 * r, 6.0 * p - 3.0 * q + r]
}

/// Close to the only root of a quintic on [0, 1]: Halley's method from its chord.
#[inline(always)]
pub(crate) fn root(c: &[Real; 6]) -> Real {
    let last = c[0] + c[1] + c[2] + c[3] + c[4] + c[5];
    let mut t = c[0] / (c[0] - last);
    for _ in 0..2 {
        let value = c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
        let slope =
            c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * (5.0 * c[5]))));
        let bend = 2.0 * c[2] + t * (6.0 * c[3] + t * (12.0 * c[4] + t * (20.0 * c[5])));
        t -= 2.0 * value * slope / (2.0 * slope * slope - value * bend);
    }
    t
}
