//! Integrals and extrema of polynomials.

use crate::number::real::Real;
use crate::range::{LARGEST, SMALLEST};
use crate::segment::flight::Arc;
use crate::segment::roots::polish;
use crate::segment::taylor::{ORDER, Row, horner};

/// Number of powers beyond the order up to which the products of terms are summed.
const BEYOND: usize = 4;

/// ∫₀ᵗ f g of two polynomials of one order, at most [`ORDER`], that are truncated power series.
pub fn product_integral<R: Real>(f: &[R], g: &[R], t: R) -> R {
    let (f, g) = (terms(f, t), terms(g, t));
    let order = f.1;
    let mut sum = R::ZERO;
    for k in (0..=order + BEYOND).rev() {
        let mut product = R::ZERO;
        for i in k.saturating_sub(order)..=k.min(order) {
            product += f.0[i] * g.0[k - i];
        }
        sum += product * R::reciprocal(k + 1);
    }
    sum * t
}

/// The terms f_k tᵏ of a polynomial at t, and its order.
#[inline(always)]
fn terms<R: Real>(f: &[R], t: R) -> (Row<R>, usize) {
    let mut terms = [R::ZERO; ORDER + 1];
    let mut power = R::ONE;
    for (term, coefficient) in terms.iter_mut().zip(f) {
        *term = power * *coefficient;
        power *= t;
    }
    (terms, f.len() - 1)
}

/// The larger of `least` and the largest |f| of a polynomial on an interval of [0, ∞), at an end or an
/// extremum.
pub(crate) fn largest<R: Real>(f: &[R], h: [R; 2], least: R) -> R {
    largest_of(f, h, least)
}

#[inline(always)]
fn largest_of<R: Real>(f: &[R], [from, to]: [R; 2], least: R) -> R {
    let ends = horner(f, from).abs().max(horner(f, to).abs());
    let size = steepest(f, 0, to);
    if !(size > 0.0 && size.is_finite()) {
        return least.max(ends);
    }
    if !(SMALLEST..LARGEST).contains(&size.double()) {
        // Divided by its size, so that no bound overflows.
        let over: Vec<R> = f.iter().map(|coefficient| *coefficient / size).collect();
        return (largest(&over, [from, to], least / size) * size).max(least);
    }
    let arc = arc_of(f, [from, to], size);
    if arc.limit() < least {
        return least;
    }
    if arc.is_monotone() {
        return least.max(ends);
    }
    if arc.turns_once() {
        let (_, value) = turned(|t| jet(f, t), [from, to]);
        return least.max(ends).max(value.abs());
    }
    inner(f, [from, to]).fold(least.max(ends), |most, value| most.max(value.abs()))
}

/// The values of a polynomial at its extrema inside an interval of [0, ∞).
fn inner<R: Real>(f: &[R], [from, to]: [R; 2]) -> impl Iterator<Item = R> {
    let turns = turnings(f, to).into_iter().map(|bracket| turned(|t| jet(f, t), bracket));
    turns.filter(move |(at, _)| *at > from && *at < to).map(|(_, value)| value)
}

/// The range of a polynomial on an interval of [0, ∞), joined with a given range.
pub(crate) fn range<R: Real>(f: &[R], [from, to]: [R; 2], given: [R; 2]) -> [R; 2] {
    let wider = |[least, most]: [R; 2], value: R| [least.min(value), most.max(value)];
    let size = steepest(f, 0, to);
    let ends = [from, to].map(|t| horner(f, t)).into_iter().fold(given, wider);
    if !(size > 0.0 && size.is_finite()) {
        return ends;
    }
    if !(SMALLEST..LARGEST).contains(&size.double()) {
        // Divided by its size, so that no bound overflows.
        let over: Vec<R> = f.iter().map(|coefficient| *coefficient / size).collect();
        return inner(&over, [from, to]).map(|value| value * size).fold(ends, wider);
    }
    let middle = (ends[0] + ends[1]) * 0.5;
    let arc = arc_of(f, [from, to], size);
    if arc.is_monotone() || within(&arc, middle, (ends[1] - ends[0]) * 0.5) {
        return ends;
    }
    inner(f, [from, to]).fold(ends, wider)
}

/// True if a function is proved to stay closer than `off` to a value.
fn within<R: Real>(arc: &Arc<R>, value: R, off: R) -> bool {
    let [mut begin, mut end] = [arc.begin, arc.end];
    (begin[0], end[0]) = (begin[0] - value, end[0] - value);
    Arc { begin, end, ..*arc }.limit() < off
}

/// The arc of a polynomial on an interval of [0, ∞) where its terms add up to at most `size`.
#[inline(always)]
fn arc_of<R: Real>(f: &[R], [from, to]: [R; 2], size: R) -> Arc<R> {
    let first = |[value, rate, second, _]: [R; 4]| [value, rate, second];
    let (begin, end) = (first(jet(f, from)), first(jet(f, to)));
    Arc::new(begin, end, steepest(f, 6, to), to - from).doubted(size)
}

/// The extremum of a function in a bracket, and its value there; the function is given with three
/// derivatives.
#[inline(always)]
pub(crate) fn turned<R: Real>(at: impl Fn(R) -> [R; 4], [low, high]: [R; 2]) -> (R, R) {
    let [[x_low, v_low, ..], [x_high, v_high, ..]] = [low, high].map(&at);
    if v_low * v_high >= 0.0 {
        // The extremum is at an end of the bracket, apart from rounding.
        return if v_low.abs() < v_high.abs() { (low, x_low) } else { (high, x_high) };
    }
    let rise = if v_low < 0.0 { 1.0 } else { -1.0 };
    let guess = low + (high - low) * (v_low / (v_low - v_high));
    let jet = |h: R| {
        let [value, rate, curvature, jerk] = at(h);
        (value, [rate * rise, curvature * rise, jerk * rise])
    };
    polish(jet, low, high, guess)
}

/// A polynomial at t and its first three derivatives there.
#[inline(always)]
pub(crate) fn jet<R: Real>(f: &[R], t: R) -> [R; 4] {
    let [mut value, mut rate, mut half, mut sixth] = [R::ZERO; 4];
    for coefficient in f.iter().rev() {
        sixth = sixth * t + half;
        half = half * t + rate;
        rate = rate * t + value;
        value = value * t + *coefficient;
    }
    [value, rate, half * 2.0, sixth * 6.0]
}

/// Brackets of the extrema of a polynomial in [0, to], one each, in order. An inflection is not an extremum.
#[inline(always)]
pub(crate) fn turnings<R: Real>(f: &[R], to: R) -> Vec<[R; 2]> {
    let mut found = Vec::new();
    let (slope, curved) = slope_and_bend(f, to);
    // In most cases f is monotonic.
    if slope.abs() > curved * (to * 0.5) {
        return found;
    }
    let search = Turnings { f, size: steepest(f, 0, to), curved, bent: steepest(f, 3, to) };
    search.between([R::ZERO, to], &mut found);
    found
}

/// f′ in the middle of [0, to], and a bound on |f″| on that interval.
#[inline(always)]
fn slope_and_bend<R: Real>(f: &[R], to: R) -> (R, R) {
    let middle = to * 0.5;
    let (mut slope, mut bend) = (R::ZERO, R::ZERO);
    for k in (2..f.len()).rev() {
        let rate = f[k] * (k as f64);
        slope = slope.mul_add(middle, rate);
        bend = bend.mul_add(to, rate.abs() * ((k - 1) as f64));
    }
    (slope.mul_add(middle, f.get(1).copied().unwrap_or(R::ZERO)), bend)
}

/// A polynomial on [0, to] with bounds on |f|, |f″| and |f‴|, whose extrema are searched.
struct Turnings<'a, R = f64> {
    f: &'a [R],
    size: R,
    curved: R,
    bent: R,
}

impl<R: Real> Turnings<'_, R> {
    fn between(&self, [from, to]: [R; 2], found: &mut Vec<[R; 2]>) {
        let (middle, half) = (from.midpoint(to), (to - from) * 0.5);
        let slope = derivative(self.f, 1, middle).abs();
        // Near 0 a polynomial without low powers is much flatter than at the end: the second bound covers
        // that.
        if slope > self.curved * half || slope > steepest(self.f, 2, to) * half {
            return;
        }
        let monotone = derivative(self.f, 2, middle).abs() > self.bent * half;
        // On so short an interval f changes by less than rounding (false also where it is not finite).
        let matters = self.curved * (half * half) > R::EPSILON * self.size;
        if monotone || !matters {
            let falls = |t: R| derivative(self.f, 1, t) < 0.0;
            if falls(from) != falls(to) {
                found.push([from, to]);
            }
            return;
        }
        self.between([from, middle], found);
        self.between([middle, to], found);
    }
}

/// The factor k (k − 1) … (k − n + 1) of tᵏ⁻ⁿ in the nth derivative of tᵏ.
#[inline(always)]
fn factor(k: usize, n: usize) -> f64 {
    (0..n).map(|i| (k - i) as f64).product()
}

#[inline(always)]
fn derivative<R: Real>(f: &[R], n: usize, t: R) -> R {
    (n..f.len()).rev().fold(R::ZERO, |sum, k| sum * t + f[k] * factor(k, n))
}

/// A bound on the size of the nth derivative on [0, to].
#[inline(always)]
fn steepest<R: Real>(f: &[R], n: usize, to: R) -> R {
    (n..f.len()).rev().fold(R::ZERO, |sum, k| sum * to + f[k].abs() * factor(k, n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_turning_point_is_bracketed_alone() {
        // f′ = (t − 0.3)(t − 0.35)(t − 0.8), expanded.
        let f = [0.0, -0.084, 0.5 * 0.625, -1.45 / 3.0, 0.25];
        let found = turnings(&f, 1.0);
        assert_eq!(found.len(), 3, "{found:?}");
        for ([from, to], truth) in found.iter().zip([0.3, 0.35, 0.8]) {
            assert!(*from <= truth && truth <= *to, "{found:?}");
        }
        assert_eq!(turnings(&f, 0.33).len(), 1);
        assert_eq!(turnings(&[0.0, 1.0, 2.0], 1.0), Vec::<[f64; 2]>::new());
        // An inflection: f′ = (t − 1/2)².
        assert_eq!(turnings(&[0.0, 0.25, -0.5, 1.0 / 3.0], 1.0).len(), 0);
        assert_eq!(turnings(&[0.0; 4], 1.0).len(), 0);
        assert_eq!(turnings(&[f64::NAN; 4], 1.0).len(), 0);
    }

    #[test]
    fn the_range_is_found_inside_and_at_the_ends() {
        // The polynomial is a series truncated with an error of 2²¹/21! = 4e-14.
        let near = |found: [f64; 2], truth: [f64; 2]| {
            for (found, truth) in found.into_iter().zip(truth) {
                assert!((found - truth).abs() < 1e-13, "{found} {truth}");
            }
        };
        let nothing = [f64::INFINITY, f64::NEG_INFINITY];
        // cos(2t − 1) from −1 to 1 rises to 1 and falls back.
        near(range(&cosine(2.0, -1.0), [0.0, 1.0], nothing), [1f64.cos(), 1.0]);
        near(range(&cosine(2.0, 2.5), [0.0, 1.0], nothing), [-1.0, 4.5f64.cos().max(2.5f64.cos())]);
        near(range(&cosine(2.0, 0.3), [0.1, 0.4], nothing), [1.1f64.cos(), 0.5f64.cos()]);
        near(range(&cosine(2.0, 0.3), [0.1, 0.4], [-2.0, 0.6]), [-2.0, 0.5f64.cos()]);
        near(range(&cosine(2.0, -1.0), [0.0, 1.0], [-2.0, 2.0]), [-2.0, 2.0]);
        let tiny: Vec<f64> = cosine(2.0, -1.0).iter().map(|c| 1e-300 * c).collect();
        near(range(&tiny, [0.0, 1.0], [0.0; 2]).map(|it| it / 1e-300), [0.0, 1.0]);
    }

    #[test]
    fn what_begins_flat_is_searched_quickly() {
        // f = t¹⁵ − t¹⁶ has its extremum at 15/16; with bounds over the whole interval the search would take
        // seconds.
        let mut f = [0.0; ORDER + 1];
        (f[15], f[16]) = (1.0, -1.0);
        let top = 15f64.powi(15) / 16f64.powi(16);
        let [least, most] = range(&f, [0.0, 1.0], [0.0; 2]);
        assert!(least == 0.0 && (most - top).abs() < 1e-16, "{least} {most} {top}");
        assert_eq!(turnings(&f, 1.0).len(), 1);
    }

    /// Taylor coefficients of cos(turn·t + phase).
    fn cosine(turn: f64, phase: f64) -> Vec<f64> {
        let (mut s, mut c) = phase.sin_cos();
        let step = |k: usize| {
            let now = c;
            let by = turn / (k + 1) as f64;
            (s, c) = (by * c, -(by * s));
            now
        };
        (0..=ORDER).map(step).collect()
    }

    #[test]
    fn the_largest_value_is_found_inside_and_at_the_ends() {
        let near =
            |value: f64, truth: f64| assert!((value - truth).abs() < 4e-15, "{value} {truth}");
        near(largest(&cosine(2.0, -1.0), [0.0, 1.0], 0.0), 1.0);
        near(largest(&cosine(2.0, 2.5), [0.0, 1.0], 0.0), 1.0);
        near(largest(&cosine(2.0, 0.3), [0.1, 0.4], 0.0), 0.5f64.cos());
        near(largest(&cosine(2.0, 0.3), [0.1, 0.4], 0.9), 0.9);
        assert_eq!(largest(&[0.0; 5], [0.0, 1.0], 0.0), 0.0);
        // Close to overflow, where a bound on the second derivative is infinite (found by fuzzing:
        // the search for the largest value did not end).
        let huge: Vec<f64> = cosine(2.0, -1.0).iter().map(|c| 1e307 * c).collect();
        near(largest(&huge, [0.0, 1.0], 0.0) / 1e307, 1.0);
        let tiny: Vec<f64> = cosine(2.0, -1.0).iter().map(|c| 1e-300 * c).collect();
        near(largest(&tiny, [0.0, 1.0], 0.0) / 1e-300, 1.0);
        assert_eq!(largest(&[f64::NAN; 5], [0.0, 1.0], 0.5), 0.5);
    }
}
