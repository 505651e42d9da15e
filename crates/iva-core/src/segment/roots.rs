//! The first zero of a smooth function, with a certificate.
//!
//! [`Searched::first_zero`] goes through exclude → isolate → refine → classify. Every decision uses the
//! function's values and derivatives at the ends of an interval of length L and a bound m₄ ≥ |f⁗| in between:
//!
//! * **leaving**: f, f′, f″ ≥ 0 at the left end and f‴ ≥ m₄ L: f grows on the whole interval;
//! * **curved one way**: |f″| > m₄L²/8 at both ends with one sign (error of linear interpolation), so a
//!   convex f has one minimum and a concave f lies above its chord;
//! * **excluded**: the Bernstein coefficients of the cubic Hermite interpolant exceed its error
//!   m₄L⁴/384, so f > 0;
//! * **monotone**: the coefficients of the interpolant's derivative exceed its error √3 m₄L³/216;
//! * otherwise the interval is halved, the left half first.
//!
//! (Error constants of Hermite interpolation: Birkhoff and Priver, J. Math. Phys. 46, 1967.)
//!
//! **Near zero.** Where f is so small that rounding could decide its sign, it is evaluated again in
//! double-double ([`Curve::precise`]).
//!
//! **What cannot be decided.** A minimum of f whose distance from zero is below the band given by the caller
//! is beyond the precision of the motion: it counts as no zero and is reported in [`Search::undecided`]. Only
//! minima are ever undecided; a transversal zero never is, nor is a function that stays 0.

use crate::number::real::Real;
use crate::segment::flight::{Curve, Jet};

/// A point of a curve: its time, and the jet of the function searched.
#[derive(Debug, Clone, Copy)]
pub struct Node<R = f64> {
    /// Time since the start of the motion.
    pub h: R,
    /// The function and its derivatives there.
    pub jet: Jet<R>,
}

/// The result of a search.
#[derive(Debug, Clone, Copy)]
pub struct Search<R = f64> {
    /// The first zero crossed downwards; `None` if there is none.
    pub zero: Option<Node<R>>,
    /// Number of minima within the band before the zero, or in the whole interval.
    pub undecided: u64,
}

/// The function to search: the curve's distance from a level, f = sign · (curve − level).
#[derive(Debug)]
pub struct Searched<'a, C: Curve> {
    /// The motion that is evaluated.
    pub curve: &'a C,
    /// The value of the curve at which f is 0.
    pub level: C::Real,
    /// +1 if f is positive above the level, −1 if below.
    pub sign: C::Real,
    /// Bound on the function's fourth derivative.
    pub fourth: C::Real,
    /// Half width of the band in which a minimum cannot be decided.
    pub band: C::Real,
    /// Bound on |f| at and below which rounding could decide the sign of a plain evaluation.
    pub doubt: C::Real,
}

/// Bound below which rounding could decide the sign of a plain evaluation, in units of 2⁻⁵³ of the curve's
/// magnitude. The terms of a cubic that stays within ±1 sum to at most 99 (Chebyshev's T₃ on a one-sided
/// interval), each with two or three roundings.
pub(crate) const DOUBT: f64 = 256.0;

/// Number of halvings after which f counts as constant on an interval: on 2⁻⁴⁸ of a stretch on which a series of
/// some 20 terms converges, f changes by less than its rounding.
const MAX_DEPTH: u32 = 48;

/// Number of halvings after which an interval on which f changes by less than the band counts as constant.
/// Before, such an interval may be a low rebound, which is decided by signs.
const FLAT_DEPTH: u32 = 8;

/// True if a function is 0 and changes in no order that is known.
fn rests<R: Real>(jet: &Jet<R>) -> bool {
    let Jet { value, rate, curvature, jerk } = *jet;
    value == 0.0 && rate == 0.0 && curvature == 0.0 && jerk == 0.0
}

impl<R: Real, C: Curve<Real = R>> Searched<'_, C> {
    /// f at a jet of the curve.
    #[inline]
    pub fn seen(&self, jet: &Jet<R>) -> Jet<R> {
        Jet {
            value: (jet.value - self.level) * self.sign,
            rate: jet.rate * self.sign,
            curvature: jet.curvature * self.sign,
            jerk: jet.jerk * self.sign,
        }
    }

    /// The node at h.
    #[inline]
    pub fn node(&self, h: R) -> Node<R> {
        Node { h, jet: self.seen(&self.curve.jet(h)) }
    }

    /// f at a node, evaluated in double-double where its sign is in doubt.
    pub(super) fn value(&self, node: &Node<R>) -> R {
        if node.jet.value.abs() > self.doubt {
            node.jet.value
        } else {
            self.curve.precise(node.h).minus(self.level) * self.sign
        }
    }

    /// True if f > 0 is proved on the whole interval by the Hermite–Bernstein bound alone.
    #[inline]
    pub fn excluded(&self, a: &Jet<R>, b: &Jet<R>, length: R) -> bool {
        let square = length * length;
        let error = (square * square) * self.fourth * (1.0 / 384.0);
        let b1 = a.value + length * a.rate * (1.0 / 3.0);
        let b2 = b.value - length * b.rate * (1.0 / 3.0);
        a.value.min(b1).min(b2).min(b.value) > error + self.doubt
    }

    /// The first zero crossed downwards on [a, b], where f(a) ≥ 0 apart from rounding.
    pub fn first_zero(&self, a: &Node<R>, b: &Node<R>) -> Search<R> {
        let mut undecided = 0;
        let zero = self.search(a, b, 0, &mut undecided);
        Search { zero, undecided }
    }

    fn search(&self, a: &Node<R>, b: &Node<R>, depth: u32, undecided: &mut u64) -> Option<Node<R>> {
        let length = b.h - a.h;
        let (fa, fb) = (&a.jet, &b.jet);
        let leaving = fa.value >= 0.0 && fa.rate >= 0.0 && fa.curvature >= 0.0;
        if leaving && fa.jerk >= length * self.fourth {
            return None;
        }
        let square = length * length;
        let curvature_slack = square * self.fourth * (1.0 / 8.0);
        if fa.curvature.max(fb.curvature) < -curvature_slack {
            // Concave: above the chord, so the right end decides.
            return self.end_decides(a, b);
        }
        if fa.curvature.min(fb.curvature) > curvature_slack {
            return self.convex(a, b, undecided);
        }
        if self.excluded(fa, fb, length) {
            return None;
        }
        let rate_slack = (square * length) * self.fourth * (3f64.sqrt() / 216.0);
        let middle = (fb.value - fa.value) * 3.0 / length - (fa.rate + fb.rate);
        if fa.rate.min(fb.rate).min(middle) > rate_slack {
            return None;
        }
        if fa.rate.max(fb.rate).max(middle) < -rate_slack {
            return self.end_decides(a, b);
        }
        let centre = self.node((a.h + b.h) * 0.5);
        if [fa, &centre.jet, fb].iter().all(|it| rests(it)) {
            // A distance that does not change has no minimum.
            return None;
        }
        let flat = depth >= FLAT_DEPTH && highest_change(fa, self.fourth, length) <= self.band;
        if flat || depth >= MAX_DEPTH || length <= R::EPSILON * b.h {
            return self.resolve(a, b, undecided);
        }
        self.search(a, &centre, depth + 1, undecided)
            .or_else(|| self.search(&centre, b, depth + 1, undecided))
    }

    /// The zero on (a, b] of a function that falls at b and crosses zero at most once, downwards.
    fn end_decides(&self, a: &Node<R>, b: &Node<R>) -> Option<Node<R>> {
        let drop = drop_ahead(&b.jet);
        let value = if b.jet.value - drop >= -self.doubt { self.value(b) } else { b.jet.value };
        // A minimum close by and within the band is left to the search of the next interval, which counts it.
        if value > 0.0 || value - drop >= -self.band { None } else { Some(self.refine(a, b, None)) }
    }

    /// The first zero crossed downwards on [a, b] of a convex function.
    fn convex(&self, a: &Node<R>, b: &Node<R>, undecided: &mut u64) -> Option<Node<R>> {
        let (fa, fb) = (&a.jet, &b.jet);
        if fa.rate >= 0.0 {
            return None;
        }
        if fb.rate <= 0.0 {
            return self.end_decides(a, b);
        }
        // The tangents at both ends lie below f; their intersection is a lower bound of f.
        let lowest = (fb.rate * fa.value - fa.rate * (fb.value - fb.rate * (b.h - a.h)))
            / (fb.rate - fa.rate);
        if lowest > self.doubt {
            return None;
        }
        let minimum = self.minimum(a, b);
        let value = self.value(&minimum);
        if value > self.band {
            None
        } else if value >= -self.band {
            *undecided += 1;
            None
        } else {
            let back = (-value * 2.0 / minimum.jet.curvature).sqrt();
            Some(self.refine(a, &minimum, Some(minimum.h - back)))
        }
    }

    /// The zero on an interval so short that f is constant to rounding: the value at its end decides.
    fn resolve(&self, a: &Node<R>, b: &Node<R>, undecided: &mut u64) -> Option<Node<R>> {
        let value = self.value(b);
        if value < -self.band {
            return Some(self.refine(a, b, None));
        }
        // While f still falls, its zero or minimum is in a later interval.
        if value <= self.band && b.jet.rate >= 0.0 {
            *undecided += 1;
        }
        None
    }

    /// The only zero on (a, b], where f(b) ≤ 0, to the last bits of h.
    pub(super) fn refine(&self, a: &Node<R>, b: &Node<R>, guess: Option<R>) -> Node<R> {
        if a.jet.value < 0.0 && a.jet.rate < 0.0 {
            return *a;
        }
        let guess = guess.unwrap_or_else(|| a.h + hermite_zero(&a.jet, &b.jet, b.h - a.h));
        // Where f is hardly below zero, plain evaluation would not show where it changes sign.
        let flat = b.jet.value >= -self.doubt;
        polish(|h| self.falling(h, flat), a.h, b.h, guess).1
    }

    /// The node at h with −f, which rises, and its first two derivatives.
    #[inline]
    fn falling(&self, h: R, flat: bool) -> (Node<R>, [R; 3]) {
        let node = self.node(h);
        let value = if flat { self.value(&node) } else { node.jet.value };
        (node, [-value, -node.jet.rate, -node.jet.curvature])
    }

    /// The minimum of f on [a, b], where f is convex, f′(a) < 0 < f′(b).
    fn minimum(&self, a: &Node<R>, b: &Node<R>) -> Node<R> {
        let (ra, rb) = (a.jet.rate, b.jet.rate);
        let guess = a.h + (b.h - a.h) * (ra / (ra - rb));
        let (_, node) = polish(
            |h| {
                let node = self.node(h);
                (node, [node.jet.rate, node.jet.curvature, node.jet.jerk])
            },
            a.h,
            b.h,
            guess,
        );
        node
    }
}

/// A bound on the change of f within a length.
pub(crate) fn highest_change<R: Real>(jet: &Jet<R>, fourth: R, length: R) -> R {
    let inner = jet.jerk.abs() * (1.0 / 6.0) + length * fourth * (1.0 / 24.0);
    length * (jet.rate.abs() + length * (jet.curvature.abs() * 0.5 + length * inner))
}

/// Lower estimate of how far a falling f drops below its value before its minimum, from its derivatives: 0
/// where it already rises, infinite where it has no minimum ahead.
fn drop_ahead<R: Real>(jet: &Jet<R>) -> R {
    if jet.rate >= 0.0 {
        R::ZERO
    } else if jet.curvature > 0.0 {
        jet.rate * 0.5 * jet.rate / jet.curvature
    } else if jet.jerk > 0.0 {
        // The lowest point of ½ f″ t² + ⅙ f‴ t³, and of f′ t + ⅙ f‴ t³.
        let bent = -jet.curvature / jet.jerk;
        let steep = -jet.rate * 2.0 / jet.jerk;
        (jet.jerk * (2.0 / 3.0)) * (bent * bent * bent).max(steep * 0.5 * steep.sqrt())
    } else {
        R::INFINITY
    }
}

/// Zero of the cubic Hermite interpolant with f(0) ≥ 0 ≥ f(length); a zero at 0 is divided out.
fn hermite_zero<R: Real>(a: &Jet<R>, b: &Jet<R>, length: R) -> R {
    let b0 = a.value;
    let b1 = a.value + length * a.rate / 3.0;
    let b2 = b.value - length * b.rate / 3.0;
    let b3 = b.value;
    if b0 <= 0.0 {
        // H(t)/t = 3 b1 (1−t)² + 3 b2 t (1−t) + b3 t². Its zero is found by the stable quadratic formula,
        // divided by the first coefficient because squares could underflow at the lowest rebounds.
        let p = b1 * 3.0;
        let (q, r) = ((b2 - b1 * 2.0) * 3.0 / p, ((b1 - b2) * 3.0 + b3) / p);
        let t = R::from(2.0) / ((q * q - r * 4.0).max(0.0).sqrt() - q);
        return if t > 0.0 && t <= 1.0 { t * length } else { length * 0.5 };
    }
    let (c1, c2, c3) = ((b1 - b0) * 3.0, (b0 - b1 * 2.0 + b2) * 3.0, b3 - b0 + (b1 - b2) * 3.0);
    let mut t = b0 / (b0 - b3);
    for _ in 0..3 {
        let value = b0 + t * (c1 + t * (c2 + t * c3));
        let slope = c1 + t * (c2 * 2.0 + t * 3.0 * c3);
        let next = t - value / slope;
        if !(0.0..=1.0).contains(&next.double()) {
            break;
        }
        t = next;
    }
    t * length
}

/// The zero of an increasing function on [low, high] by Halley's method, kept inside its bracket.
///
/// `f` returns a sample with value, first and second derivative; the sample at the zero is returned. Steps
/// that no longer shrink mean either that the rounding of the function is reached or that the start was bad.
/// A probe a few steps further distinguishes these: at the zero it closes the bracket to rounding; otherwise
/// the bracket is halved and the search goes on.
pub(crate) fn polish<R: Real, T: Copy>(
    f: impl Fn(R) -> (T, [R; 3]),
    low: R,
    high: R,
    guess: R,
) -> (R, T) {
    let middle = (low + high) * 0.5;
    let mut h = if guess > low && guess < high { guess } else { middle };
    let (sample, [mut value, mut slope, mut bend]) = f(h);
    let mut bracket = Bracket { low, high, h, sample, size: value.abs() };
    bracket.narrow(h, sample, value);
    let mut last_step = R::INFINITY;
    loop {
        let step = -value * 2.0 * slope / (slope * 2.0 * slope - value * bend);
        if value == 0.0 || step.abs() <= R::EPSILON * 0.25 * h.abs() {
            break;
        }
        let middle = (bracket.low + bracket.high) * 0.5;
        if middle <= bracket.low || middle >= bracket.high {
            break;
        }
        let mut next = h + step;
        if step.abs() < last_step * 0.5 && bracket.contains(next) {
            last_step = step.abs();
        } else {
            let width = step.abs().min(last_step) * 4.0;
            let probe = if value < 0.0 { h + width } else { h - width };
            if bracket.contains(probe) {
                let (sample, [beyond, ..]) = f(probe);
                bracket.narrow(probe, sample, beyond);
            }
            next = (bracket.low + bracket.high) * 0.5;
            last_step = bracket.high - bracket.low;
        }
        h = next;
        let (sample, jet) = f(h);
        [value, slope, bend] = jet;
        bracket.narrow(h, sample, value);
    }
    (bracket.h, bracket.sample)
}

/// An interval that contains the zero, and the sample with the smallest |value| so far.
struct Bracket<T, R = f64> {
    low: R,
    high: R,
    h: R,
    sample: T,
    size: R,
}

impl<R: Real, T: Copy> Bracket<T, R> {
    fn contains(&self, h: R) -> bool {
        h > self.low && h < self.high
    }

    fn narrow(&mut self, h: R, sample: T, value: R) {
        if value < 0.0 {
            self.low = h;
        } else {
            self.high = h;
        }
        if value.abs() <= self.size {
            (self.h, self.sample, self.size) = (h, sample, value.abs());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::polish;

    /// t³ − 10⁻⁹⁹ from a guess so flat that Halley's steps are tiny against the bracket; root 10⁻³³.
    #[test]
    fn a_flat_start_is_not_mistaken_for_convergence() {
        let cubic = |t: f64| ((), [t * t * t - 1e-99, 3.0 * t * t, 6.0 * t]);
        for guess in [1e-70, 1e-40, 0.5e-33, 1e-20, 0.3] {
            let (root, ()) = polish(cubic, 0.0, 1.0, guess);
            assert!((root / 1e-33 - 1.0).abs() < 1e-15, "{guess:e}: {root:e}");
        }
        let shifted =
            |t: f64| ((), [(t - 0.5).powi(3) - 1e-15, 3.0 * (t - 0.5).powi(2), 6.0 * (t - 0.5)]);
        for guess in [0.5 + 1e-14, 0.5 + 1e-9, 0.9] {
            let (root, ()) = polish(shifted, 0.5, 1.0, guess);
            assert!((root - 0.50001).abs() < 1e-14, "{guess}: {root}");
        }
    }
}
