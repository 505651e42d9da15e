//! The quintic Hermite interpolant of a function: its range, its error, and its root, without branches.
//!
//! The quintic H has the value, slope and half the second derivative of f at both ends of [0, 1]. With M a
//! bound on f⁽⁶⁾ (G. Birkhoff and A. Priver, J. Math. Phys. 46, 1967)
//!
//! ```text
//! |f − H| ≤ M/46080,    |f′ − H′| ≤ M √5/30000,    |f″ − H″| ≤ M/1920.
//! ```
//!
//! H lies within the range of its Bernstein coefficients, H′ within five times that of their differences and
//! H″ within twenty times that of their second differences.

use crate::number::real::Real;

/// 1/46080: bound on the error of the quintic, over M.
pub(crate) const OFF: f64 = 1.0 / 46080.0;
/// √5/30000: bound on the error of its slope, over M.
pub(crate) const SLOPE_OFF: f64 = 7.454e-5;
/// 1/1920: bound on the error of its second derivative, over M.
pub(crate) const BEND_OFF: f64 = 1.0 / 1920.0;

/// The Bernstein coefficients of the quintic from value, slope and half the second derivative at both ends.
#[inline(always)]
pub(crate) fn bernstein<R: Real>(begin: &[R; 3], end: &[R; 3]) -> [R; 6] {
    let ([f, g, k], [u, v, w]) = (*begin, *end);
    let times = |a: R, factor: f64, b: R| a.mul_add(R::from(factor), b);
    let (second, fourth) = (times(g, 0.4, f), times(v, -0.4, u));
    [f, times(g, 0.2, f), times(k, 0.1, second), times(w, 0.1, fourth), times(v, -0.2, u), u]
}

/// The coefficients of the quintic in powers of t, from value, slope and half the second derivative at both
/// ends.
#[inline(always)]
pub(crate) fn monomials<R: Real>(begin: &[R; 3], end: &[R; 3]) -> [R; 6] {
    let ([f, g, k], [u, v, w]) = (*begin, *end);
    let times = |a: R, factor: f64, b: R| a.mul_add(R::from(factor), b);
    let (p, q, r) = ((u - f) - (g + k), times(k, -2.0, v - g), w - k);
    let (cube, fourth, fifth) = (times(q, -4.0, r), times(r, -2.0, q * 7.0), times(q, -3.0, r));
    [f, g, k, times(p, 10.0, cube), times(p, -15.0, fourth), times(p, 6.0, fifth)]
}

/// An approximation of the only root of a quintic on [0, 1]: two steps of Halley's method from the root of
/// the chord.
#[inline(always)]
pub(crate) fn root<R: Real>(c: &[R; 6]) -> R {
    root_by(c, |a, b| a / b)
}

/// [`root`] with quotients computed by `over`.
#[inline(always)]
pub(crate) fn root_by<R: Real>(c: &[R; 6], over: impl Fn(R, R) -> R) -> R {
    let last = (c[1] + c[2]) + (c[3] + c[4]) + c[5];
    let rates = [c[1], c[2] * 2.0, c[3] * 3.0, c[4] * 4.0, c[5] * 5.0];
    let bends = [rates[1], rates[2] * 2.0, rates[3] * 3.0, rates[4] * 4.0];
    let mut t = over(c[0], -last);
    for _ in 0..2 {
        let f = |sum: R, term: R| sum.mul_add(t, term);
        let value = f(f(f(f(f(c[5], c[4]), c[3]), c[2]), c[1]), c[0]);
        let slope = f(f(f(f(rates[4], rates[3]), rates[2]), rates[1]), rates[0]);
        let bend = f(f(f(bends[3], bends[2]), bends[1]), bends[0]);
        let double = slope + slope;
        t -= over(value * double, double.mul_add(slope, -(value * bend)));
    }
    t
}
