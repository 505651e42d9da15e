//! A recorded force: piecewise linear between given values.
//!
//! A record is kept in the user's time. Its knots in natural time are products in double-double, identical at
//! every evaluation, so that a step can end exactly on a knot.

use std::any::Any;
use std::sync::{Arc, Mutex};

use super::{Acts, Push};
use crate::error::{Invalid, number};
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::range;

/// Instants that differ by more than this part of their size are told apart by plain numbers.
const CLOSE: f64 = 8.0 * f64::EPSILON;

/// A recorded history: increasing times with one value each.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct History {
    times: Vec<f64>,
    values: Vec<f64>,
    /// Smallest size other than 0 and largest size, of the times and of the values.
    sizes: [[f64; 2]; 2],
    /// Largest size of a slope.
    steepest: f64,
    /// Mean number of intervals per time, for a first guess of the interval that an instant is in.
    density: f64,
    kept: Kept,
}

/// Cache of what the last structure computed from a history, for the next one of equal damping ratio and force.
#[derive(Debug, Clone, Default)]
struct Kept(Arc<Mutex<Option<Arc<dyn Any + Send + Sync>>>>);

/// A history is its numbers.
impl PartialEq for Kept {
    fn eq(&self, _other: &Self) -> bool {
        true
    }
}

impl History {
    /// A history of two points or more. Values too small for [`crate::range`] become 0.
    ///
    /// # Errors
    /// [`Invalid`] naming the first time that does not increase, the first number that is not
    /// finite, or two lengths that differ.
    pub fn new(times: Vec<f64>, mut values: Vec<f64>) -> Result<Self, Invalid> {
        if times.len() != values.len() {
            let rule = format!("there are {} values; give as many of both", values.len());
            return Err(Invalid::new("times", format!("{} numbers", times.len()), rule));
        }
        if times.len() < 2 {
            let rule = "a record has two points or more";
            return Err(Invalid::new("times", format!("{} numbers", times.len()), rule));
        }
        for (index, (time, value)) in times.iter().zip(&mut values).enumerate() {
            if value.abs() < range::SMALLEST {
                *value = 0.0;
            }
            range::size(&format!("times[{index}]"), *time)?;
            range::size(&format!("values[{index}]"), *value)?;
            if index > 0 && times[index - 1] >= *time {
                return Err(Invalid::new(
                    format!("times[{index}]"),
                    number(*time),
                    format!("it must be later than the time before, {}", number(times[index - 1])),
                ));
            }
        }
        let sizes = [extremes(&times), extremes(&values)];
        let slope = |i: usize| ((values[i] - values[i - 1]) / (times[i] - times[i - 1])).abs();
        let steepest = (1..times.len()).map(slope).fold(0.0, |most, slope| most.max(slope));
        let last = times.len() - 1;
        let density = last as f64 / (times[last] - times[0]);
        Ok(Self { times, values, sizes, steepest, density, kept: Kept::default() })
    }

    /// The same numbers, with nothing kept: what is kept with a history must not keep that history.
    fn bare(&self) -> Self {
        Self { kept: Kept::default(), ..self.clone() }
    }

    /// What was computed from it before, if `fits`; otherwise what `make` computes, which is kept.
    pub(crate) fn kept<T: Any + Send + Sync>(
        &self,
        fits: impl Fn(&T) -> bool,
        make: impl FnOnce() -> T,
    ) -> Arc<T> {
        // Whoever held the lock has at worst kept nothing.
        let mut kept = self.kept.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let before = kept.clone().and_then(|it| it.downcast::<T>().ok());
        before.filter(|it| fits(it)).unwrap_or_else(|| {
            let made = Arc::new(make());
            *kept = Some(Arc::clone(&made) as Arc<dyn Any + Send + Sync>);
            made
        })
    }

    /// The times, increasing.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The values, one for each time.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// Smallest size other than 0, and largest size; both 0 if all numbers are 0.
fn extremes(numbers: &[f64]) -> [f64; 2] {
    let sizes = || numbers.iter().map(|number| number.abs()).filter(|size| *size > 0.0);
    [sizes().reduce(f64::min), sizes().reduce(f64::max)].map(Option::unwrap_or_default)
}

/// A history as a force: linear between its points, 0 before the first and after the last.
#[derive(Debug, Clone, PartialEq)]
pub struct Record<R = f64> {
    /// The history, shared by all scenes that it drives.
    pub history: Arc<History>,
    /// The body that it acts on.
    pub acts: Acts,
    /// ωn: natural time per time of the history.
    pub rate: R,
    /// f/M or a_g in ωn² × length, per value of the history.
    pub scale: R,
}

impl<R: Real> Record<R> {
    pub(super) fn check(&self) -> Result<(), Invalid> {
        range::positive("force.rate", self.rate)?;
        range::size("force.scale", self.scale)?;
        let [times, values] = self.history.sizes;
        let in_range = |sizes: [f64; 2], factor: R| {
            sizes.iter().try_for_each(|size| range::size("force.record", factor.abs() * *size))
        };
        in_range(times, self.rate)?;
        if self.scale == 0.0 { Ok(()) } else { in_range(values, self.scale) }
    }

    /// The largest size of its derivative of this order.
    pub(crate) fn largest(&self, order: i32) -> R {
        match order {
            0 => (self.scale * self.history.sizes[1][1]).abs(),
            1 => (self.scale * self.history.steepest / self.rate).abs(),
            _ => R::ZERO,
        }
    }

    /// The largest size between two instants: at one of them, or at a point in between.
    pub(super) fn largest_between(&self, between: [R; 2]) -> R {
        let [from, to] = between.map(DoubleDouble::new);
        let [first, last] = [from, to].map(|time| self.passed(time));
        let points = (first..last).map(|index| self.value(index).value.abs());
        let ends = [(from, from), (self.last_knot(to).unwrap_or(to), to)].map(|(piece, time)| {
            // The value before a jump at the end counts as well.
            self.piece(piece).at(time)[0].value.abs()
        });
        points.chain(ends).fold(R::ZERO, R::larger)
    }

    /// The same record with a history of its own, with which nothing is kept.
    pub(crate) fn apart(&self) -> Self {
        Self { history: Arc::new(self.history.bare()), ..*self }
    }

    /// True if a record of the same history is the same force.
    pub(crate) fn is_alike(&self, other: &Self) -> bool {
        (self.acts, self.rate, self.scale) == (other.acts, other.rate, other.scale)
    }

    /// The number of points of the history.
    pub(crate) fn points(&self) -> usize {
        self.history.times.len()
    }

    /// f/M or a_g at a point of the history.
    pub(crate) fn value(&self, index: usize) -> DoubleDouble<R> {
        DoubleDouble::new(R::from(self.history.values[index])).times(self.scale)
    }

    /// The instant of a point of the history, in 1/ωn.
    pub(crate) fn knot(&self, index: usize) -> DoubleDouble<R> {
        DoubleDouble::new(R::from(self.history.times[index])).times(self.rate)
    }

    /// True if an instant is that of a point or later. In most cases plain numbers tell.
    #[inline(always)]
    fn reached(&self, index: usize, time: DoubleDouble<R>) -> bool {
        let plain = R::from(self.history.times[index]) * self.rate;
        let apart = time.value - plain;
        if apart.abs() > plain.abs() * CLOSE {
            apart > 0.0
        } else {
            self.reached_exactly(index, time)
        }
    }

    fn reached_exactly(&self, index: usize, time: DoubleDouble<R>) -> bool {
        (self.knot(index) - time).value <= 0.0
    }

    /// The number of points at or before an instant.
    pub(crate) fn passed(&self, time: DoubleDouble<R>) -> usize {
        let times = &self.history.times;
        // First guess: correct for records sampled at equal intervals.
        let intervals =
            (time.value.double() / self.rate.double() - times[0]) * self.history.density;
        let guess = intervals.clamp(0.0, (times.len() - 1) as f64) as usize;
        for passed in guess.saturating_sub(1)..=(guess + 2).min(times.len()) {
            let before = passed == 0 || self.reached(passed - 1, time);
            if before && (passed == times.len() || !self.reached(passed, time)) {
                return passed;
            }
        }
        let (mut low, mut high) = (0, times.len());
        while low < high {
            let middle = low.midpoint(high);
            if self.reached(middle, time) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// [`Record::passed`], looked for first at `near` points and one more.
    pub(super) fn passed_near(&self, near: usize, time: DoubleDouble<R>) -> usize {
        let points = self.history.times.len();
        let between = |passed: &usize| {
            (1..=points).contains(passed)
                && self.reached(passed - 1, time)
                && (*passed == points || !self.reached(*passed, time))
        };
        [near, near + 1].into_iter().find(between).unwrap_or_else(|| self.passed(time))
    }

    /// The instant of the point after this number of points.
    pub(super) fn knot_after(&self, passed: usize) -> Option<DoubleDouble<R>> {
        (passed < self.history.times.len()).then(|| self.knot(passed))
    }

    /// The instant of the last point at or before an instant.
    pub(super) fn last_knot(&self, time: DoubleDouble<R>) -> Option<DoubleDouble<R>> {
        self.passed(time).checked_sub(1).map(|last| self.knot(last))
    }

    /// The instants of its jumps: its ends, unless its value is 0 there.
    pub(super) fn jumps(&self) -> impl Iterator<Item = DoubleDouble<R>> + '_ {
        let last = self.history.times.len() - 1;
        [0, last]
            .into_iter()
            .filter(|index| self.scale * self.history.values[*index] != 0.0)
            .map(|index| self.knot(index))
    }

    /// The linear piece that acts from an instant on.
    pub(super) fn piece(&self, from: DoubleDouble<R>) -> Piece<R> {
        self.piece_after(self.passed(from))
    }

    /// The linear piece that acts after this number of points.
    pub(super) fn piece_after(&self, passed: usize) -> Piece<R> {
        if passed == 0 || passed == self.history.times.len() {
            return Piece::NOTHING;
        }
        let (begin, first) = (self.knot(passed - 1), self.value(passed - 1));
        let slope = (self.value(passed) - first) / (self.knot(passed) - begin);
        Piece { begin, first, slope }
    }
}

/// A linear function of time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece<R = f64> {
    begin: DoubleDouble<R>,
    first: DoubleDouble<R>,
    slope: DoubleDouble<R>,
}

impl<R: Real> Piece<R> {
    const NOTHING: Piece<R> =
        Piece { begin: DoubleDouble::ZERO, first: DoubleDouble::ZERO, slope: DoubleDouble::ZERO };

    /// The force at an instant.
    pub(super) fn push(&self, time: DoubleDouble<R>) -> Push<R> {
        let [value, rate] = self.at(time);
        Push { value, rate, ..Push::NONE }
    }

    /// Its value at an instant, and its slope.
    pub(super) fn at(&self, time: DoubleDouble<R>) -> [DoubleDouble<R>; 2] {
        [self.first + self.slope * (time - self.begin), self.slope]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(times: Vec<f64>, values: Vec<f64>) -> Record {
        let history = Arc::new(History::new(times, values).unwrap());
        Record { history, acts: Acts::Primary, rate: 1.0 / 3.0, scale: 2.0 }
    }

    #[test]
    fn the_piece_of_a_knot_is_the_one_after_it() {
        // Equal intervals, and intervals so unequal that the first guess is wrong.
        let even: Vec<f64> = (0..50).map(|k| f64::from(k) * 0.01).collect();
        let uneven: Vec<f64> = (0..50).map(|k| f64::from(k).exp2()).collect();
        for times in [even, uneven] {
            let record = record(times, (0..50).map(f64::from).collect());
            for index in 0..49 {
                let knot = record.knot(index);
                assert_eq!(record.passed(knot), index + 1);
                assert_eq!(record.passed(knot.plus(1e-18)), index + 1);
                for near in [0, index, index + 1, index + 2, 60] {
                    assert_eq!(record.passed_near(near, knot), index + 1);
                    let before = knot.plus(-1e-18 * (knot.value + 1e-3));
                    assert_eq!(record.passed_near(near, before), index);
                }
                assert_eq!(record.passed(knot.plus(-1e-18 * (knot.value + 1e-3))), index);
                assert_eq!(record.piece(knot).at(knot)[0].value, 2.0 * index as f64);
                assert_eq!(record.knot_after(index + 1), Some(record.knot(index + 1)));
            }
            assert_eq!(record.knot_after(50), None);
            assert_eq!(record.piece(record.knot(49)), Piece::NOTHING);
        }
    }

    #[test]
    fn a_record_jumps_where_it_does_not_end_at_zero() {
        assert_eq!(record(vec![1.0, 2.0], vec![0.0, 3.0]).jumps().count(), 1);
        assert_eq!(record(vec![1.0, 2.0, 3.0], vec![0.0, 3.0, 0.0]).jumps().count(), 0);
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let error = |times: &[f64], values: &[f64]| {
            History::new(times.to_vec(), values.to_vec()).unwrap_err().to_string()
        };
        assert_eq!(
            error(&[0.0, 1.0, 1.0], &[0.0; 3]),
            "times[2] = 1: it must be later than the time before, 1"
        );
        assert!(error(&[0.0, 1.0], &[0.0, f64::NAN]).starts_with("values[1] = NaN: give"));
        assert_eq!(error(&[0.0], &[0.0]), "times = 1 numbers: a record has two points or more");
    }
}
