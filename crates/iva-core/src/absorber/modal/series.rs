//! The power series of a motion: those of all modes, and that of one coordinate, which is a sum of them.

use super::state::Modes;
use crate::number::compensated::{DoubleDouble, two_product, two_sum};
use crate::number::real::Real;
use crate::segment::taylor::{Number, ORDER, Row};

/// Number of leading coefficients in double-double. In the longest motion the next term is below 1/7! = 2 · 10⁻⁴ of
/// the whole, so that its rounding is nothing.
pub(super) const EXACT: usize = 7;

/// Coefficients in powers of t = h over the unit of time of the series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Series<R> {
    first: [DoubleDouble<R>; EXACT],
    rest: [R; ORDER + 1 - EXACT],
}

/// The power series of all modes: each power of all, one after the other, and then the low parts of those below the exact ones.
#[derive(Debug, Clone)]
pub(super) struct ModalSeries<R> {
    n: usize,
    /// Number of powers.
    count: usize,
    parts: Vec<R>,
}

/// Numbers in which a coefficient is computed: in double-double, or plain beyond the first.
pub(super) trait Term<R: Real>: Number<Real = R> {
    /// From a double-double.
    fn of(value: DoubleDouble<R>) -> Self;
    /// From the high and low parts of some numbers, of which plain ones need the high parts only.
    fn at(parts: (&[R], &[R]), index: usize) -> Self;
    /// High and low part.
    fn parts(self) -> [R; 2];
}

impl<R: Real> Term<R> for R {
    #[inline(always)]
    fn of(value: DoubleDouble<R>) -> R {
        value.value
    }
    #[inline(always)]
    fn at((high, _): (&[R], &[R]), index: usize) -> R {
        high[index]
    }
    #[inline(always)]
    fn parts(self) -> [R; 2] {
        [self, R::ZERO]
    }
}

impl<R: Real> Term<R> for DoubleDouble<R> {
    #[inline(always)]
    fn of(value: DoubleDouble<R>) -> Self {
        value
    }
    #[inline(always)]
    fn at((high, low): (&[R], &[R]), index: usize) -> Self {
        DoubleDouble { value: high[index], rest: low[index] }
    }
    #[inline(always)]
    fn parts(self) -> [R; 2] {
        [self.value, self.rest]
    }
}

/// c + s t in double-double, normalised at the end of a sum only.
#[inline(always)]
fn raised<R: Real>([sum, rest]: [R; 2], t: R, [by, by_rest]: [R; 2]) -> [R; 2] {
    let (product, lost) = two_product(sum, t);
    let (value, left) = two_sum(by, product);
    [value, left + (rest.mul_add(t, by_rest) + lost)]
}

impl<R: Real> ModalSeries<R> {
    /// With room for powers up to `order`, of which so many are exact.
    pub(super) fn new(n: usize, order: usize, exact: usize) -> Self {
        Self { n, count: order + 1, parts: vec![R::ZERO; (order + 1 + exact) * n] }
    }

    /// High and low parts of a power; the low ones are none where it is plain.
    #[inline(always)]
    pub(super) fn power(&self, m: usize) -> (&[R], &[R]) {
        let (high, low) = self.parts.split_at(self.count * self.n);
        (&high[m * self.n..][..self.n], low.get(m * self.n..(m + 1) * self.n).unwrap_or(&[]))
    }

    /// Sets a power of all modes.
    #[inline(always)]
    pub(super) fn set<T: Term<R>>(&mut self, m: usize, of: impl Fn(usize) -> T) {
        let n = self.n;
        let (high, low) = self.parts.split_at_mut(self.count * n);
        let high = &mut high[m * n..][..n];
        match low.get_mut(m * n..(m + 1) * n) {
            Some(low) => (0..n).for_each(|j| [high[j], low[j]] = of(j).parts()),
            None => (0..n).for_each(|j| high[j] = of(j).parts()[0]),
        }
    }

    /// A coefficient of a mode, plain.
    #[inline(always)]
    pub(super) fn plain(&self, j: usize, m: usize) -> R {
        self.parts[m * self.n + j]
    }

    /// A coefficient of a mode.
    #[inline(always)]
    pub(super) fn coefficient(&self, j: usize, m: usize) -> DoubleDouble<R> {
        let (high, low) = self.power(m);
        DoubleDouble { value: high[j], rest: low.get(j).copied().unwrap_or(R::ZERO) }
    }

    /// The power series of one mode, plain.
    pub(super) fn row(&self, j: usize) -> Row<R> {
        std::array::from_fn(|m| self.plain(j, m))
    }

    /// The coefficient of a sum of modes with these factors.
    #[inline(always)]
    pub(super) fn summed(&self, shape: &[R], m: usize) -> DoubleDouble<R> {
        let (high, low) = self.power(m);
        if low.is_empty() {
            let both = shape.iter().zip(high);
            return DoubleDouble::new(both.fold(R::ZERO, |sum, (phi, q)| phi.mul_add(*q, sum)));
        }
        let [mut sum, mut rest] = [R::ZERO; 2];
        for ((phi, q), low) in shape.iter().zip(high).zip(low) {
            let (product, lost) = two_product(*phi, *q);
            let (more, left) = two_sum(sum, product);
            (sum, rest) = (more, rest + (left + phi.mul_add(*low, lost)));
        }
        DoubleDouble::new(sum).plus_parts(R::ZERO, rest)
    }

    /// q and q̇ of the first n modes at t = h/`unit`.
    #[inline(always)]
    pub(super) fn modes<const M: usize>(&self, n: usize, t: R, unit: R) -> Modes<R, M> {
        let zero = [R::ZERO; M];
        let ([mut q, mut ql], [mut v, mut vl]) = ([zero; 2], [zero; 2]);
        let ((q, ql), (v, vl)) = ((&mut q[..n], &mut ql[..n]), (&mut v[..n], &mut vl[..n]));
        let exact = self.parts.len() / self.n - self.count;
        for m in (exact..self.count).rev() {
            let (high, _) = self.power(m);
            for j in 0..n {
                v[j] = v[j].mul_add(t, q[j]);
                q[j] = q[j].mul_add(t, high[j]);
            }
        }
        for m in (0..exact).rev() {
            let (high, low) = self.power(m);
            for j in 0..n {
                [v[j], vl[j]] = raised([v[j], vl[j]], t, [q[j], ql[j]]);
                [q[j], ql[j]] = raised([q[j], ql[j]], t, [high[j], low[j]]);
            }
        }
        let over = R::ONE / unit;
        let mut modes = Modes::REST;
        for j in 0..n {
            modes.places[j] = DoubleDouble::new(q[j]).plus_parts(R::ZERO, ql[j]);
            let rate = DoubleDouble::new(v[j]).plus_parts(R::ZERO, vl[j]);
            modes.velocities[j] = scaled(rate, over);
        }
        modes
    }
}

impl<R: Real> Series<R> {
    /// 0 for ever.
    pub(super) const ZERO: Self =
        Self { first: [DoubleDouble::ZERO; EXACT], rest: [R::ZERO; ORDER + 1 - EXACT] };

    /// Sets a coefficient.
    #[inline(always)]
    pub(super) fn set(&mut self, power: usize, value: DoubleDouble<R>) {
        if power < EXACT {
            self.first[power] = value;
        } else {
            self.rest[power - EXACT] = value.value;
        }
    }

    /// A coefficient, plain.
    #[inline(always)]
    pub(super) fn plain(&self, power: usize) -> R {
        if power < EXACT { self.first[power].value } else { self.rest[power - EXACT] }
    }

    /// The K-th derivative with respect to t, K < 9.
    #[inline(always)]
    pub(super) fn derivative<const K: usize>(&self, t: R) -> DoubleDouble<R> {
        let factor = |m: usize| (0..K).map(|i| (m - i) as f64).product::<f64>();
        let mut tail = R::ZERO;
        for m in (EXACT..=ORDER).rev() {
            tail = tail.mul_add(t, self.rest[m - EXACT] * factor(m));
        }
        let mut sum = DoubleDouble::new(tail);
        for m in (K..EXACT).rev() {
            sum = sum.times(t) + self.first[m].times(factor(m));
        }
        sum
    }

    /// The value at t, and its derivative with respect to t.
    #[inline(always)]
    pub(super) fn at(&self, t: R) -> [DoubleDouble<R>; 2] {
        let (mut value, mut rate) = (R::ZERO, R::ZERO);
        for m in (EXACT..=ORDER).rev() {
            rate = rate.mul_add(t, value);
            value = value.mul_add(t, self.rest[m - EXACT]);
        }
        let (mut value, mut rate) = ([value, R::ZERO], [rate, R::ZERO]);
        for m in (0..EXACT).rev() {
            rate = raised(rate, t, value);
            value = raised(value, t, [self.first[m].value, self.first[m].rest]);
        }
        [value, rate].map(|[sum, rest]| DoubleDouble::new(sum).plus_parts(R::ZERO, rest))
    }

    /// The second and third derivatives with respect to t, in plain numbers.
    #[inline(always)]
    pub(super) fn bends(&self, t: R) -> [R; 2] {
        let [mut second, mut third] = [R::ZERO; 2];
        for m in (3..=ORDER).rev() {
            let coefficient = self.plain(m);
            second = second.mul_add(t, coefficient * ((m * (m - 1)) as f64));
            third = third.mul_add(t, coefficient * ((m * (m - 1) * (m - 2)) as f64));
        }
        [second.mul_add(t, self.plain(2) * 2.0), third]
    }

    /// The value and its first two derivatives with respect to t, in plain numbers.
    #[inline(always)]
    pub(super) fn plainly(&self, t: R) -> [R; 3] {
        let [mut value, mut rate, mut half] = [R::ZERO; 3];
        for m in (0..=ORDER).rev() {
            half = half.mul_add(t, rate);
            rate = rate.mul_add(t, value);
            value = value.mul_add(t, self.plain(m));
        }
        [value, rate, half * 2.0]
    }

    /// The coefficients in plain numbers.
    pub(super) fn row(&self) -> Row<R> {
        std::array::from_fn(|m| self.plain(m))
    }
}

/// A double-double times a power of two.
#[inline(always)]
pub(super) fn scaled<R: Real>(number: DoubleDouble<R>, power: R) -> DoubleDouble<R> {
    DoubleDouble { value: number.value * power, rest: number.rest * power }
}
