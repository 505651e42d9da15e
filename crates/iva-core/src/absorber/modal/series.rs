//! The power series of one coordinate of a motion.

use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::taylor::{Number, ORDER, Row};

/// Number of leading coefficients in double-double. In the longest motion the next term is below 0.8⁹/9! = 4 · 10⁻⁷ of
/// the whole, so that its rounding is nothing.
pub(super) const EXACT: usize = 9;

/// Coefficients in powers of t = h over the unit of time of the series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Series<R> {
    first: [DoubleDouble<R>; EXACT],
    rest: [R; ORDER + 1 - EXACT],
}

/// Numbers in which a coefficient is computed: in double-double, or plain beyond the first.
pub(super) trait Term<R: Real>: Number<Real = R> {
    /// From a double-double.
    fn of(value: DoubleDouble<R>) -> Self;
    /// A coefficient of a series.
    fn get(series: &Series<R>, power: usize) -> Self;
    /// Sets a coefficient.
    fn put(self, series: &mut Series<R>, power: usize);
}

impl<R: Real> Term<R> for R {
    #[inline(always)]
    fn of(value: DoubleDouble<R>) -> R {
        value.value
    }
    #[inline(always)]
    fn get(series: &Series<R>, power: usize) -> R {
        if power < EXACT { series.first[power].value } else { series.rest[power - EXACT] }
    }
    #[inline(always)]
    fn put(self, series: &mut Series<R>, power: usize) {
        if power < EXACT {
            series.first[power] = DoubleDouble::new(self);
        } else {
            series.rest[power - EXACT] = self;
        }
    }
}

impl<R: Real> Term<R> for DoubleDouble<R> {
    #[inline(always)]
    fn of(value: DoubleDouble<R>) -> Self {
        value
    }
    #[inline(always)]
    fn get(series: &Series<R>, power: usize) -> Self {
        if power < EXACT {
            series.first[power]
        } else {
            DoubleDouble::new(series.rest[power - EXACT])
        }
    }
    #[inline(always)]
    fn put(self, series: &mut Series<R>, power: usize) {
        if power < EXACT {
            series.first[power] = self;
        } else {
            series.rest[power - EXACT] = self.value;
        }
    }
}

impl<R: Real> Series<R> {
    /// 0 for ever.
    pub(super) const ZERO: Self =
        Self { first: [DoubleDouble::ZERO; EXACT], rest: [R::ZERO; ORDER + 1 - EXACT] };

    /// Sets a coefficient.
    pub(super) fn set(&mut self, power: usize, value: DoubleDouble<R>) {
        value.put(self, power);
    }

    /// Adds a series times a number, up to a power.
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self, factor: R, order: usize) {
        for (sum, more) in self.first.iter_mut().zip(&other.first).take(order + 1) {
            *sum = *sum + more.times(factor);
        }
        let rest = (order + 1).saturating_sub(EXACT);
        for (sum, more) in self.rest.iter_mut().zip(&other.rest).take(rest) {
            *sum = more.mul_add(factor, *sum);
        }
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

    /// The coefficients in plain numbers.
    pub(super) fn row(&self) -> Row<R> {
        std::array::from_fn(|m| R::get(self, m))
    }
}

/// A double-double times a power of two.
#[inline(always)]
pub(super) fn scaled<R: Real>(number: DoubleDouble<R>, power: R) -> DoubleDouble<R> {
    DoubleDouble { value: number.value * power, rest: number.rest * power }
}
