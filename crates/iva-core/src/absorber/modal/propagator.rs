//! Φ of the lengths of leaps, each twice the one before, and c: what they are made of, and their products with a state.

use super::equations::Regime;
use super::series::EXACT;
use super::state::{Modes, Place};
use super::{MOST_MODES, Modal};
use crate::absorber::Clock;
use crate::force::Force;
use crate::host::Host;
use crate::number::compensated::{DoubleDouble, two_product, two_sum};
use crate::number::real::Real;
use crate::segment::taylor::ORDER;

/// Longest leap, in units of 1/ω of the slowest mode.
const LONGEST: f64 = 1.5;
/// Largest number of lengths.
const LEVELS: usize = 11;
/// Largest number of coupled modes for which Φ is worth its price.
const MOST_COUPLED: usize = 8;
/// Φ of each length, the shortest first.
#[derive(Debug, Clone)]
pub(super) struct Leaps<R> {
    pub shortest: R,
    pub levels: Vec<Propagator<R>>,
}

/// Φ of one length, high and low parts: column by column, or, of separate modes, its four diagonals.
#[derive(Debug, Clone)]
pub(super) struct Propagator<R> {
    high: Vec<R>,
    low: Vec<R>,
    /// c of each mass; empty of one that nothing pulls.
    falls: Vec<Vec<DoubleDouble<R>>>,
}

/// z: all q, then all q̇, in high and low parts.
#[derive(Clone, Copy)]
pub(super) struct Flown<R> {
    pub high: [R; 2 * MOST_MODES],
    pub low: [R; 2 * MOST_MODES],
}

impl<R: Real> Leaps<R> {
    /// The time that some of the shortest leaps take.
    pub(super) fn time(&self, steps: usize) -> Clock<R> {
        DoubleDouble::new(self.shortest).times(steps as f64)
    }
}

impl<R: Real> Flown<R> {
    pub(super) fn of(modes: &Modes<R>, n: usize) -> Self {
        let mut flown = Self { high: [R::ZERO; 2 * MOST_MODES], low: [R::ZERO; 2 * MOST_MODES] };
        let both = modes.places[..n].iter().chain(&modes.velocities[..n]);
        for ((high, low), part) in flown.high.iter_mut().zip(&mut flown.low).zip(both) {
            (*high, *low) = (part.value, part.rest);
        }
        flown
    }

    pub(super) fn modes(&self, n: usize) -> Modes<R> {
        let mut modes = Modes::REST;
        for j in 0..n {
            modes.places[j] = DoubleDouble { value: self.high[j], rest: self.low[j] };
            modes.velocities[j] = DoubleDouble { value: self.high[n + j], rest: self.low[n + j] };
        }
        modes
    }
}

/// a x + b y in double-double.
#[inline(always)]
fn combined<R: Real>([a, x]: [[R; 2]; 2], [b, y]: [[R; 2]; 2]) -> [R; 2] {
    let ((p, p_lost), (r, r_lost)) = (two_product(a[0], x[0]), two_product(b[0], y[0]));
    let small =
        (a[0].mul_add(x[1], a[1] * x[0]) + p_lost) + (b[0].mul_add(y[1], b[1] * y[0]) + r_lost);
    let (sum, lost) = two_sum(p, r);
    let rest = lost + small;
    let value = sum + rest;
    [value, rest - (value - sum)]
}

impl<R: Real> Propagator<R> {
    /// Φ z of separate modes.
    #[inline(always)]
    fn turn(&self, n: usize, z: &Flown<R>, to: &mut Flown<R>) {
        let of = |part: usize| (&self.high[part * n..][..n], &self.low[part * n..][..n]);
        let ([a, b], [c, d]) = ([of(0), of(1)], [of(2), of(3)]);
        let ((q, v), (ql, vl)) = (z.high[..2 * n].split_at(n), z.low[..2 * n].split_at(n));
        let ((to_q, to_v), (to_ql, to_vl)) =
            (to.high[..2 * n].split_at_mut(n), to.low[..2 * n].split_at_mut(n));
        for j in 0..n {
            let (q, v) = ([q[j], ql[j]], [v[j], vl[j]]);
            let at = |part: (&[R], &[R])| [part.0[j], part.1[j]];
            [to_q[j], to_ql[j]] = combined([at(a), q], [at(b), v]);
            [to_v[j], to_vl[j]] = combined([at(c), q], [at(d), v]);
        }
    }

    /// Φ z of coupled modes.
    #[inline(always)]
    fn product(&self, size: usize, z: &Flown<R>, to: &mut Flown<R>) {
        let mut sum = Flown { high: [R::ZERO; 2 * MOST_MODES], low: [R::ZERO; 2 * MOST_MODES] };
        let columns = self.high.chunks_exact(size).zip(self.low.chunks_exact(size));
        for (j, (high, low)) in columns.enumerate() {
            let [x, xl] = [z.high[j], z.low[j]];
            let (sums, rests) = (&mut sum.high[..size], &mut sum.low[..size]);
            for i in 0..size {
                let (p, lost) = two_product(high[i], x);
                let small = high[i].mul_add(xl, low[i] * x) + lost;
                let (s, rest) = two_sum(sums[i], p);
                (sums[i], rests[i]) = (s, rests[i] + (rest + small));
            }
        }
        for i in 0..size {
            let value = sum.high[i] + sum.low[i];
            (to.high[i], to.low[i]) = (value, sum.low[i] - (value - sum.high[i]));
        }
    }

    /// Φ(2h) from Φ(h).
    fn squared(&self, n: usize, separate: bool) -> Self {
        let mut square = self.clone();
        let rest = [R::ZERO; 2 * MOST_MODES];
        let (mut z, mut to) = (Flown { high: rest, low: rest }, Flown { high: rest, low: rest });
        // The columns of Φ are states; of separate modes all first columns are one state, and all second ones.
        let columns = if separate { 2 } else { 2 * n };
        for column in 0..columns {
            let place = |i: usize| match separate {
                true => (2 * (i / n) + column) * n + i % n,
                false => column * 2 * n + i,
            };
            for i in 0..2 * n {
                (z.high[i], z.low[i]) = (self.high[place(i)], self.low[place(i)]);
            }
            self.multiply(n, separate, &z, &mut to);
            for i in 0..2 * n {
                (square.high[place(i)], square.low[place(i)]) = (to.high[i], to.low[i]);
            }
        }
        for fall in square.falls.iter_mut().filter(|fall| !fall.is_empty()) {
            for (i, part) in fall.iter().enumerate() {
                (z.high[i], z.low[i]) = (part.value, part.rest);
            }
            self.multiply(n, separate, &z, &mut to);
            for (i, part) in fall.iter_mut().enumerate() {
                *part = *part + DoubleDouble { value: to.high[i], rest: to.low[i] };
            }
        }
        square
    }

    /// Φ z.
    #[inline(always)]
    fn multiply(&self, n: usize, separate: bool, z: &Flown<R>, to: &mut Flown<R>) {
        if separate { self.turn(n, z, to) } else { self.product(2 * n, z, to) }
    }

    /// Φ z + Σ p c.
    #[inline(always)]
    pub(super) fn apply(
        &self,
        (n, separate): (usize, bool),
        z: &Flown<R>,
        to: &mut Flown<R>,
        pulls: &[DoubleDouble<R>],
    ) {
        self.multiply(n, separate, z, to);
        for (fall, pull) in self.falls.iter().zip(pulls).filter(|(_, pull)| pull.value != 0.0) {
            for ((high, low), part) in to.high.iter_mut().zip(&mut to.low).zip(fall) {
                let sum = *pull * *part + DoubleDouble { value: *high, rest: *low };
                (*high, *low) = (sum.value, sum.rest);
            }
        }
    }
}

impl<R: Real, H: Host<Real = R>, const N: usize> Modal<H, N> {
    /// Φ of all lengths; `None` where leaps are not worth their price.
    pub(super) fn leaps(&self) -> Option<&Leaps<R>> {
        let n = self.whole.count();
        let free = self.host.force().is_none_or(Force::is_none);
        if !free || !(self.whole.is_separate() || n <= MOST_COUPLED) {
            return None;
        }
        Some(self.leaps.get_or_init(|| self.all_leaps()))
    }

    fn all_leaps(&self) -> Leaps<R> {
        let (n, separate) = (self.whole.count(), self.whole.is_separate());
        let shortest = self.reach;
        let stiffness = self.whole.stiffness.iter().map(|square| square.value);
        let slowest = stiffness.filter(|square| *square > 0.0).fold(R::INFINITY, R::min).sqrt();
        let longest = if slowest.is_finite() { R::from(LONGEST) / slowest } else { shortest };
        let mut levels = vec![self.shortest_leap(shortest, separate)];
        let mut length = shortest * 2.0;
        while length <= longest && levels.len() < LEVELS {
            let next = levels[levels.len() - 1].squared(n, separate);
            levels.push(next);
            length *= 2.0;
        }
        Leaps { shortest, levels }
    }

    /// Φ of one length from power series of the unit vectors.
    fn shortest_leap(&self, length: R, separate: bool) -> Propagator<R> {
        let n = self.whole.count();
        let mut free = self.regime(&[Place::FAR; N]);
        free.pulls = [DoubleDouble::ZERO; N];
        let unit = R::power_of_two(length);
        let columns = if separate { 2 } else { 2 * n };
        let size = columns * 2 * n;
        let (high, low) = (vec![R::ZERO; size], vec![R::ZERO; size]);
        let mut whole = Propagator { high, low, falls: vec![vec![]; self.count] };
        let ends = |modes: &Modes<R>, regime: &Regime<'_, R, N>| {
            let gravity = |m: usize| DoubleDouble::new(if m == 0 { R::ONE } else { R::ZERO });
            let still = |m: usize| [DoubleDouble::ZERO, DoubleDouble::ZERO, gravity(m)];
            let rows = self.series(modes, regime, still, unit, (ORDER, EXACT));
            rows.modes(length / unit, unit)
        };
        for column in 0..columns {
            let mut modes = Modes::REST;
            for j in 0..n {
                let [q, v] = if separate {
                    [column == 0, column == 1]
                } else {
                    [column == j, column == n + j]
                };
                let one = |which: bool| DoubleDouble::new(if which { R::ONE } else { R::ZERO });
                (modes.places[j], modes.velocities[j]) = (one(q), one(v));
            }
            let ends = ends(&modes, &free);
            for j in 0..n {
                let (q, v) = (ends.places[j], ends.velocities[j]);
                for (i, end) in [(j, q), (n + j, v)] {
                    let at =
                        if separate { (2 * (i / n) + column) * n + j } else { column * 2 * n + i };
                    (whole.high[at], whole.low[at]) = (end.value, end.rest);
                }
            }
        }
        for k in (0..self.count).filter(|k| self.gravity[*k] != 0.0 || self.friction[*k] != 0.0) {
            let mut pulled = free;
            pulled.pulls[k] = DoubleDouble::new(R::ONE);
            let Modes { places, velocities } = ends(&Modes::REST, &pulled);
            whole.falls[k] = places[..n].iter().chain(&velocities[..n]).copied().collect();
        }
        whole
    }
}
