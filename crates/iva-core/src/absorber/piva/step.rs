//! One step of flight: states and turning points from its series.
//!
//! For an order N that the compiler knows and without branches, so that many can go side by side
//! ([`crate::run::side_by_side`]).

use super::PivaState;
use crate::force::Drive;
use crate::host::oscillator::Primary;
use crate::number::arrays::laned;
use crate::number::compensated::DoubleDouble;
use crate::number::real::Real;
use crate::segment::enclosure::Enclosure;
use crate::segment::flight::Turns;
use crate::segment::quintic::{monomials, root};
use crate::segment::taylor::{ORDER, Pendulum, Row, Series, unrolled};

/// Beyond this |sinθ| the cosine is taken from its own series: √(1 − sin²θ) loses digits there.
pub(crate) const STEEP: f64 = 0.7;

/// A series in powers of t over `length`, from a state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step<'a, P = (), R = f64> {
    pub pendulum: &'a Pendulum<R>,
    pub from: &'a PivaState<P, R>,
    pub series: &'a Series<R>,
    pub length: R,
}

impl<R: Real, P: Copy> Step<'_, P, R> {
    /// The state at h > 0, with the drive of the begin.
    #[inline(always)]
    pub fn state<const N: usize>(&self, h: R) -> PivaState<P, R> {
        let (t, from, series) = (h / self.length, self.from, self.series);
        let rows = [&series.x, &series.u, &series.y, &series.w, &series.c];
        let [x, u, y, w, c] = beyond::<_, N, 1, 5>(rows, t);
        let primary = Primary { x: from.primary.x.plus(t * x), v: from.primary.v.plus(t * u) };
        let distance = from.distance.plus(t * y * -from.wall.sign());
        self.reached(primary, distance, from.w.plus(t * w), from.cosine.plus(t * c))
    }

    /// The state at the end of a step, with the drive of the begin. At full accuracy its linear terms are computed to twice the precision,
    /// which leaves the rounding of those from h² on; a series of a lower order leaves out more than they round.
    #[inline(always)]
    pub fn arrival<const N: usize>(
        &self,
        h: R,
        drive: Option<&Drive<DoubleDouble<R>, 2>>,
    ) -> PivaState<P, R> {
        if N < ORDER {
            return self.state::<N>(h);
        }
        let cosine = self.precise_cosine();
        let start = self.from.precise_swing(self.pendulum, cosine);
        self.arrived::<N>(h, cosine, &self.pendulum.beginning(&start, drive))
    }

    /// [`Self::arrival`] at full accuracy, from the precise cosine and the linear terms.
    #[inline(always)]
    pub fn arrived<const N: usize>(
        &self,
        h: R,
        cosine: DoubleDouble<R>,
        first: &Series<DoubleDouble<R>, 2>,
    ) -> PivaState<P, R> {
        let (t, from, series) = (h / self.length, self.from, self.series);
        let [x, u, y, w, c] =
            beyond::<_, N, 2, 5>([&series.x, &series.u, &series.y, &series.w, &series.c], t);
        let increment = |first: DoubleDouble<R>, beyond: R| first.times(h).plus(t * t * beyond);
        let pull = if from.released { DoubleDouble::ZERO } else { first.w[1] };
        let primary = Primary {
            x: from.primary.x + increment(first.x[1], x),
            v: from.primary.v + increment(first.u[1], u),
        };
        let towards = -from.wall.sign();
        let DoubleDouble { value, rest } = increment(first.y[1], y);
        let distance = from.distance.plus_parts(value * towards, rest * towards);
        let own = cosine + increment(first.c[1], c);
        self.reached(primary, distance, from.w + increment(pull, w), own)
    }

    /// cosθ where the step begins, to twice the precision.
    #[inline(always)]
    pub fn precise_cosine(&self) -> DoubleDouble<R> {
        self.from.precise_cosine(self.pendulum)
    }

    /// A later state, with its angle from the distance; `own`: the cosine from its own series.
    #[inline(always)]
    fn reached(
        &self,
        primary: Primary<R>,
        distance: DoubleDouble<R>,
        w: DoubleDouble<R>,
        own: DoubleDouble<R>,
    ) -> PivaState<P, R> {
        let from = self.from;
        let y = PivaState { distance, ..*from }.y().value;
        let sine = y / self.pendulum.contact_distance;
        let exact = DoubleDouble::new(self.pendulum.cosine(y).copysign(own.value));
        let cosine = if sine.abs() < STEEP { exact } else { own };
        PivaState { primary, distance, w, cosine, released: false, ..*from }
    }

    /// The turning point of x on the way to an end.
    #[inline(always)]
    pub fn turning<const N: usize>(&self, end: &PivaState<P, R>, h: R) -> Turning<R> {
        let share = h / self.length;
        let u = &self.series.u;
        let Ahead { rate, bend, fourth } = Ahead::of::<N>(u, share);
        let [v, v_end] = [u[0], end.primary.v.value];
        let enclosure = Enclosure::new([v, v_end], [u[1], rate], share, fourth);
        let off = (enclosure.low > 0.0) | (enclosure.high < 0.0);
        let one_way = enclosure.rises(R::ZERO) | enclosure.falls(R::ZERO);
        let turns = one_way & (v * v_end < 0.0);

        // Close to the turn by the quintic between both ends, then by the series there.
        let half_square = (share * share) * 0.5;
        let begin = [v, share * u[1], half_square * (u[2] * 2.0)];
        let guess = share * root(&monomials(&begin, &[v_end, share * rate, half_square * bend]));
        let mut x = R::ZERO;
        unrolled!(i < N + 1 => x = x.mul_add(guess, self.series.x[N - i]));
        let [v, half, third, fourth, fifth] = shifted::<_, N>(u, 0, guess);
        // ẋ and x in powers of the time after the guess.
        let (later, close) = root_close_by([v, half, third, fourth, fifth], share, guess);
        let mean =
            v + later * (half * 0.5 + later * (third * (1.0 / 3.0) + later * (fourth * 0.25)));
        let turn = guess + later;
        let close = close & (turn > 0.0) & (turn < share);
        Turning {
            decided: (off | one_way) & (close | !turns),
            turns,
            h: self.length * turn,
            x: x + self.length * (later * mean),
        }
    }
}

/// The turning point of x in a step: there is one or none if that is `decided`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turning<R = f64> {
    pub decided: bool,
    pub turns: bool,
    pub h: R,
    pub x: R,
}

impl<R: Real> Turning<R> {
    /// What is known of the extrema of x in the step.
    pub fn as_turns(&self) -> Turns<R> {
        match *self {
            Turning { decided: false, .. } => Turns::Unknown,
            Turning { turns: false, .. } => Turns::Never,
            Turning { h, x, .. } => Turns::Once(h, x),
        }
    }
}

laned!(Turning, Turnings { decided: bool, turns: bool, h: f64, x: f64 });

/// Derivatives of a polynomial of order N at the end of [0, share], and a bound over that interval.
pub(super) struct Ahead<R = f64> {
    /// First derivative f′ at the end.
    pub rate: R,
    /// Second derivative f″ at the end.
    pub bend: R,
    /// Bound on |f⁗| over the interval.
    pub fourth: R,
}

impl<R: Real> Ahead<R> {
    #[inline(always)]
    pub fn of<const N: usize>(f: &Row<R>, share: R) -> Self {
        let [mut rate, mut bend, mut fourth] = [R::ZERO; 3];
        unrolled!(i < N => {
            let k = N - i;
            let first = f[k] * (k as f64);
            rate = rate.mul_add(share, first);
            if k > 1 {
                bend = bend.mul_add(share, f[k] * ((k * (k - 1)) as f64));
            }
            if k > 3 {
                let factor = (k * (k - 1) * (k - 2) * (k - 3)) as f64;
                fourth = fourth.mul_add(share, f[k].abs() * factor);
            }
        });
        Self { rate, bend, fourth }
    }
}

/// The first coefficients, in powers of the time after t, of the polynomial Σ f_k t^(k−from) over
/// from ≤ k ≤ N.
#[inline(always)]
pub(super) fn shifted<R: Real, const N: usize>(f: &Row<R>, from: usize, t: R) -> [R; 5] {
    let mut sums = [R::ZERO; 5];
    unrolled!(i < N + 1 => {
        if N - i >= from {
            for j in (1..5).rev() {
                sums[j] = sums[j].mul_add(t, sums[j - 1]);
            }
            sums[0] = sums[0].mul_add(t, f[N - i]);
        }
    });
    sums
}

/// How close to its root, as a share of the way, five terms of a polynomial are enough: the sixth, of a
/// function that turns once in a step or so, is some 10⁻¹⁵/120 of the first.
const CLOSE: f64 = 1e-3;

/// The root of a polynomial in the time after a guess `at`, close to 0, and whether it is close enough and found to
/// rounding of its own time.
#[inline(always)]
pub(super) fn root_close_by<R: Real>(f: [R; 5], share: R, at: R) -> (R, bool) {
    let mut t = -f[0] / f[1];
    let (mut step, mut slope) = (R::ZERO, f[1]);
    for _ in 0..2 {
        let value = f[0] + t * (f[1] + t * (f[2] + t * (f[3] + t * f[4])));
        slope = f[1] + t * (f[2] * 2.0 + t * (f[3] * 3.0 + t * (f[4] * 4.0)));
        step = value / slope;
        t -= step;
    }
    // Newton's method leaves an error of step² f″/(2 f′).
    let left = ((step * step) * (f[2] + f[3] * (t * 3.0))).abs();
    let found = left <= (slope * (at + t)).abs() * R::EPSILON;
    (t, found & (t.abs() <= share * CLOSE))
}

/// Σ f_k t^(k−FROM) over FROM ≤ k ≤ N of several series, by Horner's rule, side by side. Of slices or by `map` in place of the
/// loops, a call may be left that keeps a loop over lanes from becoming vectors.
#[inline(always)]
fn beyond<R: Real, const N: usize, const FROM: usize, const K: usize>(
    rows: [&Row<R>; K],
    t: R,
) -> [R; K] {
    let mut sums = [R::ZERO; K];
    unrolled!(i < N + 1 - FROM => {
        for (sum, row) in sums.iter_mut().zip(rows) {
            *sum = sum.mul_add(t, row[N - i]);
        }
    });
    sums
}

#[cfg(test)]
mod tests {
    use super::root_close_by;

    /// s² − (at + t)² from guesses near and far from its root s, which may be a tiny part of the step.
    #[test]
    fn a_root_is_found_to_rounding_of_its_own_time_or_refused() {
        for s in [0.5, 1e-3, 1e-4, 1e-7, 1e-10] {
            for (off, finds) in [(0.0, true), (1e-6, true), (1e-3, true), (0.13, false)] {
                let at = s * (1.0 + off);
                let (later, close) =
                    root_close_by([s * s - at * at, -2.0 * at, -1.0, 0.0, 0.0], 1.0, at);
                let error = ((at + later) / s - 1.0).abs();
                assert!(!close || error <= 1e-15, "{s} {off}: {error:e}");
                assert!(close || !finds, "{s} {off} is refused");
            }
        }
    }
}
