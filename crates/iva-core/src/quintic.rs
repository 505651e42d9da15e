//! The quintic between two jets: its range, how far off it is, and where it has its root, without branches.
//!
//! A quintic H has value, slope and half the second derivative of a function f at both ends of [0, 1]. With M a bound on
//! f⁽⁶⁾ (G. Birkhoff and A. Priver, J. Math. Phys. 46, 1967)
//!
//! ```text
//! |f − H| ≤ M/46080,    |f′ − H′| ≤ M √5/30000,    |f″ − H″| ≤ M/1920.
//! ```
//!
//! H lies within the range of its Bernstein coefficients, H′ within five times that of their differences and H″ within
//! twenty times that of their second differences.

use crate::real::Real;

/// 1/46080: how far the quintic is off, over M;
pub(crate) const OFF: f64 = 1.0 / 46080.0;
/// √5/30000: its slope,
pub(crate) const SLOPE_OFF: f64 = 7.454e-5;
/// 1/1920: and its second derivative.
pub(crate) const BEND_OFF: f64 = 1.0 / 1920.0;

/// The Bernstein coefficients of the quintic.
#[inline(always)]
pub(crate) fn bernstein<R: Real>(begin: &[R; 3], end: &[R; 3]) -> [R; 6] {
    let ([f, g, k], [u, v, w]) = (*begin, *end);
    [f, f + g * 0.2, f + (g * 0.4 + k * 0.1), u - (v * 0.4 - w * 0.1), u - v * 0.2, u]
}

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
