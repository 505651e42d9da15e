//! One step of flight: what its series says of the states in it.
//!
//! For an order N that the compiler knows and without branches, so that many can go side by side
//! ([`crate::lanes`]).

use super::PivaState;
use crate::compensated::Sum;
use crate::force::Drive;
use crate::oscillator::Primary;
use crate::polynomial::horners;
use crate::real::{ONE, Real, ZERO};
use crate::taylor::{Pendulum, Row, Series, Swing, unrolled};

/// Beyond this |sinθ| the cosine is taken from its own series: √(1 − sin²θ) loses digits there.
const STEEP: f64 = 0.7;

/// A series in powers of t over `length`, from a state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step<'a> {
    pub pendulum: &'a Pendulum,
    pub from: &'a PivaState,
    pub series: &'a Series<Real>,
    pub length: Real,
}

impl Step<'_> {
    /// The state at h > 0.
    #[inline(always)]
    pub fn state<const N: usize>(&self, h: Real) -> PivaState {
        let (t, from, series) = (h / self.length, self.from, self.series);
        let rows = [&series.x, &series.u, &series.y, &series.w, &series.c];
        let [x, u, y, w, c] = horners(rows.map(|row| &row[1..=N]), t).map(|beyond| t * beyond);
        let primary = Primary { x: from.primary.x.plus(x), v: from.primary.v.plus(u) };
        let distance = from.distance.plus(-from.wall.sign() * y);
        self.reached(h, primary, distance, from.w.plus(w), series.c[0] + c)
    }

    /// The same, the linear terms to twice the precision, which leaves the rounding of those from h² on.
    #[inline(always)]
    pub fn arrival<const N: usize>(&self, h: Real, drive: Option<&Drive<Sum, 2>>) -> PivaState {
        let (t, from, series) = (h / self.length, self.from, self.series);
        let sine = from.y().over(self.pendulum.contact_distance);
        // Where the angle is steep the carried cosine knows it better than y does.
        let steep = self.pendulum.small_angles || sine.value.abs() >= STEEP;
        let precise = precise_cosine(sine, from.cosine);
        let cosine = if steep { Sum::new(from.cosine) } else { precise };
        let start =
            Swing { x: from.primary.x, u: from.primary.v, y: from.y(), w: from.w, c: cosine };
        let first: Series<Sum, 2> = self.pendulum.beginning(&start, drive);
        let [x, u, y, w, c] =
            from_two::<N, 5>([&series.x, &series.u, &series.y, &series.w, &series.c], t);
        let increment = |first: Sum, beyond: Real| first.times(h).plus(t * t * beyond);
        let pull = if from.released { Sum::ZERO } else { first.w[1] };
        let primary = Primary {
            x: from.primary.x + increment(first.x[1], x),
            v: from.primary.v + increment(first.u[1], u),
        };
        let towards = -from.wall.sign();
        let Sum { value, rest } = increment(first.y[1], y);
        let distance = from.distance.plus_parts(towards * value, towards * rest);
        let own = series.c[0] + t * (series.c[1] + t * c);
        self.reached(h, primary, distance, from.w + increment(pull, w), own)
    }

    /// The state at h, with its angle from the distance; `own`: the cosine from its own series.
    #[inline(always)]
    fn reached(&self, h: Real, primary: Primary, distance: Sum, w: Sum, own: Real) -> PivaState {
        let from = self.from;
        let y = PivaState { distance, ..*from }.y().value;
        let sine = y / self.pendulum.contact_distance;
        let exact = self.pendulum.cosine(y).copysign(own);
        let cosine = if sine.abs() < STEEP { exact } else { own };
        let time = from.time.plus(h);
        PivaState { time, primary, distance, w, cosine, released: false, ..*from }
    }

    /// Bound on t² |y″| over a share t of the step.
    #[inline(always)]
    pub fn bend<const N: usize>(&self, t: Real) -> Real {
        let mut sum = ZERO;
        unrolled!(i < N - 1 => {
            let k = N - i;
            sum = sum.mul_add(t, (k * (k - 1)) as f64 * self.series.y[k].abs());
        });
        sum * (t * t)
    }

    /// Whether no wall is met on the way to an end, whose `bend` is bounded, with a relative error of y.
    #[inline(always)]
    pub fn is_clear(&self, end: &PivaState, bend: Real, doubt: Real) -> bool {
        let d = self.from.clearance;
        let slack = 0.125 * bend + doubt * d;
        // Compared one by one: what is not a number is not clear.
        let clear = |at: Real| (at > slack) & (at < 2.0 * d - slack);
        clear(self.from.distance.value) & clear(end.distance.value)
    }
}

/// Σ f_k t^(k−2) over 2 ≤ k ≤ N of several series.
#[inline(always)]
fn from_two<const N: usize, const K: usize>(rows: [&Row<Real>; K], t: Real) -> [Real; K] {
    let mut sums = [ZERO; K];
    unrolled!(i < N - 1 => {
        for (sum, row) in sums.iter_mut().zip(rows) {
            *sum = sum.mul_add(t, row[N - i]);
        }
    });
    sums
}

/// cosθ to twice the precision from sinθ and its double, by one step of Newton's method.
#[inline(always)]
pub(super) fn precise_cosine(sine: Sum, cosine: Real) -> Sum {
    let c = Sum::new(cosine);
    let square = Sum::new(ONE) - sine * sine;
    let precise = c + (square - c * c) / c.times(2.0);
    if cosine == 0.0 { Sum::ZERO } else { precise }
}
